import math
from typing import Any, cast

import numpy as np
import pytest
import shapely

from mjforage.controllers import Chart
from mjforage.controllers.chart import (
    OPEN_WATER,
    WALL_M,
    cells_of,
    framed_is_land,
    has_walls,
    is_land,
    is_open,
    quay_gap,
    wall_at,
    walls_at,
)
from tests.graph_planner.charts import grid

CHART = Chart(grid("....", "..#.", "...."), 4.0)  # land around (8, 4)


def gap(x: float, y: float, yaw: float = 0.0, reach: float = 3.0) -> float:
    """Gap of a vessel of 2 x 1 m."""
    c, s = math.cos(yaw), math.sin(yaw)
    return quay_gap(CHART.land, CHART.pitch_m, x, y, c, s, 1.0, 0.5, reach)


def test_row_0_is_north() -> None:
    north = Chart(grid("#.", ".."), 4.0)
    assert quay_gap(north.land, 4.0, 4.0, 4.0, 1.0, 0.0, 1.0, 0.5, 3.0) == pytest.approx(1.0)
    assert quay_gap(north.land, 4.0, 4.0, 0.0, 1.0, 0.0, 1.0, 0.5, 3.0) == pytest.approx(1.0)
    assert quay_gap(north.land, 4.0, 0.0, 4.0, 1.0, 0.0, 1.0, 0.5, 3.0) < 0.0  # on land


def test_a_quay_ahead_and_beside() -> None:
    assert gap(4.0, 4.0) == pytest.approx(1.0)  # quay begins at x = 6
    assert gap(4.0, 4.0, math.pi / 2.0) == pytest.approx(1.5)
    assert gap(8.0, 0.0) == pytest.approx(1.5)  # quay begins at y = 2, the map ends at y = -2


def test_the_edge_of_the_map_is_a_quay() -> None:
    assert gap(0.0, 4.0) == pytest.approx(1.0)  # the map ends at x = -2
    assert gap(-1.5, 8.0) < 0.0


def test_nothing_within_reach() -> None:
    assert gap(4.0, 4.0, reach=0.5) == 0.5
    assert quay_gap(OPEN_WATER, 4.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.5, 3.0) == 3.0


def test_walls_that_reach_into_water_are_quays() -> None:
    """A wall at 45 degrees cuts the north-east corner off cell (1, 0), whose middle is (0, 4)."""
    wall = np.array([[1.0, 5.0, math.sqrt(0.5), -math.sqrt(0.5), 3.0]])
    chart = Chart(np.ones((4, 4), np.bool_), 4.0, wall)
    to_wall = math.sqrt(2.0) - WALL_M
    found = quay_gap(chart.land, 4.0, 0.0, 4.0, math.sqrt(0.5), math.sqrt(0.5), 0.5, 0.3, 3.0)
    assert found == pytest.approx(to_wall - 0.5)
    assert not is_land(chart.land, 4.0, 0.9, 4.9)
    assert is_land(chart.land, 4.0, 1.1, 5.1)
    bare = Chart(chart.navigable, 4.0).land
    assert not is_land(bare, 4.0, 1.1, 5.1)


def test_land_with_walls_is_one_array_that_tells_what_cells_and_walls_it_has() -> None:
    """Walls in random places: cells as without them, each with all walls within 0.25 m of it."""
    rng, water = np.random.default_rng(0), np.ones((5, 7), np.bool_)
    water[1:3, 2] = False
    turn = rng.uniform(0.0, 2.0 * np.pi, 9)
    middle, half = rng.uniform(0.0, [24.0, 16.0], (9, 2)), rng.uniform(0.1, 6.0, (9, 1))
    walls = np.hstack((middle, np.stack((np.cos(turn), np.sin(turn)), axis=1), half))
    bare, land = Chart(water, 4.0).land, Chart(water, 4.0, walls).land
    assert land.ndim == 1 and has_walls(land) and not has_walls(bare)
    np.testing.assert_array_equal(cells_of(land), bare)
    ends = np.stack([walls[:, :2] + side * half * walls[:, 2:4] for side in (-1, 1)], axis=1)
    lines = shapely.linestrings(ends)
    for i in range(9):
        for j in range(7):
            assert framed_is_land(land, i, j) == bare[i, j]
            x, y = 4.0 * (i - 1), 4.0 * (j - 1)
            near = shapely.intersects(lines, shapely.box(x - 2.25, y - 2.25, x + 2.25, y + 2.25))
            found = [wall_at(land, k) for k in cast(Any, walls_at).py_func(land, i, j)]
            np.testing.assert_array_equal(np.reshape(found, (-1, 5)), walls[near])
            assert is_open(land, i, j) == (not bare[i, j] and not near.any())
