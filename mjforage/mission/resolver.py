"""The one resolver that turns preferences into moves, agent by agent."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.base.device import Bind, Call, Launch
from mjforage.base.errors import UserError
from mjforage.base.randomness import Stream, UInt64Array, stream_key, uniform
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.navigation import STAY, NavigationGraph
from mjforage.mission.moves import FINAL, MoveRules, Moves, all_targets, free_move, move_length
from mjforage.scenario.roles import Fleet

_ALL_MOVES = (1 << 9) - 1


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


class Claims(NamedTuple):
    """Memory for one episode after the other."""

    claimed: NDArray[np.int64]  # (node,) 1 where an agent that chose earlier goes; 0 between
    legal: NDArray[np.int64]  # (9,)

    @classmethod
    def of(cls, nodes: int) -> "Claims":
        """Memory for a map of so many nodes."""
        return cls(np.zeros(nodes, np.int64), np.zeros(9, np.int64))


_ASK_TYPES = ("?", "f8", "i4", "f8", "i2", "i8", "i4", "u8")  # of its fields


@kernel
def _has_nan(values: NDArray[np.float64]) -> bool:
    """True if any of the preferences (row, agent, move) is NaN."""
    found = 0
    for row in range(values.shape[0]):
        for agent in range(values.shape[1]):
            for move in range(values.shape[2]):
                found += values[row, agent, move] != values[row, agent, move]
    return found > 0


@kernel
def _resolve(
    movers: Movers,
    corruption: Corruption,
    claims: Claims,
    ask: Ask,
    moves: Moves,
) -> bool:
    """Let the agents of every episode choose one after the other; fill `moves`.

    Returns: whether the preferences have no NaN; otherwise nothing is resolved.
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
    claimed, legal, token = claims.claimed, claims.legal, 1
    for e in range(n_episodes):
        if not active[e]:
            for agent in range(n_agents):
                direction[e, agent], target[e, agent] = STAY, agent_node[e, agent]
                steps[e, agent], blocked[e, agent] = 0, False
            continue
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
        for agent in range(n_agents):
            claimed[target[e, agent]] = 0
    return True


RESOLVE = Launch(_resolve, shared="movers epsilon owner_of", memory="claims")


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


def refuse_nan(preferences: NDArray[np.float64], who: str) -> None:
    """Raise `UserError` if a policy, by its name for messages, prefers what is no number."""
    if np.isnan(preferences).any():
        raise UserError(
            f"{who}: gives preferences that are NaN; give illegal or unwanted moves -inf"
        )


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
        self._resolve = BoundKernel(_resolve, movers, corruption, Claims.of(len(graph)))
        self._one_owner = np.zeros(len(fleet), np.int64)

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
        moves = Moves.of(agent_node.shape)
        acts_by = self._one_owner if owner_of is None else owner_of
        given = (active, preferences, agent_node, energy_left, belief, acts_by, step, keys)
        ask = Ask(*map(np.ascontiguousarray, given, _ASK_TYPES))
        if not self._resolve(ask, moves):
            refuse_nan(preferences, who)
        return moves

    def on_device(self, bind: Bind, ask: Ask, moves: Moves) -> Call:
        """The same by a kernel on a device, which fills `moves`; NaN leaves them as they are."""
        return bind(RESOLVE, *self._resolve.fixed, ask, moves)
