"""Protocol of dynamics: motion of vessels and drift of items during one decision, in any world."""

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.device import Launch
from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.mission.initial_state import InitialState
from mjforage.mission.moves import Moves
from mjforage.mission.task import Pickup

ARRIVED, LATE, BLOCKED = 0, 1, 2
OUTCOMES = ("arrived", "late", "blocked")
NOBODY = "item_node", "collected_by"  # of a transition: -1 where there is no item


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
    collisions: Int32Array  # (episode, agent) touches of quays and hulls so far
    impact: NDArray[np.float64]  # (episode, agent) fastest approach to a touch in the period [m/s]
    work: NDArray[np.float64]  # (episode, agent) electrical energy drawn so far [J]; 0 in graphs
    pickup: NDArray[np.int8]  # (episode, agent) how picking up ended in the period, see `PICKUPS`
    disabled: NDArray[np.bool_]  # (episode, agent) can no longer carry out moves, as it knows


def start_state(initial: InitialState, centres: NDArray[np.float64]) -> Transition:
    """State at step 0: every agent at rest on the centre of a node.

    Parameters
    ----------
    centres : (node, 2) row and column of each node
    """
    episodes, count = initial.item_node.shape
    agents = (episodes, initial.agent_node.shape[1])
    return Transition(
        agent_node=initial.agent_node.copy(),
        agent_rc=centres[initial.agent_node],
        agent_yaw=np.zeros(agents),
        agent_speed=np.zeros(agents),
        outcome=np.full(agents, ARRIVED, np.int8),
        item_rc=initial.item_rc.copy(),
        item_node=initial.item_node.copy(),
        collected_by=np.full((episodes, count), -1, np.int16),
        distance=np.zeros(agents),
        energy=np.zeros(agents),
        collisions=np.zeros(agents, np.int32),
        impact=np.zeros(agents),
        work=np.zeros(agents),
        pickup=np.zeros(agents, np.int8),
        disabled=np.zeros(agents, np.bool_),
    )


@kernel
def goes_on(
    horizon: int,
    active: NDArray[np.bool_],
    step: Int32Array,
    item_node: Int32Array,
    going: NDArray[np.bool_],
) -> None:
    """Write (episode,) whether it has steps to go and an item left, if it went on so far."""
    for e in range(active.size):
        left = False
        if active[e] and step[e] < horizon:
            for k in range(item_node.shape[1]):
                if item_node[e, k] >= 0:
                    left = True
                    break
        going[e] = left


@kernel
def count_taken(collected_by: NDArray[np.int16], taken: NDArray[np.int64]) -> None:
    """Write (episode, agent) items that each has collected."""
    for e in range(collected_by.shape[0]):
        taken[e] = 0
        for k in range(collected_by.shape[1]):
            if collected_by[e, k] >= 0:
                taken[e, collected_by[e, k]] += 1


GOES_ON, COUNT_TAKEN = Launch(goes_on), Launch(count_taken)


def taken_by(collected_by: NDArray[np.int16], agents: int) -> NDArray[np.int64]:
    """(episode, agent) items that each has collected."""
    taken = np.empty((collected_by.shape[0], agents), np.int64)
    count_taken(collected_by, taken)
    return taken


def mean_drift(drift: NDArray[np.float64], left: NDArray[np.bool_]) -> NDArray[np.float64]:
    """(episode, 2) mean drift of the items (episode, item) that are left; where all drift alike,
    that drift to the bit, and whether any is left or not.
    """
    if not drift.shape[1]:
        return np.zeros((len(drift), 2))
    first, count = drift[:, :1], np.maximum(left.sum(axis=1, keepdims=True), 1)
    off = np.where(left[..., None], drift - first, 0.0).sum(axis=1) / count
    mean: NDArray[np.float64] = first[:, 0] + off
    return mean


class Dynamics(Protocol):
    """Motion of a world. Batched over episodes; one episode is a batch of one.

    All items are there at step 0, or never: places that are empty then are padding.

    Attributes
    ----------
    pickup : mean delays of collecting for vessels; None if a forager collects all in its node
        before the rest drifts
    """

    pickup: Pickup | None

    def reset(self, initial: InitialState, keys: UInt64Array, names: Sequence[str]) -> Transition:
        """Start a batch of episodes and return their state at step 0.

        Parameters
        ----------
        keys, names : (episode,) keys of the random draws, and names in messages of errors
        """
        ...

    def restart(
        self,
        rows: NDArray[np.int64],
        initial: InitialState,
        keys: UInt64Array,
        names: Sequence[str],
    ) -> Transition:
        """Start other episodes in some rows of the batch; the rest goes on to the bit.

        Parameters
        ----------
        rows : (row,) places in the batch
        initial, keys, names : as of `reset`, of these episodes; padded at least as the batch is

        Returns
        -------
        State of the whole batch, in new arrays
        """
        ...

    def drift_rc(self, rc: NDArray[np.float64], items: bool = False) -> NDArray[np.float64]:
        """Velocity at which wind and water carry items now, gusts and noise left out.

        Parameters
        ----------
        rc : (episode, place, 2) places [node]
        items : True if place k is that of item k, which has its own leeway

        Returns
        -------
        (episode, place, 2) [node/step]
        """
        ...

    def advance(self, active: NDArray[np.bool_], step: Int32Array, moves: Moves) -> Transition:
        """Carry out one decision: move, collect, drift. Inactive episodes do not change."""
        ...
