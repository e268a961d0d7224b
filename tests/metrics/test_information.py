"""Ages, disagreement, contact, handover and the cost of information, by hand and word for word."""

from typing import Any

import numpy as np
import pytest

from mjforage.metrics import (
    age_of_information,
    contact_share,
    handover,
    model_error,
    position_age,
    unlikeness,
)

NEVER = -32768
NAN = np.nan


@pytest.mark.parametrize("kind", [np.int16, np.int32, np.int64])
def test_age_of_three_nodes(kind: Any) -> None:
    """Of 10 steps at step 4: seen now, at step 1, never: (0 + 3 + 10) / 3."""
    seen = np.array([[4, 1, NEVER], [4, 4, 4]], kind)
    ages = age_of_information(seen, np.array([4, 4]), 10)
    assert ages.tolist() == [pytest.approx(13 / 3), 0.0]


def test_age_is_that_of_the_definition_on_any_map() -> None:
    rng = np.random.default_rng(0)
    for nodes in (1, 7, 4096, 9001):  # parts of 4096 are added up by themselves
        seen = rng.integers(-1, 30_000, (3, nodes)).astype(np.int16)
        seen[seen % 5 == 0] = NEVER
        now, horizon = np.array([30_000, 30_001, 32_000]), 20_000
        ages = np.minimum(now[:, None] - seen.astype(np.int64), horizon).mean(axis=1)
        found = age_of_information(seen, now, horizon)
        np.testing.assert_allclose(found, ages, rtol=1e-12)
        assert found[1:2] == age_of_information(seen[1:2], now[1:2], horizon), "alone the same"


def test_never_may_lie_as_far_back_as_one_likes() -> None:
    assert age_of_information(np.array([-(10**12), 3]), np.array(4), 10) == 5.5


def test_position_age_of_two_agents() -> None:
    """At step 9: the first heard of the second at 7, the second of the first at 3."""
    seen = np.array([[9, 7], [3, 9]])
    assert position_age(seen, 9) == (2 + 6) / 2
    own = np.array([[0, 7], [3, 0]])
    assert position_age(own, 9) == 4.0, "what each knows of itself does not count"
    three = np.array([[5, 4, 3], [5, 5, 5], [0, 5, 5]])
    assert position_age(three, 5) == (1 + 2 + 0 + 0 + 5 + 0) / 6
    assert np.isnan(position_age(np.zeros((1, 1)), 9))


def test_contact_counts_pairs() -> None:
    links = np.zeros((2, 3, 3), bool)
    links[0, 0, 1] = links[0, 1, 0] = True
    links[:, range(3), range(3)] = True
    assert contact_share(links).tolist() == [pytest.approx(1 / 3), 0.0]
    assert np.isnan(contact_share(np.ones((1, 1))))


def _unlike(together: Any, maps: Any, truth: Any, water: Any) -> tuple[Any, Any]:
    return unlikeness(together, maps, truth, model_error(truth, together, water)[0], water)


def test_disagreement_is_the_mean_error_of_the_pairs() -> None:
    """Two alike, and a third that believes in two items more: two pairs of three differ."""
    water = np.ones((3, 3), bool)
    maps = np.zeros((1, 3, 9), np.int16)
    maps[0, 2, 4] = 2
    apart = model_error(maps[0, 0], maps[0, 2], water)[0]
    assert apart > 0
    for together in (maps[:, 0], maps[:, 2]):
        unlike, wrong = _unlike(together, maps, maps[:, 0], water)
        assert unlike == pytest.approx([2 / 3 * apart])
        assert wrong == pytest.approx([apart / 3])
    assert _unlike(maps[:, 0], maps, maps[:, 2], water)[1] == pytest.approx([2 / 3 * apart])
    unlike, wrong = _unlike(maps[:, 0], maps[:, :1], maps[:, 0], water)
    assert np.isnan(unlike).all() and wrong.tolist() == [0.0]


@pytest.mark.parametrize("shape", [(3, 2), (9, 12), (25, 30)])
def test_how_unlike_maps_are_is_what_model_error_says(shape: tuple[int, int]) -> None:
    """Of every pair and of every holder, near quays and borders too; and the same in any batch."""
    rng = np.random.default_rng(1)
    water = rng.random(shape) < 0.7
    maps = (rng.random((4, 5, water.sum())) < 0.1).astype(np.int16)
    truth, together = rng.integers(0, 3, (2, 4, water.sum()))
    whole = _unlike(together, maps, truth, water)
    pairs = [(i, j) for i in range(5) for j in range(i)]
    for e in range(4):
        alone = _unlike(together[e : e + 1], maps[e : e + 1], truth[e : e + 1], water)
        assert alone[0][0] == whole[0][e] and alone[1][0] == whole[1][e]
        each = [float(model_error(maps[e, i], maps[e, j], water)[0]) for i, j in pairs]
        assert whole[0][e] == pytest.approx(np.mean(each), rel=1e-9)
        own = [float(model_error(truth[e], maps[e, i], water)[0]) for i in range(5)]
        assert whole[1][e] == pytest.approx(np.mean(own), rel=1e-9)


def test_maps_that_are_alike_do_not_disagree_at_all() -> None:
    rng = np.random.default_rng(2)
    water = np.ones((12, 14), bool)
    one, together = rng.integers(0, 3, (2, water.sum()))
    assert _unlike(together[None], np.stack([one] * 3)[None], one[None], water)[0][0] == 0.0


def test_shapes_that_do_not_fit_are_refused() -> None:
    water, maps = np.ones((3, 3), bool), np.zeros((2, 3, 9))
    with pytest.raises(ValueError, match=r"maps has shape \(2, 3, 9\), base \(1, 9\)"):
        unlikeness(np.zeros((1, 9)), maps, np.zeros((2, 9)), np.zeros(2), water)


def test_handover_of_four_items() -> None:
    """Of 20 steps: heard at once, 3 later, never (20 - 12), and one that nobody found."""
    found, heard = [5.0, 2.0, 12.0, NAN], [5.0, 5.0, NAN, NAN]
    assert handover(found, heard, 20) == pytest.approx((0 + 3 + 8) / 3 / 20)
    assert handover([5.0], [30.0], 20) == 0.75, "after the end is never"
    assert np.isnan(handover([NAN], [NAN], 20))
    assert handover([[1.0, NAN], [4.0, 4.0]], [[2.0, NAN], [4.0, 6.0]], 10).tolist() == [0.1, 0.1]


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: age_of_information(np.zeros((2, 0), int), np.zeros(2, int), 5), "no node"),
        (lambda: age_of_information(np.zeros((2, 3), int), np.zeros(3, int), 5), "now has shape"),
        (lambda: age_of_information(np.zeros((2, 3), int), np.zeros(2, int), 0), "horizon 0"),
        (lambda: position_age(np.zeros((2, 3)), 5), r"agent_seen has shape \(2, 3\)"),
        (lambda: contact_share(np.zeros(3)), "linked has shape"),
        (lambda: handover([5.0], [4.0], 20), "before it is discovered"),
        (lambda: handover([5.0], [4.0, 5.0], 20), "same shape"),
    ],
)
def test_bad_arguments_are_refused(call: Any, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        call()
