"""Moves that are legal, and where they end.

A move is a compass direction or staying put. An agent of m moves per decision goes m nodes
straight; where a node on the way is not free, the move is illegal (`shorten` off: the published
rule) or ends before it (`shorten` on), or only its end node has to be free (`jump`).
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse import csgraph

from mjforage.base.compiled import inlined, kernel
from mjforage.graph_planner.graph.geodesics import DIAGONAL, Int32Array
from mjforage.graph_planner.graph.navigation import OFFSETS, STAY, NavigationGraph

CHOSEN, OTHERWISE_STAY = 2.0, 1.0  # preferences of a chosen move, and of what happens if illegal
FINAL = 1e300
"""Least preference of a move that is made under `jump` whatever the others have chosen: an agent
may share its end node; where that is no node it stays, but its length counts as way."""


@dataclass(frozen=True)
class MoveRules:
    """Moves that a fleet may make in one decision.

    Attributes
    ----------
    stay : True if staying put is an action
    shorten : True if a move of several nodes ends before an obstacle instead of being illegal
    jump : True if only the end node of a move has to be free
    """

    stay: bool
    shorten: bool
    jump: bool = False


@kernel
def preferences_of(moves: NDArray[np.int64]) -> NDArray[np.float64]:
    """(episode, agent, 9) preferences for moves 0-8 (episode, agent), else for staying put."""
    preferences = np.zeros((*moves.shape, 9))
    for e in range(moves.shape[0]):
        for a in range(moves.shape[1]):
            preferences[e, a, STAY] = OTHERWISE_STAY
            preferences[e, a, moves[e, a]] = CHOSEN
    return preferences


class Moves(NamedTuple):
    """Resolved decisions of one step."""

    direction: NDArray[np.int8]  # (episode, agent) 0-7 compass, 8 stay
    target: Int32Array  # (episode, agent) node
    steps: NDArray[np.int8]  # (episode, agent) nodes travelled
    blocked: NDArray[np.bool_]  # (episode, agent) no legal move was left

    @classmethod
    def of(cls, shape: tuple[int, ...]) -> "Moves":
        """Moves to be filled, of (episode, agent)."""
        kinds = np.int8, np.int32, np.int8, np.bool_
        return cls(*(np.zeros(shape, kind) for kind in kinds))


@kernel
def move_length(direction: int, steps: int) -> float:
    """Distance of a move of `steps` nodes [node]."""
    return steps * (DIAGONAL if direction & 1 else 1.0)


@inlined
def free_move(
    neighbours: Int32Array,
    claimed: NDArray[np.int64],
    token: int,
    node: int,
    direction: int,
    moves: int,
    stay: bool,
    shorten: bool,
) -> tuple[int, int]:
    """End node of a move and the number of nodes that it covers; (-1, 0) if it is illegal.

    Parameters
    ----------
    neighbours : (node, 8) int32
    claimed : (node,) a node with `token` was chosen by an agent that decided earlier; the token
        -1 stands for none
    direction : 0-7 compass, 8 stay
    moves : nodes per decision of this agent
    stay, shorten : see `MoveRules`
    """
    target, steps = node, 0
    if direction == STAY:
        if not stay or (token >= 0 and claimed[node] == token):
            target = -1
    else:
        for _ in range(moves):
            following = neighbours[target, direction]
            if following < 0 or (token >= 0 and claimed[following] == token):
                break
            target, steps = following, steps + 1
        if steps == 0 or (steps < moves and not shorten):
            target, steps = -1, 0
    return target, steps


@kernel
def _targets(
    neighbours: Int32Array, strides: NDArray[np.int64], stay: bool, shorten: bool
) -> Int32Array:
    targets = np.empty((strides.size, neighbours.shape[0], 9), np.int32)
    nobody = np.empty(0, np.int64)
    for i in range(strides.size):
        for node in range(neighbours.shape[0]):
            for move in range(9):
                end, _ = free_move(neighbours, nobody, -1, node, move, strides[i], stay, shorten)
                targets[i, node, move] = end
    return targets


def all_targets(
    graph: NavigationGraph, moves: NDArray[np.int64], rules: MoveRules
) -> tuple[NDArray[np.int64], Int32Array]:
    """End node of each move with no other agent in the way.

    Parameters
    ----------
    moves : (agent,) nodes per decision

    Returns
    -------
    stride_number : (agent,) which table is the agent's
    targets : (stride, node, 9) node, -1 where the move is illegal
    """
    strides, stride_number = np.unique(moves, return_inverse=True)
    targets = _targets(graph.neighbours, strides, rules.stay, rules.shorten)
    if rules.jump:
        for i, stride in enumerate(strides):
            cells = np.pad(graph.node_of_cell, stride, constant_values=-1)
            for move, (down, right) in enumerate(OFFSETS[:STAY]):
                row, col = graph.rows + stride * (1 + down), graph.cols + stride * (1 + right)
                targets[i, :, move] = cells[row, col]
    return stride_number.astype(np.int64), targets


def reachable_share(graph: NavigationGraph, start: int, moves: int, rules: MoveRules) -> float:
    """Share of the nodes on which moves from a node can end, itself included.

    Two-node moves alone keep the parity of row and column, so in open water they reach a quarter.

    `moves`: nodes per decision.
    """
    targets = all_targets(graph, np.array([moves]), rules)[1][0]
    node, move = np.nonzero(targets >= 0)
    ends = np.ones(node.size), (node, targets[node, move])
    ways = sparse.csr_array(ends, shape=(len(graph), len(graph)))
    reached = csgraph.breadth_first_order(ways, start, return_predecessors=False)
    return len(reached) / len(graph)
