import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from mjforage.base.compiled import kernel
from mjforage.base.randomness import episode_keys
from mjforage.graph_planner.graph.navigation import Water, navigation_graph
from mjforage.graph_planner.graph.walls import WALLS, into_water
from mjforage.mission.initial_state import (
    create_initial_state,
    item_places,
    nodes_around,
)
from mjforage.scenario.scenario import Items, Weather

KEYS = episode_keys(0, np.arange(3000))
NOBODY = np.empty(0, np.int32)
OPEN = navigation_graph(np.ones((60, 60), np.bool_), 4.0, False)


@kernel
def pushed(water: Water, row: float, col: float, walls: int = 0) -> tuple[float, float, int]:
    return into_water(water, walls, row, col)


def test_counts_hotspots_and_drift_have_their_distributions() -> None:
    starts = np.arange(4, dtype=np.int32)
    world = create_initial_state(OPEN, Items(), Weather(), 0.4, starts, 4, KEYS)
    assert abs(world.n_items.mean() - 75) < 1 and abs(world.n_items.std() - 10) < 0.6
    for axis in range(2):
        assert stats.kstest(world.drift_rc[:, axis], "uniform", (-0.1, 0.2)).pvalue > 0.01
    exists = np.arange(world.item_rc.shape[1])[None, :] < world.n_items[:, None]
    centres = np.array([rc[e].mean(axis=0) for rc, e in zip(world.item_rc, exists, strict=True)])
    inland = (centres > 18).all(axis=1) & (centres < 41).all(axis=1)
    scatter = np.concatenate(
        [world.item_rc[i][exists[i]] - centres[i] for i in np.flatnonzero(inland)]
    )
    covariance = np.cov(scatter.T) * 75 / 74
    np.testing.assert_allclose(covariance, 20 * np.eye(2), atol=0.5)
    assert stats.kstest(centres[inland][:, 0], "uniform", (18, 23)).pvalue > 0.001


def test_there_is_always_an_item() -> None:
    world = create_initial_state(
        OPEN, Items(mean=0.0, std=0.5), Weather(), 0.4, KEYS[:0].astype(np.int32), 1, KEYS
    )
    assert world.n_items.min() == 1


@given(
    cells=st.lists(st.integers(0, 2**12 - 1), min_size=1, max_size=12).filter(any),
    row=st.floats(-30, 40),
    col=st.floats(-30, 40),
)
def test_items_are_pushed_to_the_nearest_node_like_by_brute_force(
    cells: list[int], row: float, col: float
) -> None:
    navigable = np.array([[bool(line >> i & 1) for i in range(12)] for line in cells])
    graph = navigation_graph(navigable, 1.0, True)
    found_row, found_col, node = pushed(graph.water, row, col)
    r, c = int(np.floor(row + 0.5)), int(np.floor(col + 0.5))
    inside = 0 <= r < len(cells) and 0 <= c < 12
    if inside and navigable[r, c]:
        assert (found_row, found_col, node) == (row, col, graph.node_of_cell[r, c])
        return
    row, col = float(np.clip(row, 0, len(cells) - 1)), float(np.clip(col, 0, 11))
    squared = (graph.rows - row) ** 2 + (graph.cols - col) ** 2
    assert squared[node] <= squared.min() + 1e-12
    assert node == np.flatnonzero(squared <= squared.min())[0] or squared[node] == squared.min()
    assert abs(found_row - graph.rows[node]) <= 0.49 + 1e-9
    assert abs(found_col - graph.cols[node]) <= 0.49 + 1e-9


@pytest.mark.parametrize(
    ("offset", "clip", "project", "published"),
    [
        ((0.7, 0.3), (0.49, 0.3), (0.49, 0.21), (0.49, 0.21)),
        ((-0.7, -0.3), (-0.49, -0.3), (-0.49, -0.21), (-0.49, -0.21)),
        ((-0.7, 0.3), (-0.49, 0.3), (-0.49, 0.21), (-0.49, -0.21)),  # the slip, on a column
        ((0.3, -0.7), (0.3, -0.49), (0.21, -0.49), (-0.21, -0.49)),  # the slip, on a row
        ((0.7, -0.3), (0.49, -0.3), (0.49, -0.21), (0.49, -0.21)),
        ((-0.3, 0.7), (-0.3, 0.49), (-0.21, 0.49), (-0.21, 0.49)),
        ((0.98, 1.4), (0.49, 0.49), (0.343, 0.49), (0.343, 0.49)),
        ((0.75, -0.75), (0.49, -0.49), (0.49, -0.49), (0.49, -0.49)),
        ((-0.75, 0.75), (-0.49, 0.49), (-0.49, 0.49), (-0.49, -0.49)),  # a corner, with the slip
        ((0.5, 0.0), (0.49, 0.0), (0.49, 0.0), (0.49, 0.0)),  # on the border
        ((0.4, -0.49), (0.4, -0.49), (0.4, -0.49), (0.4, -0.49)),  # within the square
    ],
)
def test_walls_put_an_item_back_as_they_say(
    offset: tuple[float, float],
    clip: tuple[float, float],
    project: tuple[float, float],
    published: tuple[float, float],
) -> None:
    navigable = np.zeros((5, 5), np.bool_)
    navigable[2, 2] = True
    water = navigation_graph(navigable, 1.0, True).water
    for name, expected in {"clip": clip, "project": project, "published": published}.items():
        row, col, node = pushed(water, 2.0 + offset[0], 2.0 + offset[1], WALLS.index(name))
        assert (row - 2.0, col - 2.0) == pytest.approx(expected, abs=1e-12), name
        assert node == 0


def test_an_item_beyond_the_map_stays_where_the_map_ends() -> None:
    for walls in range(len(WALLS)):
        assert pushed(OPEN.water, -3.0, 7.3, walls)[:2] == (0.0, 7.3)
        assert pushed(OPEN.water, 70.0, -0.6, walls)[:2] == (59.0, 0.0)


def test_a_tie_goes_to_the_lowest_row_major_node() -> None:
    graph = navigation_graph(np.array([[1, 0, 1], [0, 0, 0], [1, 0, 1]], np.bool_), 1.0, True)
    assert pushed(graph.water, 1.0, 1.0)[2] == 0
    far = np.zeros((9, 9), np.bool_)
    far[8, 0] = far[0, 8] = True
    graph = navigation_graph(far, 1.0, True)
    assert pushed(graph.water, 4.0, 4.0)[2] == 0


def test_starts_are_assigned_at_random_and_clusters_are_close_together() -> None:
    starts = np.array([0, 5, 100, 900], np.int32)
    listed = create_initial_state(OPEN, Items(), Weather(), 0.4, starts, 4, KEYS).agent_node
    assert (np.sort(listed, axis=1) == starts).all()
    assert np.bincount(listed[:, 0], minlength=901)[starts].min() > 600
    cluster = create_initial_state(
        OPEN, Items(), Weather(), 0.4, starts[:0], 4, KEYS[:200]
    ).agent_node
    rows, cols = OPEN.rows[cluster], OPEN.cols[cluster]
    assert (np.ptp(rows, axis=1) <= 2).all() and (np.ptp(cols, axis=1) <= 2).all()
    assert np.unique(rows[:, 0]).size > 40


def test_nodes_around_keeps_the_given_ones_first() -> None:
    around = nodes_around(OPEN, np.array([61], np.int32), 5)
    assert around.tolist() == [61, 1, 60, 62, 121]


def test_several_hotspots_share_the_items_and_one_is_the_default() -> None:
    starts = np.arange(4, dtype=np.int32)
    one, two = (
        create_initial_state(
            OPEN, Items(hotspots=n, covariance_node2=1.0), Weather(), 0.4, starts, 4, KEYS[:50]
        )
        for n in (1, 2)
    )
    np.testing.assert_array_equal(one.n_items, two.n_items)
    np.testing.assert_array_equal(one.item_rc[:, ::2], two.item_rc[:, ::2])
    inland = (one.item_rc[:, :30] > 5).all(axis=(1, 2)) & (one.item_rc[:, :30] < 54).all(
        axis=(1, 2)
    )
    assert inland.sum() > 10
    assert one.item_rc[inland, :40].std(axis=1).max() < 1.6
    apart = np.abs(two.item_rc[:, 0:40:2].mean(axis=1) - two.item_rc[:, 1:40:2].mean(axis=1))
    assert np.median(apart.max(axis=1)) > 10


def test_places_end_with_the_last_item() -> None:
    nodes = np.array([[2, 0, 2, -1], [-1, 1, -1, -1], [-1, -1, -1, -1]], np.int32)
    assert item_places(nodes).tolist() == [3, 2, 0]


def test_a_tie_of_far_nodes_goes_to_the_lowest_whichever_ring_it_is_in() -> None:
    navigable = np.zeros((12, 12), np.bool_)
    navigable[0, 5] = navigable[8, 9] = True  # both five nodes from (5, 5): rings 5 and 4
    water = navigation_graph(navigable, 1.0, False).water
    assert into_water(water, 0, 5.0, 5.0)[2] == 0


def test_a_drift_with_ranges_is_uniform_in_them_axis_by_axis() -> None:
    """And of the same draws as without: equal ranges of +-0.1 give the same drift."""
    ranges = Weather(drift_ranges_node_per_step=((0.01, 0.1), (-0.1, 0.1)))
    starts = np.arange(4, dtype=np.int32)
    plain, drawn = (
        create_initial_state(OPEN, Items(), weather, 0.4, starts, 4, KEYS).drift_rc
        for weather in (Weather(), ranges)
    )
    assert stats.kstest(drawn[:, 0], "uniform", (0.01, 0.09)).pvalue > 0.01
    assert drawn[:, 1].tobytes() == plain[:, 1].tobytes()
    np.testing.assert_allclose(drawn[:, 0], 0.055 + 0.45 * plain[:, 0], rtol=0, atol=1e-15)


def test_a_number_of_items_that_is_not_positive_becomes_the_given_one() -> None:
    common = OPEN, Items(mean=1.0, std=2.0), Weather(), 0.4, NOBODY, 1, KEYS[:300]
    plain = create_initial_state(*common).n_items
    other = create_initial_state(OPEN, Items(1.0, 2.0, otherwise=10), *common[2:]).n_items
    changed = np.flatnonzero(plain != other)
    assert (plain > 0).all() and (other > 0).all()
    assert 50 < changed.size < 150 and (plain[changed] == 1).all() and (other[changed] == 10).all()
