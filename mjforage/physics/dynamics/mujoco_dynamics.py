"""Dynamics in MuJoCo: decisions carried out by vessels in MuJoCo, under one weather for all.

A decision becomes a waypoint; `HostPeriod` or `DevicePeriod` steer to it; the state at the period's
end is the same `Transition` as at graph level. `monitor` defines arrived, late and blocked.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import NDArray

from mjforage.base.device import SIMULATED
from mjforage.base.errors import UserError
from mjforage.base.randomness import UInt64Array
from mjforage.base.rows import scatter_all, scatter_rows
from mjforage.controllers import Chart, Pilot
from mjforage.forcing import LEEWAY, Forcing
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.navigation import STAY, NavigationGraph
from mjforage.mission.capture_chances import pickup_of
from mjforage.mission.dynamics import NOBODY, Transition, start_state
from mjforage.mission.initial_state import InitialState
from mjforage.mission.item_classes import draw_classes, leeways
from mjforage.mission.item_rule import collect, item_rule
from mjforage.mission.moves import Moves
from mjforage.mission.task import IDLE
from mjforage.mission.trajectory import TrajectoryRecorder
from mjforage.physics.dynamics.berths import berths, clear_of_walls, turn_of
from mjforage.physics.dynamics.camera import ticked_camera
from mjforage.physics.dynamics.collecting import Attempts, Reach, Sent, mouths_of
from mjforage.physics.dynamics.device_ticks import Berths
from mjforage.physics.dynamics.engines import check_device, create_simulation
from mjforage.physics.dynamics.faults import failures
from mjforage.physics.dynamics.fleet_scene import (
    fleet_scene,
    fleet_vessels,
    known_vessels,
)
from mjforage.physics.dynamics.host_period import HostPeriod, remove_collected
from mjforage.physics.dynamics.item_bodies import read_items
from mjforage.physics.dynamics.period_monitor import MonitorSetup, Motion, PeriodRecord, judge
from mjforage.physics.dynamics.period_parts import Begun, Parts
from mjforage.physics.dynamics.settling import Ground, load_vessels, settle
from mjforage.physics.dynamics.ticks import CONTROL_S, WEATHER_TICKS, whole_times
from mjforage.physics.dynamics.tracks import ItemTracks, LandGrid
from mjforage.physics.hydrodynamics.parameters import pack_fleet
from mjforage.physics.positioning import create_positioning
from mjforage.physics.scaled_vessels import deviations
from mjforage.physics.simulation import Integrator
from mjforage.physics.simulation.simulated_fleet import SimulatedFleet
from mjforage.physics.vessel_models import vessel_model
from mjforage.scenario.debris import item_choices
from mjforage.scenario.place import Place
from mjforage.scenario.roles import Fleet
from mjforage.scenario.scenario import Scenario

if TYPE_CHECKING:
    from mjforage.physics.dynamics.device_period import DevicePeriod
    from mjforage.physics.warp_simulation import WarpSimulation


class MujocoDynamics:
    """Vessels and floating bodies. Distances and energy are in node lengths, as at graph level."""

    def __init__(
        self,
        graph: NavigationGraph,
        fleet: Fleet,
        scenario: Scenario,
        trajectory: TrajectoryRecorder | None = None,
        place: Place | None = None,
    ) -> None:
        """Read vessels and build what does not depend on the episode.

        Raises `UserError` if a vessel or an item class is not known, a capture model is wanted and
        not there, a vessel does not fit on the map, the scenario's times do not fit together, items
        without bodies shall enter a mouth, moves jump, or there shall be a current on a map without
        an open border.
        """
        if scenario.rules.jump:
            raise UserError("rules.jump = true: hulls cannot cross land; use the graph world")
        self._graph, self._fleet, self._scenario = graph, fleet, scenario
        self._trajectory, self._choice = trajectory, scenario.physics
        self._globe = place
        weather_s, integrator = WEATHER_TICKS * CONTROL_S, Integrator(self._choice.integrator)
        self._step_s = step_s = self._choice.step_s or integrator.step_s
        self._ticks = WEATHER_TICKS * whole_times(
            scenario.period_s, weather_s, f"period_s = {scenario.period_s:g} s"
        )
        self._substeps = whole_times(CONTROL_S, step_s, f"physics.step_s = {step_s:g} s")
        self._vessels = fleet_vessels(fleet, self._choice)
        self._classes = item_choices(self._choice)
        self._bodies = self._choice.items == "bodies"
        self._contacts = self._bodies and self._choice.item_contacts
        self._intake = self._choice.capture == "intake"
        self._rule = None if self._bodies else item_rule(graph, fleet, scenario, place)
        certain = not self._intake and (self._rule is None or self._rule.chances is None)
        self.pickup = None if certain else pickup_of(fleet, scenario)
        self._mouths = mouths_of(self._choice, len(fleet), CONTROL_S)
        self._scene = fleet_scene(graph, self._vessels, tuple(fleet.names), place)
        self._models = [vessel_model(vessel) for vessel in known_vessels(fleet, self._choice)]
        positioning = create_positioning(scenario.sensors, (0, len(fleet)), CONTROL_S)
        check_device(self._choice, scenario.sensors.positioning, positioning)
        self._chart = Chart(graph.navigable, graph.pitch_m, self._scene.walls)
        self._grid = LandGrid(self._chart.land, graph.pitch_m)
        self._camera = ticked_camera(scenario.sensors)
        self._has_camera = self._intake and scenario.sensors.camera_noise_m > 0.0
        self._size = np.array([(0.5 * v.length_m, 0.5 * v.beam_m) for v in self._vessels])
        narrow = self._has_camera and scenario.sensors.camera_fov_deg < 360.0
        self._reach = Reach(fleet.collects, self._size, self._grid, narrow)
        self._monitor_setup = MonitorSetup(
            pack_fleet(self._vessels), self._size, *self._grid, CONTROL_S
        )
        Forcing.of(scenario, np.zeros(1, np.uint64), graph, place)
        centres = np.stack((graph.rows, graph.cols), axis=1).astype(np.float64)
        self._centres, self._centres_xy = centres, graph.metres(centres)
        room, most = turn_of(self._size), int(fleet.moves.max())
        self._ground = Ground(graph.water, graph.pitch_m, fleet.capacity)
        self._berths_xy = berths(*self._grid, self._centres_xy, room, most)

    def reset(self, initial: InitialState, keys: UInt64Array, names: Sequence[str]) -> Transition:
        """Start a batch of episodes and return their state at step 0."""
        episodes, items = initial.item_node.shape
        self._player: HostPeriod | DevicePeriod | None = None  # made when it is needed
        self._begun: Begun | None = None  # of which the host alone knows
        self._simulation = create_simulation(
            self._choice,
            self._scene,
            episodes,
            step_s=self._step_s,
            seeds=names,
            items=items if self._bodies else 0,
        )
        shape = initial.agent_node.shape
        self._positioning = create_positioning(self._scenario.sensors, shape, CONTROL_S)
        errors = self._positioning.errors
        faults = self._scenario.faults
        notices = faults.any and faults.noticed
        about = self._models, self._chart, episodes, CONTROL_S, errors
        self._pilot = Pilot(*about, notices=notices)
        self._period = PeriodRecord.of(initial.agent_node.shape)
        self._tick = np.zeros(episodes, np.int64)
        self._room_left = np.tile(self._fleet.capacity, (episodes, 1))
        self._state = start_state(initial, self._centres)
        self._attempts, self._tracks = self._no_attempts(initial), self._no_tracks(initial)
        self._mouths = self._mouths.of(episodes)
        self._begin(keys)
        if self._rule is not None:
            self._rule.reset(initial, keys, self._state)
            self._room_left = self._rule.room_left
        self._place(np.arange(episodes), initial, keys)
        if self._trajectory is not None:
            self._trajectory.start(WEATHER_TICKS * CONTROL_S)
            self._record(self._motion)
        return self._state

    def restart(
        self,
        rows: NDArray[np.int64],
        initial: InitialState,
        keys: UInt64Array,
        names: Sequence[str],
    ) -> Transition:
        """Start other episodes in some rows (row,) of the batch; returns the state of all."""
        fresh = start_state(initial, self._centres)
        wider = initial.item_node.shape[1] > self._state.item_node.shape[1]
        self._leave(None if wider else rows)
        self._simulation.restart(rows, names, initial.item_node.shape[1] if self._bodies else 0)
        self._pilot.reset(rows)
        self._positioning.reset(rows)
        self._period.forget(rows)
        self._tick[rows] = 0
        self._room_left[rows] = self._fleet.capacity
        self._state = scatter_all(self._state, rows, fresh, NOBODY)
        self._attempts = scatter_all(self._attempts, rows, self._no_attempts(initial), ("item",))
        self._mouths.ready_s[rows] = 0.0
        self._tracks = self._tracks.with_rows(rows, self._no_tracks(initial))
        self._begin(scatter_rows(self._keys, rows, keys))
        if self._rule is not None:
            self._rule.restart(rows, initial, keys, fresh, self._state)
            self._room_left = self._rule.room_left
        self._place(rows, initial, keys)
        return self._state

    def _no_attempts(self, initial: InitialState) -> Attempts:
        return Attempts.of(len(self._fleet), initial.item_node)

    def _no_tracks(self, initial: InitialState) -> ItemTracks:
        """Tracks before the first frame; of no item where there is no camera."""
        items = initial.item_node if self._has_camera else initial.item_node[:, :0]
        return ItemTracks.of(self._camera, len(self._fleet), items)

    def _begin(self, keys: UInt64Array) -> None:
        """Take the keys of the batch, with the weather that they decide."""
        self._keys = keys
        self._forcing = Forcing.of(self._scenario, keys, self._graph, self._globe)
        self._failures = failures(self._scenario.faults, self._fleet, keys)

    def _place(self, rows: NDArray[np.int64], initial: InitialState, keys: UInt64Array) -> None:
        """Put vessels and items of some episodes where they start."""
        pose = np.zeros((*initial.agent_node.shape, 3))
        pose[..., :2] = self._berths_xy[initial.agent_node]
        self.place(pose, rows)
        self._simulation.spread[rows] = deviations(self._choice.spread, len(self._fleet), keys)
        if self._bodies:
            classes = draw_classes(keys, initial.item_node, self._classes)
            xy = self._graph.metres(initial.item_rc)
            nodes = self._centres_xy[initial.item_node]
            clear_of_walls(*self._grid, nodes.reshape(-1, 2), xy.reshape(-1, 2))
            self._simulation.place_items(xy, classes, rows)

    def place(self, pose: NDArray[np.float64], rows: NDArray[np.int64] | None = None) -> None:
        """Put the vessels of some episodes, by default of all, elsewhere and at rest.

        `pose`: (row, vessel, 3) [m], [rad].
        """
        self._leave(None if self._player else rows)
        self._simulation.place_vessels(pose, ids=rows)
        self._motion = Motion(self._simulation.vessel_pose, self._simulation.vessel_velocity)

    def drift_rc(self, rc: NDArray[np.float64], items: bool = False) -> NDArray[np.float64]:
        """(episode, place, 2) velocity of items by mean wind and current [node/step]."""
        if self._rule is not None:
            return self._rule.drift_rc(rc, items)
        leeway = leeways(self._simulation.item_class) if items else np.full(rc.shape[:2], LEEWAY)
        return self._forcing.carried_rc(self._tick * CONTROL_S, rc, leeway)

    def advance(self, active: NDArray[np.bool_], step: Int32Array, moves: Moves) -> Transition:
        """Carry out one decision: steer, drift, collect. Inactive episodes do not change."""
        state = self._state
        if not active.any():
            return state
        target, nodes = self._berths_xy[moves.target], self._centres_xy[moves.target]
        stay = moves.direction == STAY
        self._pilot.order(active, self._berths_xy[state.agent_node], target, stay)
        self._period.begin(active)
        state.pickup[active] = IDLE
        recorded = self._trajectory is not None and bool(active[0])
        record = self._record if recorded else None
        self._motion = self._playing.run(active, target, Sent(nodes, stay), record)
        self._settle(active, step, moves)
        if recorded:
            self._record(self._motion)
        load_vessels(self._ground, active, self._room_left, self._simulation.load)
        return state

    @property
    def network_device(self) -> str:
        """Device of torch where networks decide: that of the hulls."""
        return "cuda" if self._choice.device == "cuda" and not SIMULATED else "cpu"

    @property
    def may_decide_on_device(self) -> bool:
        """True if whole decisions can be carried out there: with bodies, and nothing recorded."""
        there = self._choice.device != "cpu"
        return there and self._bodies and self._trajectory is None

    def on_device(self) -> "DevicePeriod":
        """The ticks of a period on the device, which then has all of the batch."""
        return cast("DevicePeriod", self._playing)

    @property
    def _playing(self) -> "HostPeriod | DevicePeriod":
        """The ticks of a period, of the batch as it is."""
        if self._player is None:
            parts = self._parts()
            if self._choice.device == "cpu":
                self._player = HostPeriod(parts)
            else:
                from mjforage.physics.dynamics.device_period import DevicePeriod

                self._player = DevicePeriod(cast("Parts[WarpSimulation]", parts), self._begun)
            self._begun = None
        return self._player

    def _parts(self) -> Parts[SimulatedFleet]:
        return Parts(
            simulation=self._simulation,
            pilot=self._pilot,
            positioning=self._positioning,
            forcing=self._forcing,
            failures=self._failures,
            reach=self._reach if self._intake else None,
            camera=self._camera if self._has_camera else None,
            grid=self._grid,
            bodies=self._bodies,
            contacts=self._contacts,
            monitor=self._monitor_setup,
            keys=self._keys,
            tick=self._tick,
            motion=self._motion,
            state=self._state,
            record=self._period,
            room_left=self._room_left,
            attempts=self._attempts,
            mouths=self._mouths,
            tracks=self._tracks,
            collects=self._fleet.collects,
            ground=self._ground,
            berths=Berths(self._berths_xy, self._centres_xy),
            ticks=self._ticks,
            substeps=self._substeps,
        )

    @property
    def memory_bytes(self) -> int:
        """Memory of an episode on a device, 0 if it is not there."""
        return getattr(self._player, "memory_bytes", 0)

    def _leave(self, rows: NDArray[np.int64] | None) -> None:
        """Have the host know all, before it changes any of it.

        `rows`: if not None, the episodes that begin anew; those that go on stay on the device.
        """
        if rows is None:
            if self._player or self._begun:
                self._playing.end()
            self._begun = None
        elif self._player:
            self._begun = Begun(rows, self._player.ran)
        elif self._begun:
            self._begun = Begun(np.union1d(self._begun.rows, rows), self._begun.ran)
        self._player = None

    def _settle(self, active: NDArray[np.bool_], step: Int32Array, moves: Moves) -> None:
        """Write the period's end into the state."""
        state, record, graph = self._state, self._period, self._graph
        pilots = self._pilot.arrays[0]
        settle(self._ground, active, self._motion.pose, record, pilots, state)
        judge(active, moves.blocked, record, state.outcome)
        if self._rule is not None:
            self._rule.advance(active, step)
            return
        read_items(active, self._simulation.item_xy, graph.water, graph.pitch_m, state)
        if not self._intake:
            collect(active, self._fleet.collects, self._room_left, state)
            remove_collected(self._simulation, state)

    def _record(self, motion: Motion) -> None:
        """A frame of the first episode, with the free wind."""
        assert self._trajectory is not None
        simulation, state, items = self._simulation, self._state, self._state.item_node.shape[1]
        xy = simulation.item_xy[0, :items] if self._bodies else self._graph.metres(state.item_rc[0])
        wind = self._forcing.open_water(self._tick * CONTROL_S).wind[0]
        self._trajectory.record(motion.pose[0], xy, state.item_node[0] >= 0, wind)
