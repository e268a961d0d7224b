"""A fleet that acts on tracks, for policies that differ in the assignment of items to foragers.

It believes what the belief planner believes: tracks, their drift, unseen items. Scouts buy places
to look from by what is expected in view there (`auctions.sell_views`); foragers that are given no
goal wait near to what may come.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.belief_planner.beliefs import Beliefs
from mjforage.graph_planner.belief_planner.connectivity import NOBODY
from mjforage.graph_planner.belief_planner.covers import landmarks_of
from mjforage.graph_planner.belief_planner.foraging import Collecting
from mjforage.graph_planner.belief_planner.move_preferences import approach, towards
from mjforage.graph_planner.belief_planner.routes import NOWHERE
from mjforage.graph_planner.belief_planner.settings import BeliefSettings
from mjforage.graph_planner.belief_planner.target_values import TargetValues, summed
from mjforage.graph_planner.belief_planner.ways import UNREACHED, Group, Ways, search_on
from mjforage.graph_planner.graph.geodesics import FAR, Int32Array
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.graph_planner.policy_parts.auctions import UNSOLD, FloatArray, in_view, sell_views
from mjforage.mission.plain import Plain
from mjforage.mission.task import Observation, Task, TaskArrays

_LEAST = 1e-9  # what a node is worth at least, so that there is somewhere to go

Goals = Callable[[Observation, int, Int32Array], None]
"""Fills the goals (forager,) of the foragers of one row, `NOWHERE` where one has none."""


@kernel
def _share_views(
    arrays: TaskArrays,
    views: NodeLists,
    ways: tuple[Ways, ...],
    kind: NDArray[np.int64],
    patience: float,
    at: Int32Array,
    energy: FloatArray,
    lookers: NDArray[np.int64],
    worth: FloatArray,
) -> Int32Array:
    """The places (looker,) that lookers win, `UNSOLD` where none; worth (node,) is changed.

    Ways are counted in decisions: an agent that moves two nodes at a time cannot reach every node.
    """
    places = np.arange(worth.size).astype(np.int32)
    far, row = np.full((lookers.size, places.size), FAR), np.empty(places.size, np.uint16)
    for i in range(lookers.size):
        agent = lookers[i]
        search_on(ways[kind[i]].ends, at[agent], row)
        for j in range(places.size):
            way = np.float64(row[j]) * arrays.moves[agent]
            if row[j] != UNREACHED and way <= energy[agent]:
                far[i, j] = way
    won, tie = np.empty(lookers.size, np.int32), np.ones(places.size)
    sell_views(places, far, lookers, arrays, views, patience, tie, worth, won)
    return won


@kernel
def _passed(
    arrays: TaskArrays, views: NodeLists, a: int, node: int, worth: FloatArray, out: FloatArray
) -> None:
    """Fill what the ends (node,) of an agent's moves show, as a share of the best of them."""
    targets, radius = arrays.targets[arrays.stride_number[a], node], arrays.radius_number[a]
    most = 0.0
    for move in range(9):
        if targets[move] >= 0:
            out[targets[move]] = in_view(worth, views, radius, targets[move])
            most = max(most, out[targets[move]])
    for move in range(9):
        if targets[move] >= 0 and most > 0.0:
            out[targets[move]] = min(1.0, out[targets[move]] / most)


class TrackingTeam:
    """Beliefs and preferences of a batch of rows; foragers' goals come from the policy.

    Attributes
    ----------
    beliefs : what each row believes
    collecting : the foragers, and what there is to collect in the row at hand
    """

    def __init__(self, task: Task, keys: UInt64Array, patience: float) -> None:
        self._settings, self._task = BeliefSettings.of(task.prior), task
        graph = task.graph
        self.beliefs = Beliefs(task, self._settings, keys)
        self.collecting = Collecting(task, self._settings)
        self._target_values = TargetValues(self.beliefs, self._settings, self.collecting.boundary)
        fleet = task.fleet
        self._lone = fleet.discoverers.size == 0
        self._lookers = Group.of(task, fleet.collectors if self._lone else fleet.discoverers)
        self._patience = patience
        self._landmarks, self._belongs = landmarks_of(graph)
        self._worth, self._nothing = np.zeros(len(graph)), np.zeros(len(graph))
        self._goals = np.empty(fleet.collectors.size, np.int32)
        self._plain = Plain(task, keys.size)
        self._preferences = np.zeros((keys.size, len(fleet), 9))

    def act(self, observation: Observation, give_goals: Goals) -> NDArray[np.float64]:
        """Preferences (row, agent, 9), the goals of foragers given row by row."""
        observation = self._plain(observation)
        for e in np.flatnonzero(observation.active).tolist():
            self.beliefs.learn(observation, e)
            now, goals = int(observation.step[e]) - 1, self._goals
            self._target_values.list_items(e, now, self.collecting.items)
            goals[:] = NOWHERE
            owner = int(observation.owner[e])  # whose move alone counts, unless it is nobody's
            collects = owner == NOBODY or bool(self._task.fleet.collects[owner])
            if collects:
                give_goals(observation, e, goals)
                self._collect(observation, e, goals)
            if owner == NOBODY or self._lone or not collects:
                self._look(observation, e, goals)
        return self._preferences

    def _collect(self, seen: Observation, e: int, goals: Int32Array) -> None:
        """Send foragers to their goals; those without one wait near to what may come."""
        collecting, preferences, at = self.collecting, self._preferences[e], seen.agent_node[e]
        items, group = collecting.items, collecting.group
        n, worth = int(items.number[0]), self._nothing
        if (goals != NOWHERE).any():
            graph = self._task.graph
            row, col = np.rint(items.row[:n]).astype(int), np.rint(items.col[:n]).astype(int)
            nodes = graph.node_of_cell[row, col]
            worth = summed(nodes[nodes >= 0], items.weight[:n][nodes >= 0], len(graph))
        mass = summed(self._belongs, self.beliefs.expected[e], self._landmarks.size)
        for f, agent in enumerate(group.agents):
            ways = group.ways[group.kind[f]]
            if goals[f] != NOWHERE:
                towards(ways, at[agent], goals[f], worth, preferences[agent])
            else:
                approach(ways, self._landmarks, mass, at[agent], preferences[agent])
        collecting.hold(at, seen.room_left[e], seen.energy_left[e], preferences)

    def _look(self, seen: Observation, e: int, goals: Int32Array) -> None:
        """Send scouts, or foragers without a goal where there are none, to look."""
        lookers, at, energy = self._lookers, seen.agent_node[e], seen.energy_left[e]
        free = energy[lookers.agents] >= 1.0
        arrays, views, preferences = self._task.arrays, self._task.views, self._preferences[e]
        if self._lone:
            free &= (goals == NOWHERE) & (seen.room_left[e][lookers.agents] > 0)
        else:
            for i in np.flatnonzero(~free):
                agent, ways = lookers.agents[i], lookers.ways[lookers.kind[i]]
                towards(ways, at[agent], at[agent], self._nothing, preferences[agent])
        who = lookers.agents[free]
        if not who.size:
            return
        worth = self._target_values.worth_seeing(seen, e) + _LEAST
        kinds = lookers.kind[free]
        about = arrays, views, lookers.ways, kinds, self._patience
        won = _share_views(*about, at, energy, who, worth.copy())
        for agent, kind, goal in zip(who, kinds, won, strict=True):
            goal = at[agent] if goal == UNSOLD else goal
            self._worth[:] = 0.0
            _passed(arrays, views, agent, at[agent], worth, self._worth)
            towards(lookers.ways[kind], at[agent], goal, self._worth, preferences[agent])
