"""Shades of believed counts."""

import numpy as np

from mjforage.view.render.palette import belief_shades, most_believed


def test_shades_of_beliefs_go_by_ratio_from_one_to_the_most() -> None:
    """2 of 4 and 4 of 16 are half way by their logarithm; more than the most is no darker."""
    few, many = belief_shades(np.array([1, 2, 4]), 4), belief_shades(np.array([1, 4, 16, 99]), 16)
    np.testing.assert_array_equal(few, many[:3])
    np.testing.assert_array_equal(many[2], many[3])
    assert (few[0].sum(), few[1].sum()) > (few[1].sum(), few[2].sum()), "the more the darker"


def test_the_most_is_of_all_episodes_and_four_at_least() -> None:
    assert most_believed(np.array([[2, 1]]), np.array([[0, 3]])) == 4
    assert most_believed(np.array([[2, 1]]), np.array([[0, 9]]), np.array([[5]])) == 9
