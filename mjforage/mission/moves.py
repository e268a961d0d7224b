"""Legal moves, and the one resolver that turns preferences into moves.

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

from mjforage.base.compiled import BoundKernel, inlined, kernel
from mjforage.base.errors import UserError
from mjforage.base.randomness import Stream, UInt64Array, stream_key, uniform
from mjforage.graph_planner.graph.geodesics import DIAGONAL, Int32Array
from mjforage.graph_planner.graph.navigation import OFFSETS, STAY, NavigationGraph
from mjforage.scenario.roles import Fleet

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


class Corruption(NamedTuple):
    """Random replacement of actions (the paper's corruption experiment).

    Attributes
    ----------
    epsilon : (agent,) probability that an agent's action is replaced by a uniform legal one
    whole_team : one draw decides for all corrupted agents, and the random action of one that
        collects still takes an item that it knows of beside it (the published code's experiment)
    """

    epsilon: NDArray[np.float64]
    whole_team: bool = False


class Movers(NamedTuple):
    """Moves of the agents in a decision, and the order in which they choose."""

    reach: Int32Array  # (table, node, 8 or more) node next on the way in a direction, -1: none
    table: NDArray[np.int64]  # (agent,) which of them is the agent's
    hops: NDArray[np.int64]  # (agent,) entries of it that a move goes along
    span: NDArray[np.int64]  # (agent,) nodes from one to the next
    illegal: NDArray[np.int64]  # (agent, node) a bit per move: illegal even alone
    collects: NDArray[np.bool_]  # (agent,)
    order: NDArray[np.int64]  # (agent,) agents as they choose
    stay: bool
    shorten: bool
    jump: bool


class Ask(NamedTuple):
    """Inputs of a batch of decisions, see `Resolver`."""

    active: NDArray[np.bool_]  # (episode,)
    preferences: NDArray[np.float64]  # (episode, agent, 9)
    agent_node: Int32Array  # (episode, agent)
    energy_left: NDArray[np.float64]  # (episode, agent) [node]
    belief: NDArray[np.int16]  # (episode x owner, node)
    owner_of: NDArray[np.int64]  # (agent,)
    decision: Int32Array  # (episode,) 1 for the first
    keys: UInt64Array  # (episode,)


_ASK_TYPES = ("?", "f8", "i4", "f8", "i2", "i8", "i4", "u8")  # of its fields


class Moves(NamedTuple):
    """Resolved decisions of one step."""

    direction: NDArray[np.int8]  # (episode, agent) 0-7 compass, 8 stay
    target: Int32Array  # (episode, agent) node
    steps: NDArray[np.int8]  # (episode, agent) nodes travelled
    blocked: NDArray[np.bool_]  # (episode, agent) no legal move was left


_ALL_MOVES = (1 << 9) - 1


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


@kernel
def _has_nan(values: NDArray[np.float64]) -> bool:
    """True if any of the preferences (row, agent, move) is NaN."""
    found = 0
    for value in values.flat:
        found += value != value
    return found > 0


@kernel
def _resolve(
    movers: Movers,
    corruption: Corruption,
    claimed: NDArray[np.int64],
    ask: Ask,
    first_token: int,
    moves: Moves,
) -> bool:
    """Let the agents of every episode choose one after the other; fill `moves`.

    `claimed`, `first_token`: (node,) see `free_move`; episode e marks what it takes by the e-th
    token. Returns: whether the preferences have no NaN; otherwise nothing is resolved.
    """
    if _has_nan(ask.preferences):
        return False
    active, preferences, agent_node = ask.active, ask.preferences, ask.agent_node
    energy_left, belief, owner_of = ask.energy_left, ask.belief, ask.owner_of
    decision, keys, illegal = ask.decision, ask.keys, movers.illegal
    reach, table, hops, span = movers.reach, movers.table, movers.hops, movers.span
    collects, order = movers.collects, movers.order
    stay, shorten, jump = movers.stay, movers.shorten, movers.jump
    epsilon, whole_team = corruption.epsilon, corruption.whole_team
    direction, target, steps, blocked = moves
    n_episodes, n_agents = agent_node.shape
    owners = belief.shape[0] // max(1, n_episodes)
    legal = np.empty(9, np.int64)
    for e in range(n_episodes):
        if not active[e]:
            for agent in range(n_agents):
                direction[e, agent], target[e, agent] = STAY, agent_node[e, agent]
                steps[e, agent], blocked[e, agent] = 0, False
            continue
        token = first_token + e
        key = stream_key(keys[e], Stream.CORRUPTION)
        for agent in order:
            node, stride, energy = agent_node[e, agent], hops[agent], energy_left[e, agent]
            neighbours, wide = reach[table[agent]], span[agent]
            best, end, length = -1, node, 0
            final = -1
            if jump:
                for d in range(STAY - 1, -1, -1):  # the lowest of several
                    if preferences[e, agent, d] >= FINAL and move_length(d, wide) <= energy:
                        final = d
            draw = 1.0
            if epsilon[agent] > 0.0:
                draw = uniform(key, -1 if whole_team else agent, decision[e])
            if draw < epsilon[agent]:
                n_legal, n_known, row = 0, 0, e * owners + owner_of[agent]
                for d in range(9):
                    end, length = free_move(
                        neighbours, claimed, token, node, d, stride, stay, shorten
                    )
                    if end < 0 or move_length(d, length * wide) > energy:
                        continue
                    if whole_team and collects[agent] and d != STAY and belief[row, end] > 0:
                        legal[n_legal] = legal[n_known]
                        legal[n_known] = d
                        n_known += 1
                    else:
                        legal[n_legal] = d
                    n_legal += 1
                if n_legal > 0:
                    choice = uniform(key, n_agents + agent, decision[e])
                    best = legal[int(choice * (n_known if n_known > 0 else n_legal))]
                    end, length = free_move(
                        neighbours, claimed, token, node, best, stride, stay, shorten
                    )
            elif final >= 0:
                best, end, length = final, neighbours[node, final], 1
            else:
                refused = illegal[agent, node]  # a bit per move; more as others are refused
                while best < 0 and refused < _ALL_MOVES:
                    # the largest preference that is left, the first of equals, without a branch
                    wanted, largest = -1, -np.inf
                    for d in range(9):
                        value = preferences[e, agent, d]
                        left = (refused >> d) & 1 == 0
                        larger = left & ((value > largest) | (wanted < 0))
                        wanted = d if larger else wanted
                        largest = value if larger else largest
                    end, length = free_move(
                        neighbours, claimed, token, node, wanted, stride, stay, shorten
                    )
                    if end >= 0 and move_length(wanted, length * wide) <= energy:
                        best = wanted
                    refused |= 1 << wanted
            if best < 0:
                end, length = -1, 0
            direction[e, agent] = best if best >= 0 else STAY
            blocked[e, agent] = end < 0
            end = end if end >= 0 else node
            target[e, agent], steps[e, agent] = end, length * wide
            claimed[end] = token
    return True


def check_preferences(
    answer: NDArray[np.float64], rows_agents: tuple[int, ...], who: str, how: str = "act gave"
) -> NDArray[np.float64]:
    """The answer of a policy, if it is an array (row, agent, 9) of numbers.

    Raises `UserError` if it is not.

    Parameters
    ----------
    rows_agents : required number of rows and agents
    who, how : source of the array, as an error begins: "policy North: act gave"
    """
    shape = (*rows_agents, 9)
    kind = getattr(getattr(answer, "dtype", None), "kind", "")
    if getattr(answer, "shape", None) != shape or kind not in tuple("fiub"):
        was = f"{answer.dtype} {answer.shape}" if kind else type(answer).__name__
        raise UserError(
            f"{who}: {how} {was}, expected numbers of shape {shape}, (row, agent, move)"
        )
    return answer


class Resolver:
    """Turns preferences into moves: agents choose one after the other, see `Fleet.order`."""

    def __init__(
        self, graph: NavigationGraph, fleet: Fleet, rules: MoveRules, corruption: Corruption
    ) -> None:
        number, targets = all_targets(graph, fleet.moves, rules)
        illegal = ((targets < 0) << np.arange(9)).sum(axis=2)[number]
        about = fleet.collects, fleet.order, rules.stay, rules.shorten, rules.jump
        one, reach, table = np.ones_like(number), graph.neighbours[None], np.zeros_like(number)
        hops, span = fleet.moves, one
        if rules.jump:
            reach, table, hops, span = targets, number, one, fleet.moves
        movers = Movers(np.ascontiguousarray(reach), table, hops, span, illegal, *about)
        claimed = np.zeros(len(graph), np.int64)  # node -> token of who took it last
        self._resolve = BoundKernel(_resolve, movers, corruption, claimed)
        self._one_owner, self._token = np.zeros(len(fleet), np.int64), 1

    def __call__(
        self,
        active: NDArray[np.bool_],
        preferences: NDArray[np.float64],
        agent_node: Int32Array,
        energy_left: NDArray[np.float64],
        belief: NDArray[np.int16],
        step: Int32Array,
        keys: UInt64Array,
        owner_of: NDArray[np.int64] | None = None,
        who: str = "policy",
    ) -> Moves:
        """Resolve one step of a batch.

        Raises `UserError` if the preferences have the wrong shape or contain NaN: the policy is at
        fault.

        Parameters
        ----------
        active : (episode,) others keep their place
        preferences : (episode, agent, 9); the largest legal one wins, ties to the lowest move.
            An illegal move, or one to or through a node chosen earlier, is never taken but as
            `FINAL` says.
        agent_node : (episode, agent)
        energy_left : (episode, agent) distance that can still be travelled [node]
        belief : (episode x owner, node) believed items; read by the whole-team corruption only
        step : (episode,) decision number, 1 for the first
        keys : (episode,) episode keys
        owner_of : (agent,) by whose belief each agent acts; absent: one owner for all
        who : name of the policy, for messages
        """
        check_preferences(preferences, agent_node.shape, who)
        moves = Moves(
            direction=np.empty(agent_node.shape, np.int8),
            target=np.empty(agent_node.shape, np.int32),
            steps=np.empty(agent_node.shape, np.int8),
            blocked=np.empty(agent_node.shape, np.bool_),
        )
        acts_by = self._one_owner if owner_of is None else owner_of
        given = (active, preferences, agent_node, energy_left, belief, acts_by, step, keys)
        ask = Ask(*map(np.ascontiguousarray, given, _ASK_TYPES))
        if not self._resolve(ask, self._token, moves):
            raise UserError(
                f"{who}: gives preferences that are NaN; give illegal or unwanted moves -inf"
            )
        self._token += active.size
        return moves
