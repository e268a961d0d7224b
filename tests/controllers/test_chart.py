import math

import numpy as np
import pytest

from mjforage.controllers import Chart
from mjforage.controllers.chart import quay_gap
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
    open_water = np.zeros((0, 0), np.bool_)
    assert quay_gap(open_water, 4.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.5, 3.0) == 3.0
