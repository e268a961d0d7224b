"""Quays, piers, kerbs and buoys lie where the map has land and water."""

import itertools

import mujoco
import numpy as np
import pytest
import shapely

from mjforage.scenario.maps import load_map
from mjforage.view.render.scenery import BEYOND, add_scenery, buoy_places, land_of

PITCH = 4.0


def test_land_of_a_map_is_covered_and_its_kerb_is_higher() -> None:
    """Rays from above meet land and only land; the kerb stands along the water."""
    navigable = load_map("comb_port").navigable
    spec = mujoco.MjSpec()
    add_scenery(spec, navigable, PITCH)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    hit, down = np.zeros(1, np.int32), np.array([0.0, 0.0, -1.0])

    def height(row: float, column: float) -> float:
        above = np.array([PITCH * column, PITCH * (len(navigable) - 1 - row), 50.0])
        far = mujoco.mj_ray(model, data, above, down, None, 1, -1, hit)
        return 50.0 - far if far >= 0.0 else -np.inf

    for row, column in np.argwhere(~navigable)[::7]:
        assert height(row, column) == pytest.approx(0.6)
    for row, column in np.argwhere(navigable)[::7]:
        assert height(row, column) < 0.0
    row, column = np.argwhere(navigable[1:, 1:] & ~navigable[1:, :-1])[5] + 1
    assert height(row, column - 0.52) == pytest.approx(0.74), "at the western quay"
    assert height(1 - BEYOND, 40) == pytest.approx(0.6), "land goes on beyond the map"


def test_buoys_mark_water_at_the_edge_of_the_map() -> None:
    assert len(buoy_places(np.zeros((4, 4), np.bool_), PITCH)) == 0
    places = buoy_places(np.ones((4, 6), np.bool_), PITCH)
    on_side = (places[:, 0] == -2.0) | (places[:, 0] == 22.0)
    on_end = (places[:, 1] == -2.0) | (places[:, 1] == 14.0)
    assert (on_side | on_end).all()
    assert len(places) == 2 * 3 + 2 * 2


def test_land_follows_outlines() -> None:
    """In cells of half a metre: a slanted quay from edge to edge, and an island in the water."""
    quay = shapely.Polygon([(-2.0, -2.0), (30.0, -2.0), (30.0, 3.3), (-2.0, 9.1)])
    island = shapely.Polygon([(8.0, 15.0), (14.2, 16.0), (11.0, 20.7)])
    rings = [shapely.get_coordinates(one) for one in (quay, island)]
    edges = [(*a, *b) for ring in rings for a, b in itertools.pairwise(ring)]
    found = land_of(np.ones((6, 8), np.bool_), PITCH, np.array(edges, np.float32), 8)
    x, y = np.meshgrid((np.arange(64) + 0.5) * 0.5 - 2.0, (47.5 - np.arange(48)) * 0.5 - 2.0)
    expected = shapely.contains_xy(shapely.union_all([quay, island]), x, y)
    np.testing.assert_array_equal(found, expected)
