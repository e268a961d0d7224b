"""Masks of legal moves, before anybody else has decided."""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, inlined, kernel
from mjforage.base.device import Bind, Call, Launch
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.navigation import STAY
from mjforage.mission.moves import free_move, move_length
from mjforage.mission.task import Task, TaskArrays

NOBODY = -1


@kernel
def legal_of_agent(
    arrays: TaskArrays, claimed: NDArray[np.int64], token: int, agent: int, node: int, energy: float
) -> NDArray[np.bool_]:
    """(9,) legal moves of one agent; only staying where none is, which counts as blocked.

    Parameters
    ----------
    claimed, token : nodes chosen by others, see `free_move`; the token -1 for none
    energy : distance that it can still travel [node]
    """
    number, hops, span = arrays.stride_number[agent], arrays.moves[agent], 1
    neighbours = arrays.targets[number] if arrays.jump else arrays.neighbours
    if arrays.jump:
        hops, span = 1, hops
    legal = np.zeros(9, np.bool_)
    for move in range(9):
        end, steps = free_move(
            neighbours, claimed, token, node, move, hops, arrays.stay, arrays.shorten
        )
        legal[move] = end >= 0 and move_length(move, steps * span) <= energy
    if not legal.any():
        legal[STAY] = True
    return legal


@inlined
def legal_end(
    targets: Int32Array,
    number: int,
    rows: Int32Array,
    cols: Int32Array,
    node: int,
    move: int,
    energy: float,
) -> int:
    """End of a move that is legal whatever the others choose; -1 if it is not.

    Parameters
    ----------
    targets, number, rows, cols : see `TaskArrays`, the number being this agent's
    energy : distance that it can still travel [node]
    """
    end = targets[number, node, move]
    steps = max(abs(rows[end] - rows[node]), abs(cols[end] - cols[node]))
    return end if end >= 0 and move_length(move, steps) <= energy else -1


@kernel
def _legal(
    arrays: TaskArrays,
    agent_node: Int32Array,
    energy_left: NDArray[np.float64],
    out: NDArray[np.bool_],
) -> None:
    """Legal moves of all agents of a batch."""
    targets, number, rows, cols = arrays.targets, arrays.stride_number, arrays.rows, arrays.cols
    for e in range(agent_node.shape[0]):
        for a in range(agent_node.shape[1]):
            node, energy, found = agent_node[e, a], energy_left[e, a], False
            for move in range(9):
                legal = legal_end(targets, number[a], rows, cols, node, move, energy) >= 0
                out[e, a, move] = legal
                found |= legal
            out[e, a, STAY] |= not found


LEGAL = Launch(_legal, shared="arrays")


class LegalMoves:
    """Moves that are legal whatever the others choose, of one task.

    Asked often, always with arrays of one layout.
    """

    def __init__(self, task: Task) -> None:
        self._legal = BoundKernel(_legal, task.arrays)

    def on_device(
        self,
        bind: Bind,
        agent_node: Int32Array,
        energy_left: NDArray[np.float64],
        out: NDArray[np.bool_],
    ) -> Call:
        """The same by a kernel on a device, which writes to `out` (episode, agent, 9)."""
        return bind(LEGAL, *self._legal.fixed, agent_node, energy_left, out)

    def __call__(
        self, agent_node: Int32Array, energy_left: NDArray[np.float64]
    ) -> NDArray[np.bool_]:
        """(episode, agent, 9) legal moves.

        An agent without any has staying put marked: that is what the resolver makes it do.

        Parameters
        ----------
        agent_node : (episode, agent)
        energy_left : (episode, agent) distance that can still be travelled [node]
        """
        out = np.empty((*agent_node.shape, 9), np.bool_)
        self._legal(agent_node, energy_left, out)
        return out
