"""The sparse kernel against scipy's Gaussian filter, and what a caller can get wrong."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from mjforage.metrics import model_error

Floats = NDArray[np.float64]


def oracle(truth: Floats, estimate: Floats, navigable: NDArray[np.bool_]) -> tuple[float, float]:
    """The definition, word for word, for one pair of maps."""
    grids = np.zeros((2, *navigable.shape))
    grids[0][navigable], grids[1][navigable] = truth, estimate
    smooth = [gaussian_filter(grid, sigma=1.0, mode="reflect") for grid in grids]
    squares = (smooth[0] - smooth[1]) ** 2
    by_column = np.sqrt(squares.mean(axis=0))
    return float(np.sqrt(squares[navigable].mean())), float(by_column.mean())


def random_case(
    seed: int, rows: int, columns: int, share: float, batch: int = 1
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.bool_]]:
    rng = np.random.default_rng(seed)
    navigable = rng.random((rows, columns)) < 0.6
    navigable[rng.integers(rows), rng.integers(columns)] = True
    nodes = (batch, int(navigable.sum()))
    truth = rng.integers(0, 4, nodes) * (rng.random(nodes) < share)
    estimate = np.where(rng.random(nodes) < share, rng.integers(0, 4, nodes), truth)
    return truth, estimate, navigable


@settings(deadline=None, max_examples=150)
@given(
    st.integers(0, 100_000),
    st.integers(1, 24),
    st.integers(1, 24),
    st.sampled_from([0.02, 0.2, 1.0]),
)
def test_agrees_with_scipy_on_any_map(seed: int, rows: int, columns: int, share: float) -> None:
    truth, estimate, navigable = random_case(seed, rows, columns, share)
    expected = oracle(truth[0], estimate[0], navigable)
    np.testing.assert_allclose(model_error(truth[0], estimate[0], navigable), expected, atol=1e-12)


def test_one_cell_by_hand() -> None:
    # On a 1 x 1 map the reflected filter gives back the value itself: |5 - 2| = 3.
    rmse, rmse_columns = model_error(np.array([5]), np.array([2]), np.ones((1, 1), dtype=bool))
    np.testing.assert_allclose([rmse, rmse_columns], 3.0, rtol=1e-14)


def test_uniform_error_by_hand() -> None:
    # The weights add up to 1 and reflection loses nothing: an error of 2 everywhere stays 2.
    everywhere = np.ones((9, 11), dtype=bool)
    errors = model_error(np.full(99, 2), np.zeros(99, dtype=int), everywhere)
    np.testing.assert_allclose(errors, 2.0, rtol=1e-13)


def test_land_counts_in_the_columns_only() -> None:
    # One node alone between two land rows: rmse is the centre weight w0 of a 3 x 1 map after
    # reflection, the column error averages the squares of all three rows.
    navigable = np.array([[False], [True], [False]])
    rmse, rmse_columns = model_error(np.array([1]), np.array([0]), navigable)
    column = gaussian_filter(np.array([[0.0], [1.0], [0.0]]), 1.0)[:, 0]
    np.testing.assert_allclose(rmse, column[1], rtol=1e-13)
    np.testing.assert_allclose(rmse_columns, np.sqrt(np.sum(column**2) / 3), rtol=1e-13)
    assert rmse_columns < rmse


def test_same_bits_in_every_batch() -> None:
    truth, estimate, navigable = random_case(5, 30, 20, 0.1, batch=14)
    together = model_error(truth, estimate, navigable)
    folded = model_error(truth.reshape(2, 7, -1), estimate.reshape(2, 7, -1), navigable)
    turned = model_error(np.asfortranarray(truth), np.asfortranarray(estimate), navigable)
    for which in range(2):
        assert folded[which].shape == (2, 7)
        assert folded[which].ravel().tolist() == together[which].tolist()
        assert turned[which].tolist() == together[which].tolist()
        pairs = zip(truth, estimate, strict=True)
        alone = [float(model_error(*pair, navigable)[which]) for pair in pairs]
        assert alone == together[which].tolist()


def test_equal_maps_give_exact_zeros_beside_unequal_ones() -> None:
    truth, estimate, navigable = random_case(6, 8, 8, 0.5, batch=3)
    estimate[1] = truth[1]
    for errors in model_error(truth, estimate, navigable):
        assert errors[1] == 0.0
        assert errors[0] > 0.0
        assert errors[2] > 0.0


def test_large_map_with_few_differences() -> None:
    navigable = np.ones((1000, 1000), dtype=bool)
    truth = np.zeros(10**6, dtype=np.int32)
    truth[[0, 1001, 999_999, 500_123]] = [1, 2, 3, 4]
    estimate = np.zeros_like(truth)
    expected = oracle(truth.astype(float), estimate.astype(float), navigable)
    np.testing.assert_allclose(model_error(truth, estimate, navigable), expected, atol=1e-12)


GRID = np.ones((2, 3), dtype=bool)
SIX = np.zeros(6, dtype=int)


@pytest.mark.parametrize(
    ("truth", "estimate", "navigable", "message"),
    [
        (SIX, SIX, np.ones((2, 3), dtype=int), "booleans"),
        (SIX, SIX, np.ones(6, dtype=bool), "booleans"),
        (SIX, SIX, np.zeros((2, 3), dtype=bool), "no node"),
        (SIX[:5], SIX, GRID, "truth has shape"),
        (SIX, SIX[:5], GRID, "estimate has shape"),
        (np.zeros((2, 6)), np.zeros((3, 6)), GRID, "same shape"),
        (SIX.astype(complex), SIX, GRID, "complex128; real"),
        (SIX, np.full(6, np.nan), GRID, r"estimate\[0\] is nan"),
        (np.int64(3), SIX, GRID, "truth has shape"),
    ],
)
def test_rejects(truth: Any, estimate: Any, navigable: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        model_error(truth, estimate, navigable)
