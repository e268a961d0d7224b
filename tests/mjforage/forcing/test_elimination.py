"""Elimination by elements against a sparse solver; a piece of land is one unknown."""

import numpy as np
import pytest
from scipy import sparse
from scipy.sparse.linalg import splu

from mjforage.forcing.elimination import IntArray, _eliminate, least_of_elements
from mjforage.forcing.stream_element import EAST, NORTH, FloatArray
from mjforage.forcing.stream_solver import shore_unknowns, stream_functions
from mjforage.scenario.maps import load_map


def by_sparse_solver(places: IntArray, matrix: FloatArray, loads: FloatArray) -> FloatArray:
    """The same least from an assembled matrix."""
    count = places.max() + 1
    kept = np.where(places < 0, count, places)
    size = places.shape[1]
    pairs = np.repeat(kept, size, axis=1).ravel(), np.tile(kept, (1, size)).ravel()
    whole = sparse.coo_array((np.tile(matrix.ravel(), len(places)), pairs), (count + 1,) * 2)
    work = np.zeros((count + 1, loads.shape[1]))
    np.add.at(work, kept, loads)
    return np.asarray(splu(whole.tocsc()[:count, :count]).solve(work[:count]))


@pytest.mark.parametrize("layer", [0.0, 1.5, 30.0])
@pytest.mark.parametrize("port", ["comb_port", "channels"])
def test_streams_are_those_of_a_sparse_solver(
    port: str, layer: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    water = load_map(port).navigable
    unknown, forces = shore_unknowns(water), np.stack((EAST, NORTH), axis=1)
    found = stream_functions(water, unknown, layer, forces)
    solver = "mjforage.forcing.stream_solver.least_of_elements"
    monkeypatch.setattr(solver, lambda places, _, *rest: by_sparse_solver(places, *rest))
    true = stream_functions(water, unknown, layer, forces)
    np.testing.assert_allclose(found, true, rtol=0.0, atol=1e-10 * np.abs(true).max())


@pytest.mark.parametrize("seed", range(4))
def test_elements_may_have_an_unknown_twice_or_none(seed: int) -> None:
    rng = np.random.default_rng(seed)
    places = rng.integers(-1, 40, (120, 5))
    places[0] = -1
    corners = rng.integers(0, 30, (120, 2))
    half = rng.normal(size=(5, 5))
    matrix, loads = half @ half.T + np.eye(5), rng.normal(size=(5, 3))
    found = least_of_elements(places, corners, matrix, loads)
    true = by_sparse_solver(places, matrix, loads)
    np.testing.assert_allclose(found, true, rtol=0.0, atol=1e-10 * np.abs(true).max())


@pytest.mark.parametrize(("size", "own"), [(1, 1), (7, 3), (33, 33), (130, 61), (600, 250)])
def test_tiles_change_no_bit(size: int, own: int) -> None:
    """Each number has its differences in the order of the rows, wherever tiles end."""
    drawn = np.random.default_rng(size).normal(size=(size, size + 2))
    rows = np.hstack((drawn[:, :size] @ drawn[:, :size].T + size * np.eye(size), drawn[:, size:]))
    plain = rows.copy()
    for p in range(own):
        below = slice(p + 1, None)
        away = np.outer(plain[p, below][: size - p - 1] / plain[p, p], plain[p, below])
        plain[below, below] -= away
    _eliminate(rows, own)
    upper = np.triu(np.ones(rows.shape, np.bool_))
    assert (rows[upper] == plain[upper]).all()
