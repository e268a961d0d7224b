"""The time of decisions: of the policy alone, without its first call, and nothing else changed."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import count
from pathlib import Path

import numpy as np
import pytest

from mjforage.graph_planner.policies import create_policy
from mjforage.mission.mission import Mission
from mjforage.mission.setup import Setup
from mjforage.runs.costs import load_costs
from mjforage.runs.decision_time import Timer, timed
from mjforage.runs.evaluate import evaluate
from mjforage.scenario.scenario_file import load_scenario

EPISODES = 3


def ticking() -> Timer:
    """A clock that is one second later whenever it is read."""
    ticks: Iterator[int] = count()
    return Timer(lambda: float(next(ticks)))


def setup_of(name: str) -> Setup:
    return Setup.of(load_scenario(name, ["horizon=9"]))


def played(name: str, policy: str, timer: Timer | None) -> Mission:
    mission = Mission(setup_of(name))
    mission.reset(1, np.arange(EPISODES))
    made = create_policy(policy)
    mission.run(made if timer is None else timed(made, timer, EPISODES))
    return mission


@pytest.mark.parametrize(
    ("policy", "readings"),
    [("greedy", 1), ("oracle", 2), ("belief", 1)],  # a bound is shown the truth as well
)
def test_every_call_but_the_first_counts(policy: str, readings: int) -> None:
    timer = ticking()
    played("comb-port", policy, timer)
    assert (timer.cpu_s, timer.decisions) == (8.0 * readings, 8 * EPISODES)


def test_a_decision_is_the_fleets_where_every_agent_decides_by_itself() -> None:
    """Over a radio there is a row for each of four agents."""
    timer = ticking()
    mission = played("comb-port-radio", "greedy", timer)
    assert mission.exchange.owners == 4
    assert (timer.cpu_s, timer.decisions) == (8.0, 8 * EPISODES)


@pytest.mark.parametrize("policy", ["greedy", "oracle", "belief"])
def test_what_is_watched_plays_as_it_would(policy: str) -> None:
    alone, timed = (played("comb-port", policy, timer) for timer in (None, Timer()))
    assert np.array_equal(alone.state.agent_rc, timed.state.agent_rc)
    assert np.array_equal(alone.forecasts.sums, timed.forecasts.sums)


def test_a_watched_policy_has_the_name_and_attributes_of_its_own() -> None:
    policy = create_policy("ddqn")
    proxy = timed(policy, Timer(), 1)
    assert type(proxy).__name__ == type(policy).__name__
    assert proxy.files == policy.files  # type: ignore[attr-defined]
    assert not hasattr(proxy, "set_ground_truth")


def test_episodes_that_are_over_are_not_counted() -> None:
    timer = ticking()
    policy = timed(create_policy("random"), timer, EPISODES)
    mission = Mission(setup_of("comb-port"))
    mission.reset(1, np.arange(EPISODES))
    mission.prepare(policy)
    policy.act(mission.observation)
    policy.act(mission.observation._replace(active=np.array([True, False, True])))
    assert timer.decisions == 2


def test_costs_of_a_run_have_the_time_of_decisions(tmp_path: Path) -> None:
    evaluate(setup_of("comb-port"), ["greedy", "belief"], tmp_path / "run", episodes=EPISODES)
    for cost in load_costs(tmp_path / "run" / "costs.json"):
        assert cost.decisions == 8 * EPISODES
        assert 0.0 < cost.decide_s < cost.cpu_s
    assert replace(cost, decide_s=0.0, decisions=0) == type(cost).of(
        {k: v for k, v in vars(cost).items() if not k.startswith("deci")}, "an older one"
    )
