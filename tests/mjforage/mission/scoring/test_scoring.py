"""From a log to the keys of summary.json, on an episode small enough to follow by hand."""

import numpy as np
import pytest

from mjforage.graph_planner.policies import create_policy
from mjforage.mission.episode_log import EpisodeLog
from mjforage.mission.mission import Mission
from mjforage.mission.scoring import (
    METRICS,
    Batch,
    Scorer,
    Scores,
    chosen_metrics,
    description,
    score,
)
from mjforage.mission.setup import Setup
from mjforage.scenario.scenario_file import load_scenario

BY_HAND = {
    "pta_d": 75.0,  # 3 of 4 found
    "pta_c": 50.0,  # 2 of 4 removed
    "rmse": 0.1,
    "rmse_columns": 0.05,
    "nt50": 0.5,  # the second one at step 5 of 10
    "nt90": 1.0,  # never
    "throughput": 2 / (3 * 10),  # 3 foragers
    "throughput_scouts": 3 / (2 * 10),  # 2 scouts
    "mi_final": 0.5,
    "mi_mean": 0.75,
    "irr_mean": 0.05,  # (1 - 0.5) / 10
    "dsl": 0.2,  # item 0: (3 - 1) / 10; item 1 is not removed, item 2 not a scout's
    "itl": 0.2,  # first largest rises at steps 1 and 3
    "itl_level": 0.0,  # both reach their maximum at step 5
    "csr": 0.5,
    "gini_foragers": 1 / 3,  # of 1, 1 and 0 items
    "gini_scouts": 0.0,
    "co_scouts": 0.25,
    "co_foragers": 0.0,
    "length": 10.0,
    "cleared": 0.0,
}
"""Of the log below, in the order of the columns."""


@pytest.fixture(scope="module")
def setup() -> Setup:
    return Setup.of(load_scenario("comb-port", ("horizon=10", "team.foragers.count=3")))


def by_hand(setup: Setup) -> Scores:
    """Scores of that log, with series that would have been taken live."""
    steps = np.linspace(1.0, 0.5, 11)[None, :]
    recorded = {
        "rmse": steps * 0.2,
        "rmse_columns": steps * 0.1,
        "mi": steps,
        "co_scouts": np.linspace(0.0, 0.5, 11)[None, :],
        "co_foragers": np.zeros((1, 11)),
    }
    return score(
        Batch(log_by_hand(setup), setup.fleet, 10, recorded), [METRICS.find(key) for key in BY_HAND]
    )


def log_by_hand(setup: Setup) -> EpisodeLog:
    """Two scouts (0, 1) and three foragers (2 to 4); four items, of which one is never found."""
    log = EpisodeLog(Mission(setup))
    log.n_items = np.array([4], np.int32)
    log.t_discovered = np.array([[1, 2, 5, -1, -1]], np.int16)
    log.discovered_by = np.array([[0, 1, 3, -1, -1]], np.int16)
    log.t_collected = np.array([[3, -1, 5, -1, -1]], np.int16)
    log.collected_by = np.array([[2, -1, 3, -1, -1]], np.int16)
    log.length = np.array([10], np.int32)
    return log


def test_scalars_of_an_episode_by_hand(setup: Setup) -> None:
    scores = by_hand(setup)
    for key, value in BY_HAND.items():
        assert scores.scalars[key][0] == pytest.approx(value), key


def test_an_episode_is_cleared_only_when_its_last_item_is_removed(setup: Setup) -> None:
    """The first episode keeps one item of 200, more than 99 % removed; the second keeps none."""
    log = log_by_hand(setup)
    removed = np.arange(200) < np.array([[199], [200]])
    log.n_items, log.length = np.array([200, 200], np.int32), np.array([10, 5], np.int32)
    log.t_discovered = log.t_collected = np.where(removed, 5, -1).astype(np.int16)
    log.discovered_by = log.collected_by = np.where(removed, 2, -1).astype(np.int16)
    scores = score(Batch(log, setup.fleet, 10, {}), [METRICS.find("cleared")])
    assert scores.scalars["cleared"].tolist() == [0.0, 1.0]


def test_below_90_are_episodes_with_less_than_nine_of_ten_removed(setup: Setup) -> None:
    log = log_by_hand(setup)
    removed = np.arange(10) < np.array([[8], [9], [10]])
    log.n_items, log.length = np.array([10, 10, 10], np.int32), np.array([10, 10, 5], np.int32)
    log.t_discovered = log.t_collected = np.where(removed, 5, -1).astype(np.int16)
    log.discovered_by = log.collected_by = np.where(removed, 2, -1).astype(np.int16)
    scores = score(Batch(log, setup.fleet, 10, {}), [METRICS.find("below_90")])
    assert scores.scalars["below_90"].tolist() == [1.0, 0.0, 0.0]


def test_energy_per_item_is_the_way_until_the_end_over_what_was_removed(setup: Setup) -> None:
    """Ways of 10, 2, 0, 3 and 6.5 after 5 steps for 2 items; after 4 steps 5 for none."""
    log = log_by_hand(setup)
    log.energy = np.zeros((2, 11, 5), np.float32)
    log.energy[0, 5], log.energy[0, 4] = [10.0, 2.0, 0.0, 3.0, 6.5], 1.0  # nothing after the end
    log.energy[1, 4] = 1.0
    log.n_items, log.length = np.array([4, 4], np.int32), np.array([5, 4], np.int32)
    for name in ("t_discovered", "discovered_by", "t_collected", "collected_by"):
        setattr(log, name, np.concatenate([getattr(log, name), np.full((1, 5), -1, np.int16)]))
    scores = score(Batch(log, setup.fleet, 10, {}), [METRICS.find("energy_per_item")])
    assert scores.scalars["energy_per_item"][0] == pytest.approx(21.5 / 2)
    assert np.isnan(scores.scalars["energy_per_item"][1])


def test_every_value_lies_within_the_ends_that_its_metric_states(setup: Setup) -> None:
    """But for conventions: errors have no end, and a skill may be below 0."""
    for key, (value,) in by_hand(setup).scalars.items():
        least, most = description(METRICS.find(key)).ends(10)
        assert least <= value <= most, key
    assert description(METRICS.find("length")).ends(10) == (0.0, 10.0)
    assert description(METRICS.find("energy_per_item")).ends(10) == (0.0, np.inf)


def test_columns_keep_their_order_and_others_come_after() -> None:
    assert [one.key for one in chosen_metrics()][: len(BY_HAND)] == list(BY_HAND)


def test_series_follow_the_events(setup: Setup) -> None:
    series = by_hand(setup).series
    assert series["pta_d"][0].tolist() == [0, 25, 50, 50, 50, 75, 75, 75, 75, 75, 75]
    assert series["pta_c"][0].tolist() == [0, 0, 0, 25, 25, 50, 50, 50, 50, 50, 50]
    assert np.isnan(series["csr"][0, :3]).all() and series["csr"][0, 3:6].tolist() == [1, 1, 0.5]
    assert series["gini_foragers"][0, 3] == pytest.approx(2 / 3) and np.isnan(series["irr"][0, -1])


def test_padding_items_do_not_count(setup: Setup) -> None:
    events = log_by_hand(setup).event_table()
    assert events.exists[0].tolist() == [True] * 4 + [False]


def test_metrics_are_those_of_the_run_itself(setup: Setup) -> None:
    """Counted straight from the mission's state, not through events."""
    mission = Mission(setup)
    mission.reset(0, np.arange(20))
    scorer = Scorer(mission)
    mission.run(create_policy("greedy"), (scorer,))
    scores = scorer.scores()
    left = (mission.state.item_node >= 0).sum(axis=1)
    removed = 100 * (1 - left / mission.initial.n_items)
    np.testing.assert_allclose(scores.scalars["pta_c"], removed)
    np.testing.assert_array_equal(scores.scalars["cleared"] == 1, left == 0)
    assert (scores.scalars["pta_d"] >= scores.scalars["pta_c"]).all()
