"""Normalised scores, performance profiles and Pareto fronts, by hand."""

import numpy as np
import pytest

from mjforage.metrics import normalised, pareto_front, performance_profile, resampled_means

NAN = np.nan


def test_the_floor_is_0_the_ceiling_1_whichever_way_is_better() -> None:
    assert normalised([60.0, 80.0, 100.0, 40.0], 60.0, 100.0).tolist() == [0.0, 0.5, 1.0, -0.5]
    assert normalised([0.8, 0.2, 0.5], 0.8, 0.2) == pytest.approx([0.0, 1.0, 0.5])
    assert np.isnan(normalised([0.8, NAN], 0.8, [0.8, 0.2])).all()


def test_a_profile_is_the_share_as_good_as_each_threshold() -> None:
    """Of 1, 2, 2 and 4: all are >= 1, three >= 2, one >= 3 and >= 4, none >= 5."""
    runs, strata = [1.0, 2.0, 2.0, 4.0], [0, 0, 1, 1]
    more = performance_profile(runs, [1.0, 2.0, 3.0, 4.0, 5.0], 1, 0, strata=strata)
    assert more.value.tolist() == [1.0, 0.75, 0.25, 0.25, 0.0]
    less = performance_profile(runs, [0.0, 1.0, 2.0, 4.0], -1, 0, strata=strata)
    assert less.value.tolist() == [0.0, 0.25, 0.75, 1.0]
    assert less.n.tolist() == [4] * 4


def test_a_run_without_a_value_is_as_good_as_nothing() -> None:
    for better in (1, -1):
        found = performance_profile([NAN, 2.0], [2.0], better, 0, strata=[0, 0])
        assert (found.value.tolist(), found.n.tolist()) == ([0.5], [2])


def test_bands_resample_runs_within_their_task_only() -> None:
    """Task 0 always reaches 1 and task 1 never: resampled within tasks, the share is one half."""
    runs, tasks = np.repeat([2.0, 0.0], 20), np.repeat(["a", "b"], 20)
    apart = performance_profile(runs, [1.0], 1, 0, strata=tasks)
    assert (apart.low.item(), apart.high.item()) == (0.5, 0.5)
    mixed = performance_profile(runs, [1.0], 1, 0, strata=np.zeros(40))
    # binomial: sqrt(.5 * .5 / 40) = .079, times 1.96 = .155
    assert mixed.low.item() == pytest.approx(0.345, abs=0.03)
    assert mixed.high.item() == pytest.approx(0.655, abs=0.03)


def test_one_run_has_no_band() -> None:
    found = performance_profile([1.0], [0.0, 2.0], 1, 0, strata=[0])
    assert found.value.tolist() == [1.0, 0.0]
    assert np.isnan(found.low).all() and np.isnan(found.high).all()


@pytest.mark.parametrize(
    ("values", "strata", "better", "words"),
    [
        ([[1.0]], [[0]], 1, "flat list"),
        ([1.0, 2.0], [0], 1, "strata"),
        ([1.0], [0], 0, "better 0"),
        ([np.inf], [0], 1, "NaN for undefined"),
    ],
)
def test_bad_arguments_of_a_profile_are_named(
    values: object, strata: object, better: int, words: str
) -> None:
    with pytest.raises(ValueError, match=words):
        performance_profile(values, [1.0], better, 0, strata=strata)  # type: ignore[arg-type]


def test_resampled_means_draw_the_same_episodes_in_every_row() -> None:
    values = np.random.default_rng(0).normal(size=(2, 3, 50))
    values[1] = values[0] + 7.0
    means = resampled_means(values, 4, resamples=300)
    assert means.shape == (2, 3, 300)
    assert means[1] - means[0] == pytest.approx(np.full((3, 300), 7.0))
    assert means[0].std(axis=1) == pytest.approx(values[0].std(axis=1) / 50**0.5, rel=0.15)


def test_resampled_means_leave_undefined_episodes_out() -> None:
    found = resampled_means([[3.0, NAN, 3.0, NAN], [NAN, NAN, NAN, NAN]], 1, resamples=40)
    assert set(found[0][~np.isnan(found[0])]) == {3.0}
    assert np.isnan(found[1]).all()


def test_the_pareto_front_is_what_nothing_dominates() -> None:
    """2 costs as much as 1 and is worse; 4 is better and dearer; 3 is beaten by 1 in both."""
    cost, quality = [1.0, 2.0, 2.0, 3.0, 9.0], [0.1, 0.6, 0.5, 0.4, 0.9]
    assert pareto_front(cost, quality).tolist() == [True, True, False, False, True]
    assert pareto_front([1.0, 1.0], [0.5, 0.5]).tolist() == [True, True], "neither dominates"
    assert pareto_front([1.0, 1.0], [0.5, 0.6]).tolist() == [False, True]
    assert pareto_front([1.0, 2.0], [0.5, 0.5]).tolist() == [True, False]
    assert pareto_front([NAN, 2.0, 1.0], [0.9, 0.5, NAN]).tolist() == [False, True, False]
