import numpy as np
import pytest

from mjforage.graph_planner.belief_planner.boundary import boundary_of, drifted
from mjforage.graph_planner.graph.navigation import navigation_graph
from tests.graph_planner.charts import grid

MAP = navigation_graph(grid("..##....", ".###..#.", "....#...", "##......"), 1.0, False)
BOUNDARY = boundary_of(MAP)


def test_drift_goes_along_a_quay_and_not_through_a_pier() -> None:
    """South-east of (0, 0) is land: the item slides down and then into the bay, step by step."""
    row, col, node = drifted(BOUNDARY, 0.0, 1.0, 0.0, 0.1, 40)
    assert (row, node) == (0.0, MAP.node_of_cell[0, 1]) and col == pytest.approx(1.49)
    row, col, node = drifted(BOUNDARY, 0.0, 0.0, 0.1, 0.0, 100)
    assert node == MAP.node_of_cell[2, 0] and row == pytest.approx(2.49)
    assert drifted(BOUNDARY, 2.2, 6.1, -0.1, 0.1, 3.0)[:2] == pytest.approx((1.9, 6.51), abs=0.4)


def test_free_drift_is_a_straight_line() -> None:
    open_water = boundary_of(navigation_graph(np.ones((30, 30), np.bool_), 1.0, False))
    assert drifted(open_water, 3.2, 4.1, 0.07, 0.11, 90)[:2] == pytest.approx((9.5, 14.0))


def test_rooms_are_free_cells_to_the_walls() -> None:
    node = MAP.node_of_cell[2, 2]
    assert BOUNDARY.room[node].tolist() == [[0, 1], [2, 1]]
