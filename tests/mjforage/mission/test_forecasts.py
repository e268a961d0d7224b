"""Forecasts held against the truth, by hand."""

from typing import Any

import numpy as np
import pytest

from mjforage import metrics
from mjforage.base.errors import UserError
from mjforage.graph_planner.policies import create_policy
from mjforage.mission.forecasts import Forecasts
from mjforage.mission.mission import Mission
from mjforage.mission.scoring import Scorer
from mjforage.mission.setup import Setup
from mjforage.scenario.scenario_file import load_scenario

TRUTH = np.array([[2, 0, 0], [0, 0, 1]], np.int16)
HALF = float(np.log(2.0))  # items expected where the chance of any is one half


def test_sure_and_unsure_forecasts_add_up() -> None:
    """Episode 0: 1 - exp(-ln 2) = .5 with an item there, twice nothing expected; 1 is over."""
    forecasts, active = Forecasts(2), np.array([True, False])
    expected = np.array([[HALF, 0.0, 0.0], [9.0, 9.0, 9.0]])
    forecasts.take(expected, TRUTH, active)
    found = forecasts.sums
    assert found[0, 5] == pytest.approx([1.0, 0.5, 1.0, 0.25])
    assert found[0, 0] == pytest.approx([2.0, 0.0, 0.0, 0.0])
    assert (found[1] == 0.0).all()
    assert metrics.brier(found)[0] == pytest.approx(0.25 / 3)


def test_all_owners_of_an_episode_count() -> None:
    forecasts = Forecasts(2)
    rows = np.array([[HALF, 0.0, 0.0]] * 2 + [[0.0, 0.0, HALF], [0.0, HALF, 0.0]])
    forecasts.take(rows, TRUTH, np.ones(2, np.bool_))
    assert forecasts.sums[0, 5] == pytest.approx([2.0, 1.0, 2.0, 0.5])
    assert forecasts.sums[1, 5] == pytest.approx([2.0, 1.0, 1.0, 0.5])
    other = Forecasts(1)
    forecasts.replace_episodes(np.array([1]), other)
    assert (forecasts.sums[1] == 0.0).all() and forecasts.sums[0].sum() > 0.0


def test_items_in_view_are_foretold_with_certainty() -> None:
    """Before the first move, by perfect sensors: those nodes are in the last tenth."""
    mission = Mission(Setup.of(load_scenario("comb-port")))
    mission.reset(2, np.arange(24))
    in_view = (mission.knowledge.belief > 0).sum(axis=1)
    assert (in_view > 0).sum() > 1
    policy = create_policy("belief(fast=true)")
    mission.prepare(policy)
    mission.ask(policy)
    foretold, _, there, _ = mission.forecasts.sums[:, -1].T
    assert (in_view <= there).all() and (there <= foretold).all()
    np.testing.assert_array_equal(foretold[in_view == 0], 0.0)


def test_the_belief_planner_forecasts_with_skill_and_others_not_at_all() -> None:
    """Better than the base rate, and calibrated to .02 where it knows its sensors."""
    overrides = ["horizon=60", "sensors.detection=0.7", "prior.detection=0.7"]
    scores = {}
    for policy in ("belief", "greedy"):
        mission = Mission(Setup.of(load_scenario("comb-port", overrides)))
        mission.reset(5, np.arange(4))
        scorer = Scorer(mission)
        mission.run(create_policy(policy), (scorer,))
        scores[policy] = scorer.scores().scalars
    assert (scores["belief"]["brier_skill"] > 0.3).all()
    assert scores["belief"]["calibration_error"].mean() < 0.02
    assert np.isnan(scores["greedy"]["brier_skill"]).all()


@pytest.mark.parametrize(
    ("expected", "words"),
    [
        (np.full((2, 3), np.nan), "gives items that are negative or NaN; give 0 or more"),
        (np.full((2, 3), -1e300), "gives items that are negative or NaN"),
        (
            np.zeros((2, 4)),
            r"gave float64 \(2, 4\), expected numbers of shape \(row, node\), with 3",
        ),
        (np.zeros((3, 3)), r"gave float64 \(3, 3\), expected numbers"),
        (np.zeros(6), r"gave float64 \(6,\), expected numbers"),
        (np.full((2, 3), "items"), r"gave <U5 \(2, 3\), expected numbers"),
        ([[0.0] * 3] * 2, "gave list, expected numbers"),
    ],
)
def test_what_is_no_forecast_is_refused(expected: Any, words: str) -> None:
    """Its chances are places in a table."""
    with pytest.raises(UserError, match=rf"^policy Seer: forecast {words}"):
        Forecasts(2).take(expected, TRUTH, np.ones(2, np.bool_), "policy Seer")


def test_endlessly_many_items_are_a_sure_forecast() -> None:
    forecasts = Forecasts(2)
    forecasts.take(np.full((2, 3), np.inf), TRUTH, np.ones(2, np.bool_))
    assert forecasts.sums[:, -1, 0].tolist() == [3.0, 3.0]
