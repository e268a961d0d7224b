"""Environments over a link: every agent sees what it has scanned and received itself."""

from dataclasses import dataclass, field, replace
from typing import Any

import gymnasium
import numpy as np
import pytest
from numpy.typing import NDArray

import mjforage
from mjforage.graph_planner.encodings import create_encoder
from mjforage.graph_planner.encodings.masks import legal_of_agent
from mjforage.graph_planner.policies import create_policy
from mjforage.learning.environments.core import EnvironmentCore
from mjforage.learning.environments.options import EnvironmentOptions
from mjforage.mission.initial_state import InitialState
from mjforage.mission.mission import Mission
from mjforage.mission.moves import free_move
from mjforage.mission.setup import Setup
from mjforage.mission.task import Observation

NEAR = ("horizon=60", "link.model=disk", "link.range_m=40", "link.latency=1")


def core(*overrides: str, num_envs: int = 3) -> EnvironmentCore:
    return EnvironmentCore(EnvironmentOptions(set=("horizon=30", *overrides)), num_envs)


@pytest.mark.parametrize("kind", ["egocentric", "paper"])
def test_an_agent_sees_its_own_row_of_the_mission(kind: str) -> None:
    """Its row alone, encoded by an encoder of its own, is what it sees, in every view."""
    env, rng = mjforage.parallel_env(set=NEAR, observation=kind), np.random.default_rng(3)
    stacked: Any = gymnasium.make("mjforage/Foraging-v0", set=NEAR, observation=kind)
    turns: Any = gymnasium.make("mjforage/SharedPolicy-v0", set=NEAR, observation=kind)
    seen, _ = env.reset(seed=4)
    all_seen, _ = stacked.reset(seed=4)
    one_seen, info = turns.reset(seed=4)
    mission, names = env.core.mission, env.possible_agents
    encoders = [create_encoder(kind, mission.task) for _ in names]
    for each in encoders:
        each.reset(1)
    for _ in range(20):
        moves = {a: int(rng.choice(np.flatnonzero(seen[a]["action_mask"]))) for a in names}
        for i, name in enumerate(names):
            held: Any = mission.owner_observation
            row = Observation(*(array[i : i + 1] for array in held))
            for key, level in encoders[i].see(row, np.zeros(1, np.int64)).items():
                expected = level[0, i] * np.float32(1 / 255)
                np.testing.assert_array_equal(seen[name][key], expected)
                np.testing.assert_array_equal(all_seen[key][i], expected)
        for _ in names:
            for key in encoders[0].shapes:
                np.testing.assert_array_equal(one_seen[key], all_seen[key][info["agent"]])
            one_seen, *_, info = turns.step(moves[names[info["agent"]]])
        seen, *_ = env.step(moves)
        all_seen, *_ = stacked.step(np.array(list(moves.values())))


@dataclass
class Played:
    """An episode of `parallel_env`, step by step."""

    env: Any
    shown: list[dict[str, Any]] = field(default_factory=list)  # by agent
    masks: list[dict[str, Any]] = field(default_factory=list)
    steps: list[dict[str, Any]] = field(
        default_factory=list
    )  # what infos say but rewards and truth
    moves: list[NDArray[np.int8]] = field(default_factory=list)  # (agent,)
    item_node: list[NDArray[np.int32]] = field(default_factory=list)  # (item,)

    def note(self, seen: Any, infos: Any) -> None:
        self.masks.append({a: one.pop("action_mask") for a, one in seen.items()})
        self.shown.append(seen)
        scores = ("pta_d", "pta_c")
        self.steps.append(
            {
                a: {k: v for k, v in i.items() if k not in scores and "/" not in k}
                for a, i in infos.items()
            }
        )
        self.item_node.append(self.env.core.mission.state.item_node[0].copy())


def play(moves: list[NDArray[np.int8]] | None = None, seed: int = 5) -> Played:
    """An episode by given moves; absent: Greedy's."""
    one = Played(mjforage.parallel_env(set=NEAR))
    one.note(*one.env.reset(seed=seed))
    mission: Mission = one.env.core.mission
    policy = create_policy("greedy")
    mission.prepare(policy)
    for step in range(50):
        chosen = mission.decide(mission.ask(policy)).direction[0] if moves is None else moves[step]
        one.moves.append(chosen)
        seen, _, _, _, infos = one.env.step(dict(zip(one.env.agents, chosen.tolist(), strict=True)))
        one.note(seen, infos)
    return one


def reported_to(one: Played, holder: int) -> NDArray[np.bool_]:
    """(item,) Which items any scan that an agent has received shows, or reports as removed."""
    mission: Mission = one.env.core.mission
    net: Any = mission.exchange
    received_at, log, entries = (
        net.net.inbox.received_at[0, holder],
        net.net.log,
        mission.ledger,
    )
    reported = np.zeros(one.item_node[0].size, np.bool_)
    for agent, step in np.argwhere((received_at >= 0) & (received_at <= 50)):
        radius = int(mission.task.radius_number[agent])
        reported |= np.isin(
            one.item_node[step], mission.task.views.of(log.node[0, step, agent], radius)
        )
        reported |= (entries.collected_by[0] == agent) & (entries.t_collected[0] <= step)
    return reported


def test_what_an_agent_has_not_received_changes_nothing_for_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Items outside the scans that it has received are removed from the world; it sees the same."""
    real, whole = Setup.create_initial_state, play()
    noticed = 0
    for holder, name in enumerate(whole.env.possible_agents):
        reported = reported_to(whole, holder)
        gone = np.flatnonzero(~reported)[1:]  # one stays, or the episode is over

        def without(setup: Setup, keys: Any, gone: NDArray[np.intp] = gone) -> InitialState:
            initial = real(setup, keys)
            item_node = initial.item_node.copy()
            item_node[:, gone] = -1
            return replace(initial, item_node=item_node, n_items=initial.n_items - gone.size)

        monkeypatch.setattr(Setup, "create_initial_state", without)
        less = play(whole.moves)
        for step, (before, after) in enumerate(zip(whole.shown, less.shown, strict=True)):
            for key, array in before[name].items():
                np.testing.assert_array_equal(array, after[name][key], f"{name}, {key}, {step}")
            np.testing.assert_array_equal(whole.masks[step][name], less.masks[step][name])
            assert whole.steps[step][name] == less.steps[step][name] == {"step": step}
            others = [one for one in before if one != name]
            noticed += any(
                (before[o][key] != after[o][key]).any() for o in others for key in before[o]
            )
        assert gone.size > 5 and not np.array_equal(whole.env.state(), less.env.state())
    assert noticed > 10, "others were shown the items that one was not"


def test_rewards_are_of_all_looks_whatever_the_link() -> None:
    rng = np.random.default_rng(1)
    one, other = core("link.model=ideal"), core("link.model=none")
    for each in (one, other):
        each.start(np.arange(3), np.array([3, 4, 5], np.uint64))
    earned = 0.0
    for _ in range(20):
        moves = rng.integers(0, 9, (3, one.agents))
        ideal, alone = one.step(moves), other.step(moves)
        earned += float(np.abs(ideal.rewards).sum())
        for term, value in ideal.terms.items():
            np.testing.assert_array_equal(value, alone.terms[term])
    assert earned > 0.0


@pytest.mark.parametrize("link", ["link.model=ideal", "link.model=none"])
def test_only_claims_within_the_sum_of_their_moves_are_masked(link: str) -> None:
    """So no mask tells of anybody who is out of sight, and none hangs on the link."""
    env: Any = gymnasium.make("mjforage/SharedPolicy-v0", set=("horizon=40", link)).unwrapped
    seen, info = env.reset(seed=2)
    rng, task, over, fewer = np.random.default_rng(0), env.core.setup.task, False, 0
    arrays, graph = task.arrays, task.graph
    claims: dict[int, int] = {}  # agent -> node
    while not over:
        agent, at = int(info["agent"]), env.core.mission.state.agent_node[0]
        claims = {} if agent == task.fleet.order[0] else claims
        rows, cols = graph.rows[at], graph.cols[at]
        apart = np.maximum(abs(rows - rows[agent]), abs(cols - cols[agent]))
        near = [b for b in claims if apart[b] <= arrays.moves[agent] + arrays.moves[b]]
        masks = []
        for others in (claims, near, ()):
            taken = np.zeros(len(graph), np.int64)
            taken[[claims[b] for b in others]] = 1
            masks.append(legal_of_agent(arrays, taken, 1, agent, at[agent], np.inf))
        np.testing.assert_array_equal(seen["action_mask"], masks[0])
        np.testing.assert_array_equal(seen["action_mask"], masks[1])
        fewer += masks[2].sum() > masks[0].sum()
        move = int(rng.choice(np.flatnonzero(seen["action_mask"])))
        taken[list(claims.values())] = 1
        how = arrays.moves[agent], arrays.stay, arrays.shorten
        claims[agent], _ = free_move(arrays.neighbours, taken, 1, at[agent], move, *how)
        seen, _, ended, late, info = env.step(np.int64(move))
        over = ended or late
    assert fewer > 5
