"""Particle swarm of the group's paper of 2025 (IEEE RA-L 10(5):4930, preprint arXiv 2412.02316).

v += c1 u1 (own best place - p) + c2 u2 (node with most believed items - p) + c3 u3 (nearest node
never seen - p) + c4 u4 (nearest believed item - p), u uniform(0, 1) per term; then v is scaled to
L |v| / (|v| + 0.01), L the nodes per decision. Distances are Euclidean, across land; of equal
places the first in row-major order counts; a missing one pulls nothing. Own best place: where the
agent stood when it had most items in its own view, the latest of equal ones. It takes the move
nearest to v whose end node is free and not taken by agents before it; without one, south.
"""

import math

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.base.randomness import Stream, stream_key, uniform
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.navigation import OFFSETS
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.graph_planner.policies.pso import NOWHERE, Swarm
from mjforage.graph_planner.policies.registry import register
from mjforage.graph_planner.policy_parts.final_moves import FARTHEST, is_taken, make_final
from mjforage.graph_planner.policy_parts.kernel_policy import KernelPolicy, Preferences
from mjforage.graph_planner.policy_parts.seeking import possible_targets
from mjforage.mission.task import NEVER, Observation, Task, TaskArrays

EXPLORING, EXPLOITING, COLLECTING = 0, 1, 2
WEIGHTS = np.array(
    [(0.5, 0.0, 3.2697, 0.0), (3.6845, 1.5614, 0.0, 3.6703), (0.0, 2.0, 0.0, 3.0)], np.float64
)
"""(case, term) c1 to c4: scouts at first, and all while nothing is believed; scouts; foragers."""
LAST_EXPLORING = 76
"""Move of the scouts up to which they explore."""
DAMPING = 0.01
SOUTH = 4


@kernel
def _items_of(
    rows: Int32Array, cols: Int32Array, belief: NDArray[np.int16], known: Int32Array, place: int
) -> tuple[int, int]:
    """The richest node of those with items and the nearest one; -1 if there is none."""
    richest, most, nearest, least = -1, 0, -1, FARTHEST
    for node in known:
        down, right = np.int64(rows[node] - rows[place]), np.int64(cols[node] - cols[place])
        squared, items = down * down + right * right, np.int64(belief[node])
        if items > most or (items == most and node < richest):
            richest, most = node, int(items)
        if squared < least or (squared == least and node < nearest):
            nearest, least = node, int(squared)
    return richest, nearest


@kernel
def _nearest_new(cells: Int32Array, last_seen: NDArray[np.int16], row: int, col: int) -> int:
    """The node never seen that is nearest to a cell, the lowest of equals; -1 if there is none.

    `cells`: (row, column) node of each cell, -1 on land; `last_seen`: (node,).
    """
    best, least, height, width = NOWHERE, FARTHEST, cells.shape[0], cells.shape[1]
    for down in range(height):
        for right in range(width):
            squared = down * down + right * right
            if squared > least:
                break
            for r in (row - down, row + down):
                for c in (col - right, col + right):
                    if 0 <= r < height and 0 <= c < width and cells[r, c] >= 0:
                        node = cells[r, c]
                        if last_seen[node] == NEVER and (squared < least or node < best):
                            best, least = node, squared
    return best


@kernel
def _nearest_move(
    velocity: NDArray[np.float64], length: int, targets: Int32Array, ends: Int32Array, chosen: int
) -> int:
    """The free move nearest to a velocity (2,), of equals the first from south by east on."""
    best, least = SOUTH, np.inf
    for turn in range(8):
        move = (SOUTH - turn) % 8
        if targets[move] < 0 or is_taken(ends, chosen, targets[move]):
            continue
        down = velocity[0] - length * OFFSETS[move, 0]
        right = velocity[1] - length * OFFSETS[move, 1]
        if down * down + right * right < least:
            best, least = move, down * down + right * right
    return best


@kernel
def _fly(
    arrays: TaskArrays,
    cells: Int32Array,
    order: NDArray[np.int64],
    views: NodeLists,
    swarm: Swarm,
    preferences: NDArray[np.float64],
    seen: Observation,
) -> None:
    """Bring all velocities up to date, and choose one agent after the other; fill preferences."""
    active, step, keys, agent_node = seen.active, seen.step, seen.keys, seen.agent_node
    belief, last_seen, known, n_known = seen.belief, seen.last_seen, seen.known, seen.n_known
    rows, cols, moves, collects = arrays.rows, arrays.cols, arrays.moves, arrays.collects
    start, nodes, radius_number = views.start, views.nodes, arrays.radius_number
    n_agents = agent_node.shape[1]
    targets, ends = np.empty((n_agents, 9), np.int32), np.empty(n_agents, np.int32)
    places = np.empty(4, np.int32)
    for e in range(active.size):
        if not active[e]:
            continue
        key, items = stream_key(keys[e], Stream.POLICY), known[e, : n_known[e]]
        possible_targets(arrays, agent_node[e], targets)
        for chosen in range(n_agents):
            a = order[chosen]
            node, radius, in_view = agent_node[e, a], radius_number[a], 0
            for i in range(start[radius, node], start[radius, node + 1]):
                in_view += belief[e, np.uint64(nodes[np.uint64(i)])]
            if in_view >= swarm.best_items[e, a]:
                swarm.best_items[e, a], swarm.best_node[e, a] = in_view, node
            case = COLLECTING if collects[a] else EXPLOITING
            if items.size == 0 or (case == EXPLOITING and step[e] <= LAST_EXPLORING):
                case = EXPLORING
            places[0], places[1:] = swarm.best_node[e, a], -1
            if case == EXPLORING:
                places[2] = _nearest_new(cells, last_seen[e], rows[node], cols[node])
            else:
                places[1], places[3] = _items_of(rows, cols, belief[e], items, node)
            velocity = swarm.velocity[e, a]
            for term in range(4):
                if places[term] >= 0:
                    pull = WEIGHTS[case, term] * uniform(key, 4 * a + term, step[e])
                    velocity[0] += pull * (rows[places[term]] - rows[node])
                    velocity[1] += pull * (cols[places[term]] - cols[node])
            velocity *= moves[a] / (math.sqrt(velocity[0] ** 2 + velocity[1] ** 2) + DAMPING)
            move = _nearest_move(velocity, moves[a], targets[a], ends, chosen)
            ends[chosen] = targets[a, move] if targets[a, move] >= 0 else node
            make_final(preferences[e, a], move)


@register("pso-2025")
class Pso2025Policy(KernelPolicy):
    """Particle swarm of the paper of 2025: pulls of own best, richest, unseen and nearest nodes."""

    def filled(self, task: Task, preferences: Preferences) -> BoundKernel[None]:
        """The move nearest to each velocity."""
        self.swarm = Swarm.at_rest(preferences.shape[:2])
        about = task.graph.node_of_cell, task.fleet.order, task.views, self.swarm
        return BoundKernel(_fly, task.arrays, *about, preferences)
