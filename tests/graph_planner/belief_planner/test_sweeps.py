import numpy as np
from numpy.typing import NDArray

from graph_planner.belief_planner.covers import hotspot_cover, landmarks_of, view_cover
from graph_planner.belief_planner.sweeps import LONGEST, Cover, search_sweep, sight, until_seen
from graph_planner.belief_planner.ways import ways_of
from graph_planner.belief_settings import BeliefSettings
from graph_planner.fleet import Role
from graph_planner.navigation import NavigationGraph, navigation_graph
from tests.graph_planner.driver import task_of

N, NE, E, SE, S, SW, W, NW = range(8)
SEA = navigation_graph(np.ones((41, 41), np.bool_), 1.0, False)
COVER = view_cover(SEA, (2.0,), 0, 1, True, True)
ENDS = ways_of(SEA, 1, True, True).ends


def swept(
    mass: NDArray[np.float64],
    start: tuple[int, int] = (20, 20),
    depth: int = 8,
    elsewhere: NDArray[np.float64] | None = None,
    cover: Cover = COVER,
    beam: int = 24,
) -> tuple[NDArray[np.float64], list[tuple[int, int]]]:
    """Preferences and the planned cells."""
    marks = cover.decisions.shape[1]
    others = np.full(marks, LONGEST) if elsewhere is None else elsewhere
    preferences, path = np.zeros(9), np.zeros(depth, np.int32)
    at = int(SEA.node_of_cell[start])
    scratch = sight(mass.size)
    n = search_sweep(ENDS, cover, at, mass, others, beam, depth, scratch, preferences, path)
    return preferences, [(int(SEA.rows[v]), int(SEA.cols[v])) for v in path[:n]]


def mass_at(*cells: tuple[int, int]) -> NDArray[np.float64]:
    mass = np.zeros(len(SEA))
    mass[[SEA.node_of_cell[cell] for cell in cells]] = 1.0
    return mass


def test_a_scout_sees_the_only_mass_as_soon_as_can_be() -> None:
    for cell, decisions in (((20, 27), 5), ((13, 20), 5), ((26, 26), 5), ((20, 23), 1)):
        _, path = swept(mass_at(cell))
        sees = [(r - cell[0]) ** 2 + (c - cell[1]) ** 2 <= 4 for r, c in path]
        assert sees.index(True) + 1 == decisions


def test_what_is_beyond_the_plan_still_pulls() -> None:
    preferences, _ = swept(mass_at((20, 40)), depth=3)
    assert int(preferences.argmax()) in (NE, E, SE)


def test_seeing_the_same_again_counts_once() -> None:
    """Two masses in view of one place, one elsewhere: the plan does not stay with the two."""
    _, path = swept(mass_at((20, 23), (19, 23), (20, 12)), depth=12)
    assert path[0][1] == 21 and min(col for _, col in path) <= 14


def test_the_nearer_of_two_equal_masses_comes_first() -> None:
    _, path = swept(mass_at((20, 25), (20, 13)), depth=14, beam=200)
    sees = [[(r - 20) ** 2 + (c - col) ** 2 <= 4 for r, c in path] for col in (25, 13)]
    near, far = (which.index(True) + 1 for which in sees)
    assert near == 3 and far <= 13


def test_mass_that_another_scout_sees_sooner_does_not_pull() -> None:
    mass = mass_at((20, 35), (20, 8))
    alone, _ = swept(mass + 0.2 * mass_at((20, 35)), depth=3)
    assert int(alone.argmax()) in (NE, E, SE)
    elsewhere = np.full(COVER.decisions.shape[1], LONGEST)
    until_seen(COVER, int(SEA.node_of_cell[20, 36]), 0.0, elsewhere)
    shared, _ = swept(mass + 0.2 * mass_at((20, 35)), depth=3, elsewhere=elsewhere)
    assert int(shared.argmax()) in (SW, W, NW)


def test_illegal_moves_are_never_preferred() -> None:
    preferences, _ = swept(mass_at((5, 5)), start=(0, 0))
    assert np.isneginf(preferences[[N, NE, SW, W, NW]]).all()


def test_landmarks_are_spread_out_and_share_the_nodes() -> None:
    marks, belongs = landmarks_of(SEA)
    assert len(set(marks.tolist())) == marks.size
    assert (belongs[marks] == np.arange(marks.size)).all()
    away = np.abs(SEA.rows - SEA.rows[marks[belongs]]) + np.abs(SEA.cols - SEA.cols[marks[belongs]])
    assert away.max() < 14


def test_covers_count_decisions_until_a_landmark_is_in_view(
    ragged_coast: NavigationGraph,
) -> None:
    cover = view_cover(ragged_coast, (1.0, 4.0), 1, 2, True, True)
    marks, _ = landmarks_of(ragged_coast)
    views = ragged_coast.views((4.0,))
    for i in (0, 3, 11):
        sees = np.array([marks[i] in views.of(v) for v in range(len(ragged_coast))])
        np.testing.assert_array_equal(cover.decisions[:, i] == 0, sees)


def test_a_hotspot_is_noticed_from_farther_than_a_node_is_seen() -> None:
    """75 items around (20, 20): a scout of radius 4 notices the cloud from its fringe."""
    task = task_of(SEA, scouts=Role(1, 2, 4.0, False))
    blocks = hotspot_cover(task, 0, BeliefSettings())
    middle = blocks.block[SEA.node_of_cell[20, 20]]

    def notices(row: int, col: int, found: Cover = blocks.cover) -> bool:
        v = SEA.node_of_cell[row, col]
        return bool(middle in found.cells[found.start[v] : found.start[v + 1]])

    assert notices(20, 20) and notices(20, 29) and not notices(20, 36)
    fewer = hotspot_cover(task, 0, BeliefSettings(items=10.0, items_sd=3.0)).cover
    assert notices(20, 22, fewer) and not notices(20, 29, fewer)
