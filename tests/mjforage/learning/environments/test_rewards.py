"""Reward terms against their definitions, in plain numpy, along played episodes."""

from copy import copy
from typing import Any

import numpy as np
import pytest

import mjforage
from mjforage.base.errors import UserError
from mjforage.graph_planner.graph.geodesics import Workspace
from mjforage.graph_planner.policies import create_policy
from mjforage.learning.environments.rewards import REWARDS, RewardTerms, reward_weights
from mjforage.learning.environments.rewards.items_gained import _count
from mjforage.learning.environments.rewards.potentials import WithinReach
from mjforage.learning.environments.rewards.term import Before, Step
from mjforage.mission.dynamics import ARRIVED, BLOCKED
from mjforage.mission.mission import Mission
from mjforage.mission.setup import Setup
from mjforage.scenario.scenario_file import load_scenario


@pytest.fixture(scope="module")
def setup() -> Setup:
    return Setup.of(load_scenario("published", ("horizon=60",)))


def potentials(mission: Mission, at: Before, e: int) -> dict[str, np.ndarray]:
    """Each potential (agent,) of an episode in which somebody has energy left."""
    graph, fleet, ledger = mission.setup.graph, mission.setup.fleet, mission.ledger
    afloat, found = at.item_node[e] >= 0, ledger.t_discovered[e]
    items = ((mission.state.item_node[e] >= 0) | (ledger.t_collected[e] >= 0)).sum()
    seen = afloat & (found >= 0) & (found <= at.step[e])
    away = graph.distances[at.agent_node[e]][:, at.item_node[e][seen]].astype(float)
    away[~fleet.collects | (at.energy_left[e] < 1.0)] = np.inf
    reach = np.zeros(len(fleet))
    np.add.at(reach, away.argmin(axis=0), 0.85 ** away.min(axis=0))
    unseen_for = at.step[e] - at.last_seen[e].astype(float)
    fresh = 1.0 - np.minimum(1.0, unseen_for * mission.task.forgetting).mean()
    by = ledger.discovered_by[e][:, None] == np.arange(len(fleet))
    worth = {
        "known": (by & seen[:, None]).sum(axis=0) / items,
        "reach": reach / items,
        "fresh": np.full(len(fleet), fresh / len(fleet)),
    }
    return {name: value * afloat.any() for name, value in worth.items()}


def test_terms_by_their_definitions(setup: Setup) -> None:
    mission, policy = Mission(setup), create_policy("greedy")
    terms = RewardTerms(setup.task, REWARDS.names())
    mission.reset(3, np.arange(3))
    policy.reset(setup.task, mission.keys)
    graph, fleet, task = setup.graph, setup.fleet, setup.task
    sums = dict.fromkeys(REWARDS.names(), 0.0)
    while mission.active.any():
        played = mission.active.copy()
        terms.before(mission)
        old, known = terms._before, mission.knowledge
        collected = mission.state.collected_by.copy()
        mission.advance(policy.act(mission.observation))
        found = terms.after(mission, played)
        for e in np.flatnonzero(played):
            views = [
                task.views.of(mission.state.agent_node[e, a], int(task.radius_number[a]))
                for a in range(4)
            ]
            viewers = np.zeros(len(graph))
            for view in views:
                viewers[view] += 1
            change = np.abs(known.belief[e] - old.belief[e]).astype(float)
            idle = np.minimum(
                1.0, (mission.step[e] - old.last_seen[e].astype(float)) * task.forgetting
            )
            new = (mission.state.collected_by[e] != collected[e]) & (collected[e] < 0)
            entries = mission.ledger
            first_seen = entries.t_discovered[e] == mission.step[e]
            assert (mission.state.outcome[e] == ARRIVED).all()
            share = new.sum() / mission.initial.n_items[e] / 4
            was, is_now = (potentials(mission, at, int(e)) for at in (old, Before.of(mission)))
            for a, view in enumerate(views):
                here = mission.state.agent_node[e, a]
                now_known = np.flatnonzero(known.belief[e])
                was_known = np.flatnonzero(old.belief[e])
                nearest = graph.distances[here, now_known].min() if now_known.size else 0.0
                gain = 0.0
                if was_known.size:
                    before = graph.distances[old.agent_node[e, a], was_known].min()
                    gain = before - graph.distances[here, was_known].min()
                removed = (new & (mission.state.collected_by[e] == a)).sum()
                expected = {
                    "collected": share,
                    "early": share * (1.0 - mission.step[e] / 60),
                    **{name: 0.99 * is_now[name][a] - was[name][a] for name in was},
                    "removed": removed,
                    "team_removed": new.sum() / 4,
                    "discovered": (first_seen & (entries.discovered_by[e] == a)).sum(),
                    "blocked": 0.0,  # in open water an agent can always go somewhere
                    "belief": (change[view] / viewers[view]).sum(),
                    "idleness": 0.0 if fleet.collects[a] else idle[view].sum(),
                    "distance": nearest,
                    "approach": gain if fleet.collects[a] else 0.0,
                    "time": float((mission.state.item_node[e] >= 0).any()),
                }
                for name, value in expected.items():
                    assert found[name][e, a] == pytest.approx(value, abs=1e-5), name
        for name, value in found.items():
            assert not value[~played].any()
            sums[name] += value.sum()
    total = mission.initial.n_items.sum()
    assert sums["removed"] == (mission.ledger.t_collected >= 0).sum() <= total
    later = (mission.ledger.t_discovered > 0).sum()
    assert sums["discovered"] == later > sums["removed"], "scouts find more than is removed"
    assert all(sums[name] != 0.0 for name in REWARDS.names() if name != "blocked")


@pytest.mark.parametrize("table", [True, False])
def test_an_item_is_near_the_nearest_forager_that_has_energy(setup: Setup, table: bool) -> None:
    """With a table of distances, and on a map without one."""
    mission, task, workspace = Mission(setup), setup.task, Workspace.of(len(setup.graph))
    if not table:
        task = copy(task)
        none = np.empty((0, 0), np.float32)
        task.__dict__["arrays"] = setup.task.arrays._replace(distances=none)
    mission.reset(3, np.arange(3))
    policy = create_policy("greedy")
    policy.reset(setup.task, mission.keys)
    for _ in range(30):
        mission.advance(policy.act(mission.observation))
    at, (first, second) = Before.of(mission), setup.fleet.collectors
    energy_left, near = at.energy_left.copy(), at.agent_node.copy()
    energy_left[0, first], energy_left[1, second] = 0.5, 1.0
    known, reach = (at.item_node >= 0) & (mission.ledger.t_discovered >= 0), WithinReach()
    for e, item_node in enumerate(at.item_node):
        near[e, [first, second]] = item_node[known[e]][[0, -1]]
    for agent_node in (near, at.agent_node):
        there = at._replace(energy_left=energy_left, agent_node=agent_node)
        found = reach.value(Step(mission, there, task, workspace), there)
        assert found[0, first] == 0.0 < found[0, second]
        for e in range(3):
            assert found[e] == pytest.approx(potentials(mission, there, e)["reach"], abs=1e-6)


def test_an_agent_without_a_legal_move_is_blocked_and_the_others_are_not() -> None:
    """The scouts have no energy at all; the foragers go on."""
    setup = Setup.of(load_scenario("published", ("horizon=3", "team.scouts.energy=0.5")))
    mission, terms = Mission(setup), RewardTerms(setup.task, ("blocked",))
    mission.reset(3, np.arange(2))
    terms.before(mission)
    mission.advance(np.zeros((2, 4, 9)))
    assert (mission.state.outcome == np.where(setup.fleet.collects, ARRIVED, BLOCKED)).all()
    found = terms.after(mission, np.array([True, True]))
    expected = np.repeat([~setup.fleet.collects], 2, axis=0)
    np.testing.assert_array_equal(found["blocked"], expected.astype(np.float64))
    found = terms.after(mission, np.array([True, False]))
    expected[1] = False
    np.testing.assert_array_equal(found["blocked"], expected.astype(np.float64))


def test_items_count_for_the_agent_who_gets_them_in_this_step() -> None:
    agent = np.array([[0, 2, 2, -1], [1, 1, 0, 2]], np.int16)
    when = np.array([[5, 5, 5, 5], [4, 5, 6, -1]], np.int16)
    counts, means = np.ones((2, 2, 3))
    _count(agent, when, np.array([5, 5], np.int32), False, counts)
    _count(agent, when, np.array([5, 5], np.int32), True, means)
    np.testing.assert_array_equal(means, np.repeat(counts.mean(axis=1, keepdims=True), 3, axis=1))
    assert counts.tolist() == [[1.0, 0.0, 2.0], [0.0, 1.0, 0.0]]


def test_what_was_known_before_a_step_is_a_copy() -> None:
    setup = Setup.of(load_scenario("comb-port", ("horizon=10",)))
    mission, terms = Mission(setup), RewardTerms(setup.task, ["belief"])
    for episodes in (2, 3):
        mission.reset(0, np.arange(episodes))
        for _ in range(3):
            copied, live = terms.before(mission), Before.of(mission)
            for one, other in zip(copied, live, strict=True):
                np.testing.assert_array_equal(one, other)
                assert not np.shares_memory(one, other)
            mission.advance(np.random.default_rng(1).random((episodes, 4, 9)))


def test_each_agent_is_paid_for_the_items_that_it_removed_itself() -> None:
    """Also when others, who come before it in the fleet, are over."""
    few = ("horizon=60", "items.mean=80", "team.scouts.energy=6")
    env = mjforage.parallel_env(set=few, reward={"removed": 2.0, "time": -0.5})
    env.reset(seed=4)
    mission, policy = env.core.mission, create_policy("greedy")
    policy.reset(mission.task, mission.keys)
    earned, names = np.zeros(4), list(env.possible_agents)
    while env.agents:
        present = list(env.agents)
        moves = mission.decide(policy.act(mission.observation)).direction[0]
        before = (mission.state.collected_by[0][:, None] == np.arange(4)).sum(axis=0)
        chosen = {a: int(moves[names.index(a)]) for a in present}
        _, rewards, *_, infos = env.step(chosen)
        after = (mission.state.collected_by[0][:, None] == np.arange(4)).sum(axis=0)
        for a in present:
            own = 2.0 * (after - before)[names.index(a)]
            assert infos[a]["reward/removed"] == own and rewards[a] == own - 0.5
            earned[names.index(a)] += own
    assert not earned[:2].any() and earned[2] != earned[3] and present == names[2:]


@pytest.mark.parametrize(
    ("given", "term", "weight"),
    [
        ({"mission(gamma=0.95)": 1, "fresh": 0}, "fresh", None),
        ({"mission": 1, "reach(decay=0.5)": 7}, "reach", ("reach(decay=0.5)", 7.0)),
        ({"mission": 1, "fresh(gamma=0.95)": np.float32(3)}, "fresh", ("fresh(gamma=0.95)", 3.0)),
    ],
)
def test_a_term_replaces_a_presets_whatever_its_options(
    given: dict[str, Any], term: str, weight: tuple[str, float] | None
) -> None:
    found = {k: v for k, v in reward_weights(given).items() if k.partition("(")[0] == term}
    assert found == (dict([weight]) if weight else {})


@pytest.mark.parametrize(
    ("given", "words"),
    [({1: 2.0}, "reward 1: is int; give the name"), ({"collected": True}, "give a finite number")],
)
def test_weights_of_another_type_are_one_line(given: Any, words: str) -> None:
    with pytest.raises(UserError, match=words):
        reward_weights(given)
