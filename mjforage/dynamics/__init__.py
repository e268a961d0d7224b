"""The one room in which worlds differ: how vessels move and items drift during one decision."""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from graph_planner.geodesics import Int32Array
from graph_planner.moves import Moves
from graph_planner.randomness import UInt64Array
from mjforage.world import World

ARRIVED, LATE, BLOCKED = 0, 1, 2
OUTCOMES = ("arrived", "late", "blocked")


class Transition(NamedTuple):
    """State at the end of one decision period. Live views: copy what must outlive the next step."""

    agent_node: Int32Array  # (episode, agent)
    agent_rc: NDArray[np.float64]  # (episode, agent, 2) position (row, column) [node]
    agent_yaw: NDArray[np.float64]  # (episode, agent) [rad], 0 = east, counter-clockwise
    agent_speed: NDArray[np.float64]  # (episode, agent) mean over the period [node/step]
    outcome: NDArray[np.int8]  # (episode, agent) ARRIVED, LATE or BLOCKED
    item_rc: NDArray[np.float64]  # (episode, item, 2) [node]; last position once removed
    item_node: Int32Array  # (episode, item) node, -1 once removed or for padding
    collected_by: NDArray[np.int16]  # (episode, item) agent that has removed it, -1 nobody
    distance: NDArray[np.float64]  # (episode, agent) travelled so far [node]
    energy: NDArray[np.float64]  # (episode, agent) used so far, in the unit of `Role.energy`
    collisions: Int32Array  # (episode, agent) so far


class Dynamics(Protocol):
    """How a world moves. Batched over episodes; one episode is a batch of one."""

    def reset(self, world: World, keys: UInt64Array) -> Transition:
        """Start a batch of episodes and return their state at step 0."""
        ...

    def advance(self, active: NDArray[np.bool_], step: Int32Array, moves: Moves) -> Transition:
        """Carry out one decision: move, collect, drift. Inactive episodes do not change."""
        ...
