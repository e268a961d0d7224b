import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.graph_planner.belief_planner.covers import hotspot_cover, landmarks_of, view_cover
from mjforage.graph_planner.belief_planner.settings import BeliefSettings
from mjforage.graph_planner.belief_planner.sweeps import (
    LONGEST,
    SEEN,
    Cover,
    _marks,
    _rest,
    lateness,
    search_sweep,
    sight,
    until_seen,
)
from mjforage.graph_planner.belief_planner.ways import UNREACHED, ways_of
from mjforage.graph_planner.graph.navigation import NavigationGraph, navigation_graph
from mjforage.mission.moves import MoveRules
from mjforage.scenario.roles import Role
from tests.graph_planner.driver import task_of

N, NE, E, SE, S, SW, W, NW = range(8)
SEA = navigation_graph(np.ones((41, 41), np.bool_), 1.0, False)
COVER = view_cover(SEA, (2.0,), 0, 1, MoveRules(True, True))
ENDS = ways_of(SEA, 1, MoveRules(True, True)).ends


def swept(
    mass: NDArray[np.float64],
    start: tuple[int, int] = (20, 20),
    depth: int = 8,
    elsewhere: NDArray[np.float64] | None = None,
    cover: Cover = COVER,
    beam: int = 24,
    whole: bool = True,
    discount: float = 1.0,
) -> tuple[NDArray[np.float64], list[tuple[int, int]]]:
    """Preferences and the planned cells."""
    marks = cover.decisions.shape[1]
    others = np.full(marks, LONGEST) if elsewhere is None else elsewhere
    preferences, path = np.zeros(9), np.zeros(depth, np.int32)
    at = int(SEA.node_of_cell[start])
    scratch = sight(mass.size)
    effort = beam, depth, whole
    late = lateness(discount)
    n = search_sweep(ENDS, cover, at, mass, others, late, *effort, scratch, preferences, path)
    return preferences, [(int(SEA.rows[v]), int(SEA.cols[v])) for v in path[:n]]


def mass_at(*cells: tuple[int, int]) -> NDArray[np.float64]:
    mass = np.zeros(len(SEA))
    mass[[SEA.node_of_cell[cell] for cell in cells]] = 1.0
    return mass


@pytest.mark.parametrize("discount", [1.0, 0.9])
def test_what_is_left_is_charged_by_when_it_can_be_seen(discount: float) -> None:
    """By this scout from where its plan ends or by another, whoever comes first."""
    rng, late, k = np.random.default_rng(0), lateness(discount), 4
    for n in (0, 1, 7, 64):
        decisions = rng.choice([0, 1, 20, int(UNREACHED)], 100).astype(np.uint16)
        marks, elsewhere = rng.permutation(100)[:n], rng.choice([2, 12, int(LONGEST)], n)
        left = rng.choice([0.0, 0.9 * SEEN, 1.5], n)
        own = np.where(decisions == UNREACHED, LONGEST, k + np.maximum(1, decisions.astype(int)))
        when = np.minimum(own[marks], elsewhere).astype(int)
        about = marks.astype(np.int32), left, elsewhere.astype(np.int32), late
        price = 3.0
        for i in np.flatnonzero(left > SEEN):
            price += left[i] * late[when[i]]
        assert _rest(k, decisions, *about, 3.0) == price


def test_landmarks_without_mass_are_left_out() -> None:
    marks, mass = COVER.decisions.shape[1], np.zeros(len(SEA))
    seen, alone = int(COVER.landmark[0]), int(COVER.landmark[len(SEA) - 1])
    mass[0], mass[len(SEA) - 1] = 2.0, SEEN / 2
    found = _marks(COVER, mass, np.arange(marks, dtype=float))
    assert found.landmark.tolist() == [seen] and found.mass.tolist() == [2.0]
    assert found.elsewhere.tolist() == [seen] and seen != alone
    assert found.place[seen] == 0 and (np.delete(found.place, seen) == 1).all()


def test_a_scout_sees_the_only_mass_as_soon_as_can_be() -> None:
    for cell, decisions in (((20, 27), 5), ((13, 20), 5), ((26, 26), 5), ((20, 23), 1)):
        _, path = swept(mass_at(cell))
        sees = [(r - cell[0]) ** 2 + (c - cell[1]) ** 2 <= 4 for r, c in path]
        assert sees.index(True) + 1 == decisions


def test_mass_that_another_scout_sees_sooner_does_not_pull() -> None:
    mass = mass_at((20, 35), (20, 8))
    alone, _ = swept(mass + 0.2 * mass_at((20, 35)), depth=3)
    assert int(alone.argmax()) in (NE, E, SE)
    elsewhere = np.full(COVER.decisions.shape[1], LONGEST)
    until_seen(COVER, int(SEA.node_of_cell[20, 36]), 0.0, elsewhere)
    shared, _ = swept(mass + 0.2 * mass_at((20, 35)), depth=3, elsewhere=elsewhere)
    assert int(shared.argmax()) in (SW, W, NW)


def test_between_two_equal_masses_far_apart_only_a_discount_makes_it_go_to_one() -> None:
    """Beside the first step of a way is a crumb on the other side: it decides without discount."""
    mass = mass_at((20, 40), (20, 0)) + 0.001 * mass_at((20, 17))
    for start, discount, moves in (((20, 21), 1.0, (SW, W, NW)), ((20, 21), 0.9, (NE, E, SE))):
        preferences, _ = swept(mass, start=start, depth=3, discount=discount)
        assert int(preferences.argmax()) in moves


@pytest.mark.parametrize("discount", [1.0, 0.97, 0.5])
def test_lateness_is_the_sum_of_the_weights_of_all_decisions_until_then(discount: float) -> None:
    late = lateness(discount)
    assert late.size == LONGEST + 1 and late[0] == 0.0
    for k in (1, 2, 7, 30):
        assert late[k] == pytest.approx(sum(discount**i for i in range(k)))
    if discount == 1.0:
        np.testing.assert_array_equal(late, np.arange(LONGEST + 1))


def plainly_swept(
    mass: NDArray[np.float64], at: int, beam: int, depth: int, discount: float
) -> list[int]:
    """Nodes of the best plan by a beam search over lists, with all that each place shows."""
    marks = COVER.decisions.shape[1]
    left = np.bincount(COVER.landmark, mass, marks).astype(np.float64)
    kept: list[tuple[float, float, list[int], frozenset[int], NDArray[np.float64]]]
    kept, late = [(0.0, 0.0, [at], frozenset(), left)], lateness(discount)
    for k in range(1, depth + 1):
        after: list[tuple[float, float, list[int], frozenset[int], NDArray[np.float64]]] = []
        for _, paid, nodes, seen, before in kept:
            for end in ENDS[nodes[-1]][ENDS[nodes[-1]] >= 0].tolist():
                cells = COVER.cells[COVER.start[end] : COVER.start[end + 1]]
                fresh = [int(c) for c in cells if int(c) not in seen]
                rest, got = before.copy(), 0.0
                for cell in fresh:
                    got += mass[cell]
                    rest[COVER.landmark[cell]] -= mass[cell]
                price = paid + got * late[k]
                for mark in np.flatnonzero(rest > 1e-9):
                    price += rest[mark] * late[k + max(1, int(COVER.decisions[end, mark]))]
                twin = any(
                    other[2][-1] == end and abs(other[0] - price) <= 1e-9 * price for other in after
                )
                if not twin and (len(after) < beam or price < after[-1][0]):
                    plan = price, paid + got * late[k], [*nodes, end], seen | set(fresh), rest
                    after = sorted([*after, plan], key=lambda one: one[0])[:beam]
        kept = after
    return kept[0][2][1:]


def scattered(seed: int) -> NDArray[np.float64]:
    """Mass on a fifth of the nodes near (20, 20)."""
    rng = np.random.default_rng(seed)
    near = np.maximum(np.abs(SEA.rows - 20), np.abs(SEA.cols - 20)) <= 9
    return np.where(near & (rng.random(len(SEA)) < 0.2), rng.uniform(0.0, 1.0, len(SEA)), 0.0)


@pytest.mark.parametrize("discount", [1.0, 0.9])
@pytest.mark.parametrize("seed", range(6))
def test_the_search_is_a_plain_beam_search(seed: int, discount: float) -> None:
    mass, at = scattered(seed), int(SEA.node_of_cell[20, 20])
    _, path = swept(mass, beam=5, depth=6, discount=discount)
    nodes = plainly_swept(mass, at, 5, 6, discount)
    assert path == [(int(SEA.rows[v]), int(SEA.cols[v])) for v in nodes]


def test_a_search_that_ends_early_begins_as_the_whole_one_does() -> None:
    paths = []
    for seed in range(30):
        whole, _ = swept(scattered(seed), beam=4)
        early, path = swept(scattered(seed), beam=4, whole=False)
        np.testing.assert_array_equal(early, whole)
        paths.append(len(path))
    assert min(paths) < 8  # it does end early


def test_covers_list_what_a_move_newly_shows(ragged_coast: NavigationGraph) -> None:
    cover = view_cover(ragged_coast, (1.0, 4.0), 1, 2, MoveRules(True, True))
    ends = ways_of(ragged_coast, 2, MoveRules(True, True)).ends

    def cells_of(v: int) -> list[int]:
        return [int(c) for c in cover.cells[cover.start[v] : cover.start[v + 1]]]

    for v in (0, 57, len(ragged_coast) - 1):
        before = cells_of(v)
        for move in range(9):
            first, last = cover.fresh_start[9 * v + move : 9 * v + move + 2]
            after = cells_of(ends[v, move]) if ends[v, move] >= 0 else []
            assert cover.fresh[first:last].tolist() == [c for c in after if c not in before]


def test_landmarks_are_spread_out_and_share_the_nodes() -> None:
    marks, belongs = landmarks_of(SEA)
    assert len(set(marks.tolist())) == marks.size
    assert (belongs[marks] == np.arange(marks.size)).all()
    away = np.abs(SEA.rows - SEA.rows[marks[belongs]]) + np.abs(SEA.cols - SEA.cols[marks[belongs]])
    assert away.max() < 14


def test_covers_count_decisions_until_a_landmark_is_in_view(
    ragged_coast: NavigationGraph,
) -> None:
    cover = view_cover(ragged_coast, (1.0, 4.0), 1, 2, MoveRules(True, True))
    marks, _ = landmarks_of(ragged_coast)
    views = ragged_coast.views((4.0,))
    for i in (0, 3, 11):
        sees = np.array([marks[i] in views.of(v) for v in range(len(ragged_coast))])
        np.testing.assert_array_equal(cover.decisions[:, i] == 0, sees)


def test_a_hotspot_is_noticed_from_farther_than_a_node_is_seen() -> None:
    """75 items around (20, 20): a scout of radius 4 notices the prior from its fringe."""
    task = task_of(SEA, scouts=Role(1, 2, 4.0, False))
    blocks = hotspot_cover(task, 0, BeliefSettings())
    middle = blocks.block[SEA.node_of_cell[20, 20]]

    def notices(row: int, col: int, found: Cover = blocks.cover) -> bool:
        v = SEA.node_of_cell[row, col]
        return bool(middle in found.cells[found.start[v] : found.start[v + 1]])

    assert notices(20, 20) and notices(20, 29) and not notices(20, 36)
    fewer = hotspot_cover(task, 0, BeliefSettings(items=10.0, items_sd=3.0)).cover
    assert notices(20, 22, fewer) and not notices(20, 29, fewer)
