"""Particle swarm: every agent has a velocity, pulled to two places, and takes the nearest compass
move.

Velocity = inertia x velocity + sum of weight x uniform x (place - position):
scouts are pulled with 0.5 to the best node they have seen themselves and with 3.27 to the most idle
node, foragers with 2 to the node with most known items and with 3 to the nearest known item. Among
equal places the one nearest to the agent as the crow flies is taken. Inertia: Clerc and Kennedy,
"The particle swarm", IEEE Trans. Evolutionary Computation 6, 2002.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.base.randomness import Stream, stream_key, uniform
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.navigation import OFFSETS, STAY
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.graph_planner.policies.registry import register
from mjforage.graph_planner.policy_parts.kernel_policy import KernelPolicy, Preferences
from mjforage.mission.task import Observation, Task, TaskArrays

INERTIA = 0.7298
OWN_BEST_WEIGHT, IDLEST_WEIGHT = 0.5, 3.27
RICHEST_WEIGHT, NEAREST_WEIGHT = 2.0, 3.0
NOWHERE = -1


class Swarm(NamedTuple):
    """Memory of the particles."""

    velocity: NDArray[np.float64]  # (episode, agent, 2) (row, column) [node]
    best_node: Int32Array  # (episode, agent) own best place, -1 none
    best_items: Int32Array  # (episode, agent) items there then

    @classmethod
    def at_rest(cls, agents: tuple[int, ...]) -> "Swarm":
        """Particles (episode, agent) that have seen nothing yet."""
        nowhere = np.full(agents, NOWHERE, np.int32)
        return cls(np.zeros((*agents, 2)), nowhere, np.zeros(agents, np.int32))


@kernel
def _best_place(
    values: NDArray[np.float64], nodes: Int32Array, arrays: TaskArrays, node: int
) -> int:
    """The one of `nodes` with the largest value, the nearest of them to `node`; -1 if empty."""
    rows, cols = arrays.rows, arrays.cols
    best, best_value, best_squared = NOWHERE, -np.inf, 0
    for i in range(nodes.size):
        if values[i] < best_value:
            continue
        d_row = rows[nodes[i]] - rows[node]
        d_col = cols[nodes[i]] - cols[node]
        squared = d_row * d_row + d_col * d_col
        if values[i] > best_value or squared < best_squared:
            best, best_value, best_squared = nodes[i], values[i], squared
    return best


@kernel
def _pull(
    velocity: NDArray[np.float64], weight: float, place: int, node: int, arrays: TaskArrays
) -> None:
    """Add the pull of a place, if there is one, to a velocity (2,)."""
    if place >= 0:
        velocity[0] += weight * (arrays.rows[place] - arrays.rows[node])
        velocity[1] += weight * (arrays.cols[place] - arrays.cols[node])


@kernel
def _pull_forager(
    seen: Observation,
    arrays: TaskArrays,
    e: int,
    node: int,
    first: float,
    second: float,
    values: NDArray[np.float64],
    velocity: NDArray[np.float64],
) -> None:
    """Pull to the node with most known items and to the nearest known item."""
    items, belief = seen.known[e, : seen.n_known[e]], seen.belief[e]
    for i in range(items.size):
        values[i] = belief[items[i]]
    _pull(velocity, RICHEST_WEIGHT * first, _best_place(values, items, arrays, node), node, arrays)
    values[: items.size] = 0.0
    nearest = _best_place(values, items, arrays, node)
    _pull(velocity, NEAREST_WEIGHT * second, nearest, node, arrays)


@kernel
def _pull_scout(
    seen: Observation,
    arrays: TaskArrays,
    e: int,
    node: int,
    best_node: int,
    first: float,
    second: float,
    values: NDArray[np.float64],
    velocity: NDArray[np.float64],
) -> None:
    """Pull to the best node that the agent has seen itself and to the most idle one."""
    full_after = np.ceil(1.0 / arrays.forgetting)
    now, last_seen = seen.step[e] - 1.0, seen.last_seen[e]
    for i in range(values.size):
        values[i] = min(full_after, now - last_seen[i])
    everywhere = np.arange(values.size).astype(np.int32)
    idlest = _best_place(values, everywhere, arrays, node)
    _pull(velocity, OWN_BEST_WEIGHT * first, best_node, node, arrays)
    _pull(velocity, IDLEST_WEIGHT * second, idlest, node, arrays)


@kernel
def _fly(
    arrays: TaskArrays,
    views: NodeLists,
    swarm: Swarm,
    preferences: NDArray[np.float64],
    seen: Observation,
) -> None:
    """Bring all velocities up to date; fill preferences by how well moves follow them."""
    active, step, keys = seen.active, seen.step, seen.keys
    agent_node, belief = seen.agent_node, seen.belief
    start, nodes, radius_number = views.start, views.nodes, arrays.radius_number
    best_items, best_nodes = swarm.best_items, swarm.best_node
    values = np.empty(arrays.rows.size)
    for e in range(active.size):
        if not active[e]:
            continue
        key = stream_key(keys[e], Stream.POLICY)
        for a in range(agent_node.shape[1]):
            node, radius, velocity = agent_node[e, a], radius_number[a], swarm.velocity[e, a]
            first, second = uniform(key, 4 * a, step[e]), uniform(key, 4 * a + 1, step[e])
            for i in range(start[radius, node], start[radius, node + 1]):
                items = belief[e, nodes[i]]
                if items > best_items[e, a]:
                    best_items[e, a], best_nodes[e, a] = items, nodes[i]
            velocity *= INERTIA
            if arrays.collects[a]:
                _pull_forager(seen, arrays, e, node, first, second, values, velocity)
            else:
                best = best_nodes[e, a]
                _pull_scout(seen, arrays, e, node, best, first, second, values, velocity)
            speed = np.sqrt(velocity[0] ** 2 + velocity[1] ** 2)
            for d in range(8):
                norm = np.sqrt(OFFSETS[d, 0] ** 2 + OFFSETS[d, 1] ** 2)
                along = velocity[0] * OFFSETS[d, 0] + velocity[1] * OFFSETS[d, 1]
                tie = 1e-6 * uniform(key, 1_000_000 + 9 * a + d, step[e])
                preferences[e, a, d] = tie + (along / (norm * speed) if speed > 1e-9 else 0.0)
            preferences[e, a, STAY] = -2.0


@register("pso")
class PsoPolicy(KernelPolicy):
    """Particle swarm: velocities pulled to idle nodes (scouts) and known items (foragers)."""

    def filled(self, task: Task, preferences: Preferences) -> BoundKernel[None]:
        """Cosine between the velocity and each move."""
        swarm = Swarm.at_rest(preferences.shape[:2])
        return BoundKernel(_fly, task.arrays, task.views, swarm, preferences)
