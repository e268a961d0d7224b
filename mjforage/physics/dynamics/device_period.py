"""All ticks of a decision on a device, where kernels do what `HostPeriod` does in a loop.

The kernels are those that the processor runs. Before the ticks the device is told the orders, after
them the host knows where all is; in between nothing is copied, but for frames of a trajectory.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.base.device import Bind, Call
from mjforage.mission.item_rule import COLLECT
from mjforage.mission.moves import Moves
from mjforage.physics.dynamics.collecting import COLLECT_AT_MOUTH, SEEK, Goal, Sent
from mjforage.physics.dynamics.device_ticks import (
    ADD,
    COUNT,
    NOTE,
    READ_PLACES,
    REMOVE,
    SEND,
    SHIFT,
    SHOW_ALL,
)
from mjforage.physics.dynamics.faults import LOSE
from mjforage.physics.dynamics.item_bodies import READ_ITEMS
from mjforage.physics.dynamics.period_monitor import JUDGE, MONITOR, Motion, Tick
from mjforage.physics.dynamics.period_parts import Begun, Parts
from mjforage.physics.dynamics.settling import LOAD_VESSELS, SETTLE
from mjforage.physics.dynamics.ticks import CONTROL_S, WEATHER_TICKS
from mjforage.physics.dynamics.tracks import LOOK_OUT, TRACKED
from mjforage.physics.scene import parking_xy
from mjforage.physics.warp_simulation import WarpSimulation

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
Calls = tuple[Call, ...]


class DevicePeriod:
    """The ticks of a decision, bound to a batch; made anew when episodes of it start.

    Attributes
    ----------
    active : (episode,) those that go on, of the host
    hulls : the vessels on the device
    ran : True once the host may have written after ticks of the device
    """

    def __init__(self, parts: Parts[WarpSimulation], begun: Begun | None = None) -> None:
        """Bind all kernels to the parts' arrays, which the device then has as well.

        `begun`: episodes that began anew, where the device has all others; absent: all did.
        """
        self._parts, simulation = parts, parts.simulation
        self.hulls = simulation.hulls
        self.hulls.renew(begun.rows if begun else None)
        episodes, vessels = parts.tick.size, len(parts.collects)
        places = np.zeros((episodes, vessels, 2))
        self.active, self._target = np.zeros(episodes, np.bool_), places
        self._sent = Sent(places.copy(), np.zeros((episodes, vessels), np.bool_))
        self._now_s, self._xy = np.zeros(episodes), np.zeros((episodes, simulation.items, 2))
        state = parts.state
        shared = self.active, self._target, *self._sent, *parts.pilot.arrays, *parts.record
        of_items = state.pickup, state.item_node, state.collected_by, parts.room_left
        self._exchanged = [*shared, *of_items, *parts.motion, parts.tick, simulation.load]
        self._exchanged += simulation.arrays
        self._start, self._first, self._other = self._calls()
        self._losing = simulation.losing(self.active)
        self.ran = bool(begun and begun.ran)

    def _calls(self) -> tuple[Calls, Calls, Calls]:
        """Calls before all ticks, of a tick with new weather and goals, and of one without."""
        p, bind, active = self._parts, self.hulls.bind, self.active
        about = p.keys, p.tick, p.motion.pose, p.motion.velocity
        measure, seen = p.positioning.on_device(bind, *about)  # type: ignore[attr-defined]
        locate, pose, velocity = p.pilot.locating(bind, active, *seen)
        look: Calls = ()
        if p.camera is not None:
            sights = p.camera, p.grid, p.keys, p.collects, p.tracks, active, p.tick, CONTROL_S
            of_items = self._xy, p.state.item_node, p.attempts.item
            look = (bind(LOOK_OUT, *sights, p.motion.pose, pose, *of_items),)
        seeking = p.motion.pose if p.positioning.errors is None else pose
        if p.camera is not None and p.positioning.errors is not None:
            shifted = np.zeros_like(pose)
            look += (bind(SHIFT, pose, p.tracks.ashore, shifted),)
            pose = seeking = shifted
        known = *measure, *locate, *look
        steered = self._steered(pose, velocity)
        count = bind(COUNT, active, p.tick, 0, self._now_s)
        start = (count, self._read_places()) if p.bodies else (count,)
        return start, (*known, *self._felt(), *self._sought(seeking), *steered), (*known, *steered)

    def _read_places(self) -> Call:
        afloat, shift_s = self._parts.simulation.afloat, self._parts.simulation.shift_s
        return self.hulls.bind(READ_PLACES, afloat.q, afloat.v, shift_s, self._xy)

    def _felt(self) -> Calls:
        """Wind and water of the moment, and thrust that is lost."""
        p, bind, simulation = self._parts, self.hulls.bind, self._parts.simulation
        winds = simulation.vessel_wind, simulation.vessel_water
        felt = p.forcing.on_device(bind, self._now_s, p.motion.pose, *winds)
        if p.failures is not None:
            loss = p.failures.from_s, p.failures.loss
            felt += (bind(LOSE, *loss, self._now_s, simulation.thrust_loss),)
        if p.bodies:
            current, noise = np.zeros((2, *self._xy.shape))
            around = simulation.item_wind, current
            felt += p.forcing.on_device(bind, self._now_s, self._xy, *around)
            felt += (
                p.forcing.noise_on_device(bind, self._now_s, noise),
                bind(ADD, current, noise, simulation.item_water),
            )
        return felt

    def _sought(self, seeking: FloatArray) -> Calls:
        """Items for the pilots, from poses (episode, vessel, 3)."""
        p, bind, active = self._parts, self.hulls.bind, self.active
        if p.reach is None:
            return ()
        known = np.zeros((*p.attempts.item.shape, *self._xy.shape[1:]))
        show = bind(SHOW_ALL, self._xy, known)
        if p.camera is not None:
            show = bind(TRACKED, p.tracks, p.grid, p.tick, CONTROL_S, known)
        goal = Goal.of(*p.attempts.item.shape)
        about = p.reach, p.attempts, active, p.room_left, seeking, known, self._sent, self._now_s
        return show, bind(SEEK, *about, p.state, goal), p.pilot.telling(bind, *goal)

    def _steered(self, pose: FloatArray, velocity: FloatArray) -> Calls:
        """Command, step, take note, collect."""
        p, bind, active = self._parts, self.hulls.bind, self.active
        simulation = p.simulation
        command = p.pilot.commanding(bind, active, pose, velocity, simulation.commands)
        calls = (command, *simulation.calls(active) * p.substeps)
        if p.contacts:
            calls += (simulation.separating(active),)
        giving_way = np.zeros(p.state.agent_node.shape, np.bool_)
        before = Motion(*np.zeros((2, *pose.shape)))
        met, lagged = simulation.contact_state
        tick = Tick(before, p.motion, self._target, giving_way, met, lagged)
        way = met, simulation.velocity, simulation.shift_s
        calls += (
            bind(NOTE, *way, before, p.motion, giving_way),
            bind(COUNT, active, p.tick, 1, self._now_s),
            p.pilot.yielding(bind, giving_way),
            bind(MONITOR, p.monitor, p.record, active, tick),
        )
        if p.bodies:
            calls += (self._read_places(),)
        if p.reach is not None:
            about = p.reach, active, p.motion.pose, self._xy, p.room_left, p.state, p.mouths
            calls += (bind(COLLECT_AT_MOUTH, *about, self._now_s), *self._removed())
        return calls

    def _removed(self) -> Calls:
        """Take collected items off the water."""
        p, afloat = self._parts, self._parts.simulation.afloat
        parked = parking_xy(p.simulation.items), afloat.kind, afloat.q, afloat.v
        remove = self.hulls.bind(REMOVE, p.state.item_node, *parked)
        return remove, self._read_places()

    def run(
        self,
        active: BoolArray,
        target: FloatArray,
        sent: Sent,
        record: Callable[[Motion], None] | None,
    ) -> Motion:
        """Play the ticks of a decision, see `HostPeriod.run`."""
        orders = self.active, self._target, *self._sent
        for own, new in zip(orders, (active, target, *sent), strict=True):
            own[:] = new
        for array in self._exchanged:
            self.hulls.arrays.send(array)
        interval = (*self._first, *self._other * (WEATHER_TICKS - 1))
        self.hulls.run(self._start)
        for past in range(self._parts.ticks // WEATHER_TICKS):
            if record is not None and past:
                self._fetch(self._exchanged)
                record(self._parts.motion)
            self.hulls.run(interval)
        self.hulls.run((self._losing,))
        self.hulls.wait()
        self._fetch(self._exchanged)
        self.ran = True
        self._parts.simulation.check()
        return self._parts.motion

    @property
    def memory_bytes(self) -> int:
        """Memory of an episode on the device."""
        return self.hulls.memory_bytes

    def _fetch(self, arrays: list[NDArray[Any]]) -> None:
        for array in arrays:
            self.hulls.arrays.fetch(array)

    @property
    def bind(self) -> Bind:
        """Binds kernels to arrays of the host, or to what these are on the device."""
        return self.hulls.bind

    def check(self) -> None:
        """Wait for all calls, and refuse what has no place any more; raises `InstabilityError`."""
        self.hulls.wait()
        simulation = self._parts.simulation
        self._fetch(simulation.faults)
        if any(noted.any() for noted in simulation.faults):
            self.come_back()
        simulation.check()

    def come_back(self) -> None:
        """Have the host know where all is."""
        self._fetch([self._parts.tick, *self._parts.motion, *self._parts.simulation.arrays])

    def deciding(self, moves: Moves) -> Calls:
        """Calls that carry out moves of the episodes that are `active`, all of it on the device."""
        p, bind, active, state = self._parts, self.hulls.bind, self.active, self._parts.state
        origin = np.zeros_like(self._target)
        orders = origin, self._target, self._sent
        interval = (*self._first, *self._other * (WEATHER_TICKS - 1))
        calls = [
            bind(SEND, p.berths, active, moves, state, *orders, p.record),
            p.pilot.ordering(bind, active, origin, self._target, self._sent.stay),
            *self._start,
            *interval * (p.ticks // WEATHER_TICKS),
            self._losing,
            bind(SETTLE, p.ground, active, p.motion.pose, p.record, p.pilot.arrays[0], state),
            bind(JUDGE, active, moves.blocked, p.record, state.outcome),
            bind(READ_ITEMS, active, self._xy, p.ground.water, p.ground.pitch_m, state),
        ]
        if p.reach is None:
            calls += [bind(COLLECT, active, p.collects, p.room_left, state), *self._removed()]
        return *calls, bind(LOAD_VESSELS, p.ground, active, p.room_left, p.simulation.load)

    def end(self) -> None:
        """Have the host know all that the device does, before the host changes it.

        What the host has been told after the ticks it may have written since.
        """
        told = {id(array) for array in (*self._exchanged, *self._parts.state) if self.ran}
        every = self.hulls.arrays.arrays
        self._fetch([one for one in every if one.flags.writeable and id(one) not in told])
