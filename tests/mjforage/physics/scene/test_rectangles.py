import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from mjforage.physics.scene.rectangles import merged_rectangles, narrowest_passage

MASKS = arrays(np.bool_, st.tuples(st.integers(1, 8), st.integers(1, 8)))


def test_an_l_needs_two_rectangles() -> None:
    land = np.array([[1, 1, 1], [1, 0, 0], [1, 0, 0]], bool)
    assert merged_rectangles(land).tolist() == [[0, 0, 1, 3], [1, 0, 3, 1]]


@given(MASKS)
def test_rectangles_cover_land_exactly_once(land: np.ndarray) -> None:
    covered = np.zeros(land.shape, int)
    for top, left, bottom, right in merged_rectangles(land):
        covered[top:bottom, left:right] += 1
    np.testing.assert_array_equal(covered, land.astype(int))


def test_narrowest_passage_is_the_shorter_run() -> None:
    water = np.ones((6, 9), bool)
    assert narrowest_passage(water) == 6
    water[2:4, :] = False
    assert narrowest_passage(water) == 2
    water[2:4, 4] = True
    assert narrowest_passage(water) == 1
