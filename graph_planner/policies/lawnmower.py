"""The lawnmower: agents sweep the map in lanes.

Lanes are rows two sensing radii and a node apart; a lane's corners are the ends of its stretches of
water, alternating in direction. Every team splits its list of corners into equal shares, and every
agent goes through its share by shortest paths, again and again. Foragers
leave their lane for the nearest known item.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.graph_planner.graph.geodesics import FAR, Int32Array, Workspace, distances_to_nearest
from mjforage.graph_planner.graph.navigation import STAY, NavigationGraph
from mjforage.graph_planner.policies.registry import register
from mjforage.graph_planner.policy_parts.kernel_policy import KernelPolicy, Preferences
from mjforage.graph_planner.policy_parts.seeking import longest_move, possible_targets
from mjforage.mission.moves import move_length
from mjforage.mission.task import Observation, Task, TaskArrays


def lane_corners(graph: NavigationGraph, spacing: int) -> Int32Array:
    """(corner,) nodes at the ends of every lane's stretches of water, in sweeping order.

    `graph`: the map; `spacing`: rows from lane to lane, 1 or more.
    """
    corners: list[int] = []
    first = min(spacing // 2, graph.shape[0] - 1)
    for lane, row in enumerate(range(first, graph.shape[0], spacing)):
        cols = np.flatnonzero(graph.navigable[row])
        if cols.size == 0:
            continue
        stretches = np.split(cols, np.flatnonzero(np.diff(cols) > 1) + 1)
        ends = [col for stretch in stretches for col in dict.fromkeys((stretch[0], stretch[-1]))]
        ordered = ends if lane % 2 == 0 else ends[::-1]
        corners.extend(int(graph.node_of_cell[row, col]) for col in ordered)
    return np.array(corners or [0], np.int32)


class Sweep(NamedTuple):
    """Position of each agent in its share of the corners."""

    corners: Int32Array  # (corner,) all agents' shares, one after the other
    share_start: NDArray[np.int64]  # (agent,)
    share_size: NDArray[np.int64]  # (agent,)
    current: NDArray[np.int64]  # (episode, agent) corner of the share that is steered for
    patience: NDArray[np.int64]  # (episode, agent) steps until an unreached corner is given up


@kernel
def _sweep(
    arrays: TaskArrays,
    sweep: Sweep,
    workspace: Workspace,
    preferences: NDArray[np.float64],
    seen: Observation,
) -> None:
    """Fill preferences: down the way to each agent's next corner."""
    active, agent_node, moves = seen.active, seen.agent_node, arrays.moves
    neighbours, distances = arrays.neighbours, arrays.distances
    current, patience = sweep.current, sweep.patience
    n_agents, slack = agent_node.shape[1], longest_move(arrays)
    targets = np.empty((n_agents, 9), np.int32)
    here = np.full((1, 9), np.int32(-1), np.int32)
    out = np.empty((1, 9))
    for e in range(active.size):
        if not active[e]:
            continue
        possible_targets(arrays, agent_node[e], targets)
        for a in range(n_agents):
            centre, size = agent_node[e, a : a + 1], sweep.share_size[a]
            first = sweep.share_start[a] + current[e, a]
            corner = sweep.corners[first : first + 1]
            here[0, STAY] = centre[0]
            patience[e, a] -= 1
            for _ in range(size):
                distances_to_nearest(
                    neighbours, distances, corner, centre, here, 0.0, workspace, out
                )
                if out[0, STAY] >= moves[a] and patience[e, a] != 0:
                    break
                current[e, a] = (current[e, a] + 1) % size
                first = sweep.share_start[a] + current[e, a]
                corner = sweep.corners[first : first + 1]
                patience[e, a] = -1
            if patience[e, a] < 0:  # two-node moves may step over a corner for ever
                patience[e, a] = 8 + int(2.0 * out[0, STAY])
            reach = targets[a : a + 1]
            distances_to_nearest(
                neighbours, distances, corner, centre, reach, slack, workspace, out
            )
            for move in range(9):
                preferences[e, a, move] = -np.inf
                if targets[a, move] >= 0 and out[0, move] < FAR:
                    cost = 1.5 if move == STAY else 0.01 * move_length(move, moves[a])
                    preferences[e, a, move] = -out[0, move] - cost


@register("lawnmower")
class LawnmowerPolicy(KernelPolicy):
    """Sweeps the map in lanes; foragers leave their lane for the nearest known item."""

    seeks = True

    def filled(self, task: Task, preferences: Preferences) -> BoundKernel[None]:
        """Down the way to the agent's next corner."""
        self.sweep, room = self._plan(task, len(preferences)), Workspace.of(len(task.graph))
        return BoundKernel(_sweep, task.arrays, self.sweep, room, preferences)

    def _plan(self, task: Task, episodes: int) -> Sweep:
        """Lay out each agent's share of its team's corners in one flat list."""
        fleet = task.fleet
        shares: list[Int32Array] = []
        for agent in range(len(fleet)):
            team = np.flatnonzero(fleet.team == fleet.team[agent])
            corners = lane_corners(task.graph, 2 * int(fleet.radius[agent]) + 1)
            mine = np.array_split(corners, team.size)[int(np.flatnonzero(team == agent)[0])]
            shares.append(mine if mine.size else corners[:1])
        size = np.array([share.size for share in shares], np.int64)
        return Sweep(
            corners=np.concatenate(shares).astype(np.int32),
            share_start=np.cumsum(size) - size,
            share_size=size,
            current=np.zeros((episodes, len(fleet)), np.int64),
            patience=np.zeros((episodes, len(fleet)), np.int64),
        )
