"""Particle swarm of the group's paper of 2025 (IEEE RA-L 10(5):4930, preprint arXiv 2412.02316).

v += c1 u1 (own best place - p) + c2 u2 (node with most believed items - p) + c3 u3 (nearest node
never seen - p) + c4 u4 (nearest believed item - p), u uniform(0, 1) per term; then v is scaled to
L |v| / (|v| + 0.01), L the nodes per decision. Distances are Euclidean, across land; of equal
places the first in row-major order counts; a missing one pulls nothing. Own best place: where the
agent stood when it had most items in its own view, the latest of equal ones. It takes the move
nearest to v whose end node is free and not taken by agents before it; without one, south.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.base.randomness import Stream, UInt64Array, stream_key, uniform
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.navigation import OFFSETS
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.graph_planner.policies.registry import register
from mjforage.graph_planner.policy_parts.final_moves import (
    FARTHEST,
    is_taken,
    make_final,
    squared_distance,
)
from mjforage.graph_planner.policy_parts.seeking import possible_targets
from mjforage.mission.plain import Plain
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


class Swarm(NamedTuple):
    """Memory of the particles."""

    velocity: NDArray[np.float64]  # (episode, agent, 2) (row, column) [node]
    best_node: Int32Array  # (episode, agent) own best place, -1 none
    best_items: Int32Array  # (episode, agent) items in view there then


@kernel
def _nearest(arrays: TaskArrays, nodes: Int32Array, count: int, place: int) -> int:
    """The one of the first `count` nodes nearest to a place, the lowest of equals; -1 if none."""
    best, least = -1, FARTHEST
    for i in range(count):
        squared = squared_distance(arrays.rows, arrays.cols, nodes[i], place)
        if squared < least or (squared == least and nodes[i] < best):
            best, least = nodes[i], squared
    return best


@kernel
def _richest(seen: Observation, e: int) -> int:
    """The node with most believed items, the lowest of equals; -1 if none is believed."""
    best, most = -1, 0
    for node in seen.known[e, : seen.n_known[e]]:
        items = seen.belief[e, node]
        if items > most or (items == most and node < best):
            best, most = node, items
    return best


@kernel
def _remember(
    swarm: Swarm, arrays: TaskArrays, views: NodeLists, seen: Observation, e: int, a: int
) -> None:
    """Take an agent's place as its own best if it has as many items in view as ever."""
    node, radius, items = seen.agent_node[e, a], arrays.radius_number[a], 0
    for i in range(views.start[radius, node], views.start[radius, node + 1]):
        items += seen.belief[e, views.nodes[i]]
    if items >= swarm.best_items[e, a]:
        swarm.best_items[e, a], swarm.best_node[e, a] = items, node


@kernel
def _pulled(
    velocity: NDArray[np.float64],
    arrays: TaskArrays,
    pulls: NDArray[np.float64],
    places: Int32Array,
    node: int,
    length: int,
) -> None:
    """Change an agent's velocity (2,) by the pulls (term,) of places (term,), -1 none."""
    for term in range(4):
        if places[term] >= 0:
            velocity[0] += pulls[term] * (arrays.rows[places[term]] - arrays.rows[node])
            velocity[1] += pulls[term] * (arrays.cols[places[term]] - arrays.cols[node])
    velocity *= length / (math.sqrt(velocity[0] ** 2 + velocity[1] ** 2) + DAMPING)


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
    order: NDArray[np.int64],
    views: NodeLists,
    swarm: Swarm,
    preferences: NDArray[np.float64],
    seen: Observation,
) -> None:
    """Bring all velocities up to date, and choose one agent after the other; fill preferences."""
    n_agents, n_nodes = seen.agent_node.shape[1], seen.belief.shape[1]
    targets, ends = np.empty((n_agents, 9), np.int32), np.empty(n_agents, np.int32)
    unseen, places, pulls = np.empty(n_nodes, np.int32), np.empty(4, np.int32), np.empty(4)
    for e in range(seen.active.size):
        if not seen.active[e]:
            continue
        key, n_unseen = stream_key(seen.keys[e], Stream.POLICY), 0
        possible_targets(arrays, seen.agent_node[e], targets)
        for node in range(n_nodes):
            unseen[n_unseen] = node
            n_unseen += seen.last_seen[e, node] == NEVER
        places[1] = _richest(seen, e)
        for chosen, a in enumerate(order):
            _remember(swarm, arrays, views, seen, e, a)
            node, case = seen.agent_node[e, a], COLLECTING if arrays.collects[a] else EXPLOITING
            if seen.n_known[e] == 0 or (case == EXPLOITING and seen.step[e] <= LAST_EXPLORING):
                case = EXPLORING
            for term in range(4):
                pulls[term] = WEIGHTS[case, term] * uniform(key, 4 * a + term, seen.step[e])
            places[0] = swarm.best_node[e, a]
            places[2] = _nearest(arrays, unseen, n_unseen if case == EXPLORING else 0, node)
            places[3] = _nearest(arrays, seen.known[e], seen.n_known[e], node)
            _pulled(swarm.velocity[e, a], arrays, pulls, places, node, arrays.moves[a])
            about = swarm.velocity[e, a], arrays.moves[a], targets[a], ends, chosen
            move = _nearest_move(*about)
            ends[chosen] = targets[a, move] if targets[a, move] >= 0 else node
            make_final(preferences[e, a], move)


@register("pso-2025")
class Pso2025Policy:
    """Particle swarm of the paper of 2025: pulls of own best, richest, unseen and nearest nodes."""

    def reset(self, task: Task, keys: UInt64Array) -> None:
        """Get ready for a batch of episodes (episode,)."""
        self._plain, agents = Plain(task, keys.size), (keys.size, len(task.fleet))
        self.swarm = Swarm(
            velocity=np.zeros((*agents, 2)),
            best_node=np.full(agents, -1, np.int32),
            best_items=np.zeros(agents, np.int32),
        )
        self._preferences = np.zeros((*agents, 9))
        about = task.fleet.order, task.views, self.swarm, self._preferences
        self._fly = BoundKernel(_fly, task.arrays, *about)

    def act(self, observation: Observation) -> NDArray[np.float64]:
        """Preferences (episode, agent, 9): the move nearest to each velocity."""
        self._fly(self._plain(observation))
        return self._preferences
