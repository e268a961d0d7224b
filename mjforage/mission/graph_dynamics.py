"""Graph dynamics: an agent is in its target node after every decision, items follow `ItemRule`.

Order (definitions, section 1): all move; foragers remove every item in their node; the rest drift.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.base.randomness import UInt64Array
from mjforage.base.rows import scatter_all
from mjforage.forcing import Forcing
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.navigation import OFFSETS, STAY, NavigationGraph
from mjforage.mission.capture_chances import pickup_of
from mjforage.mission.dynamics import ARRIVED, BLOCKED, NOBODY, Transition, start_state
from mjforage.mission.initial_state import InitialState
from mjforage.mission.item_rule import item_rule
from mjforage.mission.moves import Moves, move_length
from mjforage.mission.trajectory import TrajectoryRecorder
from mjforage.scenario.place import Place
from mjforage.scenario.roles import Fleet
from mjforage.scenario.scenario import Scenario


@kernel
def _move(
    centres: NDArray[np.float64],
    yaws: NDArray[np.float64],
    state: Transition,
    active: NDArray[np.bool_],
    moves: Moves,
) -> None:
    """Put every agent into its target node; distance, energy and speed follow from the move."""
    direction, target, steps, blocked = moves
    agent_node, agent_rc, yaw = state.agent_node, state.agent_rc, state.agent_yaw
    speed, outcome = state.agent_speed, state.outcome
    distance, energy = state.distance, state.energy
    for e in range(active.size):
        if not active[e]:
            continue
        for a in range(agent_node.shape[1]):
            length = move_length(direction[e, a], steps[e, a])
            node = target[e, a]
            agent_node[e, a] = node
            agent_rc[e, a, 0], agent_rc[e, a, 1] = centres[node, 0], centres[node, 1]
            if direction[e, a] != STAY:
                yaw[e, a] = yaws[direction[e, a]]
            speed[e, a] = length
            outcome[e, a] = BLOCKED if blocked[e, a] else ARRIVED
            distance[e, a] += length
            energy[e, a] += length


def graph_scenario(scenario: Scenario) -> Scenario:
    """The scenario without gusts, and without currents where the paper's rule lets items drift."""
    weather = scenario.weather if scenario.weather.forced else scenario.weather.over_still_water()
    return replace(scenario, weather=weather.without_gusts())


class GraphDynamics:
    """The paper's world. Distances and energy are in node lengths.

    Attributes
    ----------
    pickup : mean delays of collecting, None if a forager takes all that is in its node
    """

    def __init__(
        self,
        graph: NavigationGraph,
        fleet: Fleet,
        scenario: Scenario,
        trajectory: TrajectoryRecorder | None = None,
        place: Place | None = None,
    ) -> None:
        """Prepare.

        Raises `UserError` if capture is calibrated and a vessel that collects is not.
        """
        self._graph, self._trajectory, self._period_s = graph, trajectory, scenario.period_s
        self._items = item_rule(graph, fleet, scenario, place)
        self.pickup = None if self._items.chances is None else pickup_of(fleet, scenario)
        self._forced = graph_scenario(scenario), place
        self._centres = np.stack((graph.rows, graph.cols), axis=1).astype(np.float64)
        self._yaw = np.array([math.atan2(-down, right) for down, right in OFFSETS])

    def reset(self, initial: InitialState, keys: UInt64Array, names: Sequence[str]) -> Transition:
        """Start a batch of episodes and return their state at step 0."""
        self._begin(start_state(initial, self._centres))
        self._items.reset(initial, keys, self._state)
        if self._trajectory is not None:
            self._trajectory.start(self._period_s)
            scenario, place = self._forced
            self._forcing, self._frames = Forcing.of(scenario, keys[:1], self._graph, place), 0
        self._record()
        return self._state

    def _begin(self, state: Transition) -> None:
        self._state, self._move = state, BoundKernel(_move, self._centres, self._yaw, state)

    def restart(
        self,
        rows: NDArray[np.int64],
        initial: InitialState,
        keys: UInt64Array,
        names: Sequence[str],
    ) -> Transition:
        """Start other episodes in some rows (row,) of the batch; returns the state of all."""
        fresh = start_state(initial, self._centres)
        self._begin(scatter_all(self._state, rows, fresh, NOBODY))
        self._items.restart(rows, initial, keys, fresh, self._state)
        return self._state

    def drift_rc(self, rc: NDArray[np.float64], items: bool = False) -> NDArray[np.float64]:
        """(episode, place, 2) drift of items [node/step]."""
        return self._items.drift_rc(rc, items)

    def advance(self, active: NDArray[np.bool_], step: Int32Array, moves: Moves) -> Transition:
        """Carry out one decision: move, collect, drift. Inactive episodes do not change."""
        self._move(active, moves)
        self._items.advance(active, step)
        if active[0]:
            self._record()
        return self._state

    def _record(self) -> None:
        if self._trajectory is None:
            return
        state, metres = self._state, self._graph.metres
        pose = np.column_stack((metres(state.agent_rc[0]), state.agent_yaw[0]))
        wind = self._forcing.open_water(self._frames * self._period_s).wind[0]
        self._frames += 1
        self._trajectory.record(pose, metres(state.item_rc[0]), state.item_node[0] >= 0, wind)
