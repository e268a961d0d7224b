import numpy as np
import pytest
from scipy.sparse import csgraph

from mjforage.base import row_cache
from mjforage.graph_planner.graph.geodesics import (
    DistanceRows,
    Workspace,
    distances_of,
    distances_to_nearest,
)
from mjforage.graph_planner.graph.navigation import (
    COMPASS,
    OFFSETS,
    NavigationGraph,
    navigation_graph,
)
from tests.graph_planner.charts import grid


def node(graph: NavigationGraph, row: int, col: int) -> int:
    return int(graph.node_of_cell[row, col])


def test_compass_moves_point_where_their_names_say() -> None:
    by_name = dict(zip(COMPASS, OFFSETS.tolist(), strict=True))
    assert by_name["N"] == [-1, 0] and by_name["SE"] == [1, 1] and by_name["stay"] == [0, 0]


def test_corner_cutting_decides_about_diagonals_beside_land() -> None:
    cells = grid(".#", "..")
    cut, kept = (navigation_graph(cells, 1.0, cutting) for cutting in (True, False))
    start, end = node(cut, 0, 0), node(cut, 1, 1)
    assert cut.neighbours[start].tolist() == [-1, -1, -1, end, node(cut, 1, 0), -1, -1, -1]
    assert kept.neighbours[start].tolist() == [-1, -1, -1, -1, node(cut, 1, 0), -1, -1, -1]
    assert cut.distances[start, end] == pytest.approx(2**0.5)
    assert kept.distances[start, end] == 2.0


@pytest.mark.parametrize("cutting", [True, False])
def test_distances_agree_with_scipy(ragged_coast: NavigationGraph, cutting: bool) -> None:
    graph = navigation_graph(ragged_coast.navigable, 1.0, cutting)
    exact = csgraph.dijkstra(graph.edges)
    np.testing.assert_allclose(graph.distances, exact, rtol=1e-6, atol=1e-6)


def test_unreachable_nodes_are_infinitely_far() -> None:
    graph = navigation_graph(grid(".#."), 1.0, False)
    assert np.isinf(graph.distances[0, 1])
    assert np.isinf(graph.distances_from(np.array([0], np.int32))[1])


def test_equal_distances_compare_equal(open_water: NavigationGraph) -> None:
    """Sums of 1 and sqrt(2) in any order: 5 straight and 3 diagonal steps everywhere the same."""
    rows, cols = open_water.rows, open_water.cols
    d_row, d_col = (np.abs(v[:, None] - v[None, :]) for v in (rows, cols))
    shorter, longer = np.minimum(d_row, d_col), np.maximum(d_row, d_col)
    assert np.unique(open_water.distances[(shorter == 3) & (longer == 8)]).size == 1


def test_table_and_search_find_the_same_nearest_source(
    ragged_coast: NavigationGraph,
) -> None:
    graph, rng = ragged_coast, np.random.default_rng(0)
    workspace = Workspace.of(len(graph))
    no_table = np.empty((0, 0), np.float32)
    for _ in range(50):
        sources = rng.choice(len(graph), rng.integers(1, 30), replace=False).astype(np.int32)
        centres = rng.choice(len(graph), 3).astype(np.int32)
        targets = np.concatenate((graph.neighbours[centres], centres[:, None]), axis=1)
        found = [np.empty((3, 9)) for _ in range(2)]
        for table, out in zip((graph.distances, no_table), found, strict=True):
            distances_to_nearest(
                *(graph.neighbours, table, sources, centres, targets, 1.5),
                *(workspace, out),
            )
        expected = np.where(
            targets < 0,
            np.inf,
            graph.distances[np.ix_(sources, targets.ravel())].min(0).reshape(3, 9),
        )
        np.testing.assert_array_equal(found[0], expected)
        np.testing.assert_allclose(found[1], expected, rtol=1e-5)
        assert np.isinf(workspace.distance).all()


def test_rows_of_distances_make_room_for_one_another(
    monkeypatch: pytest.MonkeyPatch, ragged_coast: NavigationGraph
) -> None:
    """The same distances whether kept, searched again or taken from the table."""
    monkeypatch.setattr(row_cache, "FEWEST_ROWS", 3)
    monkeypatch.setattr(row_cache, "MEMORY", 0)
    rows, workspace = DistanceRows.none_yet(len(ragged_coast)), Workspace.of(len(ragged_coast))
    assert rows.distance.shape == (3, len(ragged_coast))
    for node_asked in (0, 5, 0, 9, 17, 0, 5, len(ragged_coast) - 1, 17):
        row = distances_of(rows, ragged_coast.neighbours, node_asked, workspace)
        np.testing.assert_array_equal(row, ragged_coast.distances[node_asked])
        assert (rows.cache.slot >= 0).sum() == (rows.cache.owner >= 0).sum()
    table = ragged_coast.distance_rows
    assert np.shares_memory(table.distance, ragged_coast.distances)


def test_a_scout_sees_49_nodes_in_open_water_and_a_forager_5(open_water: NavigationGraph) -> None:
    views = open_water.views((1.0, 4.0))
    middle = node(open_water, 7, 7)
    assert views.of(middle, 0).size == 5
    assert views.of(middle, 1).size == 49
    seen = open_water.rows[views.of(middle, 1)] - 7, open_water.cols[views.of(middle, 1)] - 7
    assert max(r * r + c * c for r, c in zip(*seen, strict=True)) == 16


def test_land_hides_what_lies_behind_it() -> None:
    graph = navigation_graph(grid(".....", "..#..", "....."), 1.0, True)
    seen = set(graph.views((4.0,)).of(node(graph, 1, 1)).tolist())
    assert node(graph, 1, 3) not in seen and node(graph, 1, 4) not in seen
    assert {node(graph, 0, 2), node(graph, 2, 2), node(graph, 0, 3)} <= seen
    behind = set(graph.discs((4.0,)).of(node(graph, 1, 1)).tolist())
    assert behind == set(range(len(graph)))


def test_views_agree_with_walking_every_line(ragged_coast: NavigationGraph) -> None:
    """Oracle: sample the line densely enough, round halves away from the viewer, look for land."""
    graph, views = ragged_coast, ragged_coast.views((3.5,))
    for viewer in range(0, len(graph), 7):
        row, col = int(graph.rows[viewer]), int(graph.cols[viewer])
        expected = set()
        for other in range(len(graph)):
            d_row, d_col = int(graph.rows[other]) - row, int(graph.cols[other]) - col
            if d_row**2 + d_col**2 > 3.5**2:
                continue
            n = max(abs(d_row), abs(d_col), 1)
            line = [
                [int(np.sign(d) * np.floor(abs(d) * k / n + 0.5)) for d in (d_row, d_col)]
                for k in range(n + 1)
            ]
            if all(graph.navigable[row + r, col + c] for r, c in line):
                expected.add(other)
        assert set(views.of(viewer).tolist()) == expected


def test_metres_are_east_and_north_and_come_back() -> None:
    graph = navigation_graph(np.ones((3, 5), np.bool_), 4.0, False)
    corner = graph.metres(np.array([2.0, 0.0]))
    assert corner.tolist() == [0.0, 0.0]  # the south-west cell
    assert graph.metres(np.array([0.0, 4.0])).tolist() == [16.0, 8.0]
    rc = np.random.default_rng(0).uniform(0, 3, (7, 2))
    np.testing.assert_allclose(graph.row_column(graph.metres(rc)), rc)


def test_a_corner_is_one_whose_three_other_cells_are_all_land() -> None:
    graph = navigation_graph(grid("..#", "...", "##."), 1.0, False)
    corners = {
        (int(r), int(c)): found.tolist()
        for r, c, found in zip(graph.rows, graph.cols, graph.corners, strict=True)
    }
    assert corners[0, 0] == [True, False, False, False]  # the map's north-west corner
    assert corners[0, 1] == [False, True, False, False]  # land to the east, the edge above
    assert corners[1, 0] == [False, False, True, False]
    assert corners[1, 1] == [False] * 4
    assert corners[2, 2] == [False, False, True, True]  # land to the west, and below
