"""All ticks of a decision on this processor: locate, look, seek, command, step, collect."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel
from mjforage.mission.dynamics import Transition
from mjforage.physics.dynamics.collecting import Goal, Sent, collect_at_mouth, seek
from mjforage.physics.dynamics.period_monitor import Known, Motion, Tick, monitor
from mjforage.physics.dynamics.period_parts import Parts
from mjforage.physics.dynamics.ticks import CONTROL_S, WEATHER_TICKS
from mjforage.physics.dynamics.tracks import look_out, tracked
from mjforage.physics.simulation.instability import warnings_suppressed
from mjforage.physics.simulation.simulated_fleet import SimulatedFleet


class HostPeriod:
    """The ticks of a decision, for a batch; made anew when episodes of it start.

    `device_period.DevicePeriod` does the same with kernels alone.

    Attributes
    ----------
    motion : of the vessels, as it is
    """

    ran = True  # see `DevicePeriod`

    def __init__(self, parts: Parts[SimulatedFleet]) -> None:
        self._parts, self.motion = parts, parts.motion
        self._monitor = BoundKernel(monitor, parts.monitor, parts.record)
        cameras = parts.camera, parts.grid, parts.keys, parts.collects, parts.tracks
        self._look_out = BoundKernel(look_out, *cameras)

    def run(
        self,
        active: NDArray[np.bool_],
        target: NDArray[np.float64],
        sent: Sent,
        record: Callable[[Motion], None] | None,
    ) -> Motion:
        """Play the ticks of a decision, which the pilot has been given.

        Returns: how the vessels move after it.

        Raises `InstabilityError` if something has no place any more.

        Parameters
        ----------
        active : (episode,)
        target : (episode, vessel, 2) [m]
        record : is called every `WEATHER_TICKS` between the first tick and the last
        """
        ids = np.flatnonzero(active)
        with warnings_suppressed():  # entered once for all ticks
            for tick in range(self._parts.ticks):
                known = self._locate(active)
                self._look(active, known.pose)
                known = self._off_land(known)
                if tick % WEATHER_TICKS == 0:
                    self._feel(active)
                    self._seek(active, sent, known)
                    if record is not None and tick:
                        record(self.motion)
                self._steer(active, ids, target, known)
                if self._parts.reach is not None:
                    self._collect(active)
        return self.motion

    def _locate(self, active: NDArray[np.bool_]) -> Known:
        """Poses and velocities as the vessels know them: as measured, or as estimated from that."""
        p, now = self._parts, self.motion
        seen = p.positioning.measure(p.keys, p.tick, now.pose, now.velocity)
        pose, velocity = p.pilot.locate(active, *seen)
        return Known(pose, velocity, now.pose if p.positioning.errors is None else pose)

    def _off_land(self, known: Known) -> Known:
        """With a filter: poses from which the item that each vessel collects lies in the water."""
        if self._parts.positioning.errors is None or self._parts.camera is None:
            return known
        pose = known.pose.copy()
        pose[..., :2] += self._parts.tracks.ashore
        return Known(pose, known.velocity, pose)

    def _feel(self, active: NDArray[np.bool_]) -> None:
        """Give vessels and items the wind and the water of the moment."""
        p = self._parts
        simulation, now = p.simulation, p.tick * CONTROL_S
        vessels = self.motion.pose[..., :2]
        simulation.vessel_wind[:], simulation.vessel_water[:] = p.forcing.at(now, vessels)
        if p.failures is not None:
            simulation.thrust_loss[:] = p.failures.losses(now)
        if p.bodies:
            items = simulation.item_xy
            simulation.item_wind[:], current = p.forcing.at(now, items)
            simulation.item_water[:] = current + p.forcing.item_noise(now, items.shape[1])

    def _look(self, active: NDArray[np.bool_], pose: NDArray[np.float64]) -> None:
        """Let the collectors' cameras look for items, from the measured poses."""
        p = self._parts
        if p.camera is None:
            return
        now, xy, nodes = self.motion.pose, p.simulation.item_xy, p.state.item_node
        sought = p.attempts.item
        self._look_out(active, p.tick, CONTROL_S, now, pose, xy, nodes, sought)

    def _known(self) -> NDArray[np.float64]:
        """(episode, vessel, item, 2) places of items as each vessel knows them [m]."""
        p = self._parts
        xy, vessels = p.simulation.item_xy, len(p.collects)
        if p.camera is None:
            return np.broadcast_to(xy[:, None], (len(xy), vessels, *xy.shape[1:]))
        out = np.empty_like(p.tracks.xy)
        tracked(p.tracks, p.grid, p.tick, CONTROL_S, out)
        return out

    def _seek(self, active: NDArray[np.bool_], sent: Sent, known: Known) -> None:
        """Give the pilots the item to collect, and the one to be ready for after it."""
        p = self._parts
        if p.reach is None:
            return
        goal = Goal.of(*sent.stay.shape)
        seek(
            p.reach,
            p.attempts,
            active,
            p.room_left,
            known.seeking,
            self._known(),
            sent,
            p.tick * np.float64(CONTROL_S),
            p.state,
            goal,
        )
        p.pilot.collect(goal.xy)
        p.pilot.expect(goal.next)
        p.pilot.look_round(goal.look)

    def _steer(
        self,
        active: NDArray[np.bool_],
        ids: NDArray[np.intp],
        target: NDArray[np.float64],
        known: Known,
    ) -> None:
        """One control tick from what the vessels know: command, step, take note."""
        p, before = self._parts, self.motion
        simulation = p.simulation
        simulation.commands[:] = p.pilot.command(active, known.pose, known.velocity)
        simulation.step(p.substeps, None if len(ids) == len(active) else ids)
        if p.contacts:
            simulation.separate_items(ids)
        self.motion = Motion(simulation.vessel_pose, simulation.vessel_velocity)
        p.tick[ids] += 1
        tick = Tick(
            before=before,
            after=self.motion,
            target=target,
            giving_way=p.pilot.giving_way,
            met=simulation.contact_pose,
            lagged=simulation.thruster_state,
        )
        self._monitor(active, tick)

    def _collect(self, active: NDArray[np.bool_]) -> None:
        """Capture rule `intake`, at every tick."""
        p = self._parts
        assert p.reach is not None, "with intake"
        about = self.motion.pose, p.simulation.item_xy, p.room_left, p.state, p.mouths
        if collect_at_mouth(p.reach, active, *about, p.tick * np.float64(CONTROL_S)):
            remove_collected(p.simulation, p.state)

    def end(self) -> None:
        """Have the host know all, as it does."""


def remove_collected(simulation: SimulatedFleet, state: Transition) -> None:
    """Take the bodies of collected items off the water."""
    simulation.remove_items((state.item_node < 0) & (simulation.item_class >= 0))
