"""The lawnmower: agents sweep the map in lanes.

Lanes are rows two sensing radii and a node apart; a lane's corners are the ends of its stretches of
water, alternating in direction. Every team splits its list of corners into equal shares, and every
agent goes through its share by shortest paths, again and again. Foragers
leave their lane for the nearest known item.
"""

import numpy as np
from numpy.typing import NDArray

from graph_planner.compiled import kernel
from graph_planner.geodesics import FAR, Float32Array, Int32Array, distances_to_nearest
from graph_planner.moves import move_length
from graph_planner.navigation import STAY, NavigationGraph
from graph_planner.policies.registry import register
from graph_planner.randomness import UInt64Array
from graph_planner.seeking import ItemSeeker, possible_targets
from graph_planner.task import Observation, Task


def lane_corners(graph: NavigationGraph, spacing: int) -> Int32Array:
    """(corner,) nodes at the ends of every lane's stretches of water, in sweeping order.

    Parameters
    ----------
    graph : the map
    spacing : rows from lane to lane, 1 or more
    """
    corners: list[int] = []
    for lane, row in enumerate(
        range(min(spacing // 2, graph.shape[0] - 1), graph.shape[0], spacing)
    ):
        cols = np.flatnonzero(graph.navigable[row])
        if cols.size == 0:
            continue
        stretches = np.split(cols, np.flatnonzero(np.diff(cols) > 1) + 1)
        ends = [col for stretch in stretches for col in dict.fromkeys((stretch[0], stretch[-1]))]
        ordered = ends if lane % 2 == 0 else ends[::-1]
        corners.extend(int(graph.node_of_cell[row, col]) for col in ordered)
    return np.array(corners or [0], np.int32)


@kernel
def _sweep(
    active: NDArray[np.bool_],
    agent_node: Int32Array,
    corners: Int32Array,
    share_start: NDArray[np.int64],
    share_size: NDArray[np.int64],
    neighbours: Int32Array,
    table: Float32Array,
    moves: NDArray[np.int64],
    stay: bool,
    shorten: bool,
    distance: NDArray[np.float64],
    touched: Int32Array,
    current: NDArray[np.int64],
    patience: NDArray[np.int64],
    preferences: NDArray[np.float64],
) -> None:
    n_agents = agent_node.shape[1]
    targets = np.empty((n_agents, 9), np.int32)
    here = np.full((1, 9), np.int32(-1), np.int32)
    out = np.empty((1, 9))
    corner = np.empty(1, np.int32)
    for e in range(active.size):
        if not active[e]:
            continue
        possible_targets(neighbours, agent_node[e], moves, stay, shorten, targets)
        for a in range(n_agents):
            patience[e, a] -= 1
            for _ in range(share_size[a]):
                corner[0] = corners[share_start[a] + current[e, a]]
                here[0, STAY] = agent_node[e, a]
                centre = agent_node[e, a : a + 1]
                distances_to_nearest(
                    neighbours, table, corner, centre, here, 0.0, distance, touched, out
                )
                reached = out[0, STAY] < moves[a]
                if not reached and patience[e, a] != 0:
                    break
                current[e, a] = (current[e, a] + 1) % share_size[a]
                patience[e, a] = -1
            if patience[e, a] < 0:  # a corner that two-node moves step over is given up in time
                patience[e, a] = 8 + int(2.0 * out[0, STAY])
            slack = 1.5 * moves[a]
            distances_to_nearest(
                neighbours,
                table,
                corner,
                centre,
                targets[a : a + 1],
                slack,
                distance,
                touched,
                out,
            )
            for move in range(9):
                preferences[e, a, move] = -np.inf
                if targets[a, move] >= 0 and out[0, move] < FAR:
                    cost = 1.5 if move == STAY else 0.01 * move_length(move, moves[a])
                    preferences[e, a, move] = -out[0, move] - cost


@register("lawnmower")
class LawnmowerPolicy:
    """Sweeps the map in lanes; foragers leave their lane for the nearest known item."""

    def reset(self, task: Task, keys: UInt64Array) -> None:
        """Get ready for a batch of episodes (episode,)."""
        self._task = task
        self._seeker = ItemSeeker(task)
        agents = (keys.size, len(task.fleet))
        self._distance = np.full(len(task.graph), FAR)
        self._touched = np.empty(len(task.graph), np.int32)
        self._current = np.zeros(agents, np.int64)
        self._patience = np.zeros(agents, np.int64)
        self._preferences = np.zeros((*agents, 9))
        self._plan(task)

    def _plan(self, task: Task) -> None:
        """Lay out each agent's share of its team's corners in one flat list."""
        fleet = task.fleet
        shares: list[Int32Array] = []
        for agent in range(len(fleet)):
            team = np.flatnonzero(fleet.team == fleet.team[agent])
            corners = lane_corners(task.graph, 2 * int(fleet.radius[agent]) + 1)
            parts = np.array_split(corners, team.size)
            mine = parts[int(np.flatnonzero(team == agent)[0])]
            shares.append(mine if mine.size else corners[:1])
        self._corners = np.concatenate(shares).astype(np.int32)
        self._share_size = np.array([share.size for share in shares], np.int64)
        self._share_start = np.concatenate(([0], np.cumsum(self._share_size)[:-1])).astype(np.int64)

    def act(self, observation: Observation) -> NDArray[np.float64]:
        """Preferences (episode, agent, 9): down the way to the agent's next corner."""
        task = self._task
        _sweep(
            observation.active,
            observation.agent_node,
            self._corners,
            self._share_start,
            self._share_size,
            task.graph.neighbours,
            task.graph.distances,
            task.fleet.moves,
            task.rules.stay,
            task.rules.shorten,
            self._distance,
            self._touched,
            self._current,
            self._patience,
            self._preferences,
        )
        self._seeker.guide(observation, self._preferences)
        return self._preferences
