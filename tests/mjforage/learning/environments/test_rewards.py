"""Reward terms against their definitions, in plain numpy, along played episodes."""

import numpy as np
import pytest

from graph_planner.policies import create_policy
from mjforage.core.mission import Mission, Setup
from mjforage.core.scenario_file import load_scenario
from mjforage.learning.environments.rewards import PUBLISHED, TERMS, RewardTerms


def test_the_published_weights() -> None:
    assert PUBLISHED == {"belief": 2.12, "removed": 5.91, "idleness": 2.23, "distance": -1.7}


@pytest.fixture(scope="module")
def setup() -> Setup:
    return Setup.of(load_scenario("published", ("horizon=60",)))


def test_terms_by_their_definitions(setup: Setup) -> None:
    mission, policy = Mission(setup), create_policy("greedy")
    terms = RewardTerms(setup.task, tuple(TERMS))
    mission.reset(3, np.arange(3))
    policy.reset(setup.task, mission.keys)
    graph, fleet, task = setup.graph, setup.fleet, setup.task
    sums = dict.fromkeys(TERMS, 0.0)
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
                    "removed": removed,
                    "team_removed": new.sum() / 4,
                    "belief": (change[view] / viewers[view]).sum(),
                    "idleness": 0.0 if fleet.collects[a] else idle[view].sum(),
                    "distance": nearest,
                    "approach": gain,
                    "time": float((mission.state.item_node[e] >= 0).any()),
                }
                for name, value in expected.items():
                    assert found[name][e, a] == pytest.approx(value, abs=1e-5), name
        for name, value in found.items():
            assert not value[~played].any()
            sums[name] += value.sum()
    total = mission.initial.n_items.sum()
    assert sums["removed"] == (mission.ledger.entries.t_collected >= 0).sum() <= total
    assert sums["discovered"] <= (mission.ledger.entries.t_discovered >= 0).sum()
    assert all(sums[name] != 0.0 for name in ("belief", "idleness", "distance", "approach"))
