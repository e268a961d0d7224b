import math

import numpy as np
import pytest

from mjforage.controllers import Chart
from mjforage.controllers.chart import OPEN_WATER, WALL_M, is_land, quay_gap
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
