"""Late looks: they are taken in at their own step, and change nothing that was seen since."""

import numpy as np
import pytest

from mjforage.graph_planner.belief_planner import late as lt
from mjforage.graph_planner.belief_planner import reconciling as rc
from mjforage.graph_planner.belief_planner import stragglers as st
from mjforage.graph_planner.belief_planner import tracks as tr
from mjforage.graph_planner.belief_planner.boundary import boundary_of
from mjforage.graph_planner.belief_planner.stragglers import stragglers
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.mission.task import NEVER
from tests.graph_planner.belief_planner.test_stragglers import BOUNDARY as WIDE_SHORE
from tests.graph_planner.belief_planner.test_stragglers import KEY, Search
from tests.graph_planner.belief_planner.test_stragglers import SEA as WIDE

SEA = navigation_graph(np.ones((12, 30), np.bool_), 1.0, False)
BOUNDARY = boundary_of(SEA)
EAST = np.array([0.0, 0.5])  # drift [node/step]
NOBODY = np.full(1, -1, np.int32)


class Past:
    """One episode's tracks, at step 10 with a drift to the east."""

    now = 10

    def __init__(self) -> None:
        self.tracks, self.particles = tr.tracks(1, 20), stragglers(1, len(SEA), 20, 1, 0.0)
        self.ways, self.lost, self.memory = tr.ended(90), tr.losses(20), rc.scratch(len(SEA))

    def track(self, row: float, col: float, seen: int) -> None:
        i = int(self.tracks.number[0])
        node = SEA.node_of_cell[round(row), round(col)]
        tr.begin(self.tracks, BOUNDARY, 0, node, seen, self.ways)
        self.tracks.row[0, i], self.tracks.col[0, i] = row, col

    def hear(
        self,
        step: int,
        counts: dict[tuple[int, int], int],
        in_view: list[tuple[int, int]],
        foragers_at: Int32Array = NOBODY,
    ) -> int:
        """A late look at some cells; how many new tracks stay."""
        belief, seen = np.zeros(len(SEA), np.int16), np.full(len(SEA), NEVER, np.int16)
        for cell in in_view:
            belief[SEA.node_of_cell[cell]] = counts.get(cell, 0)
            seen[SEA.node_of_cell[cell]] = step
        past, tracks, ways, lost = self.now - step, self.tracks, self.ways, self.lost
        st.remember(self.particles, 0, step, seen, foragers_at)
        lt.work_back(tracks, BOUNDARY, 0, step, past, EAST)
        lt.collect(tracks, BOUNDARY, 0, step, foragers_at, EAST, ways, lost)
        view, nobody = rc.View(step, belief, seen), rc.Catch(NOBODY[:0], np.zeros(0, np.int64))
        doubts = rc.no_doubts(len(SEA))
        about = SEA.neighbours, 0, view, 0.1, nobody, doubts, self.memory, ways, lost
        new = rc.reconcile(tracks, BOUNDARY, *about)
        about_now = 0, new, step, self.now, EAST, ways, lost
        new = lt.doubt(tracks, self.particles, BOUNDARY, *about_now)
        lt.carry_on(tracks, BOUNDARY, 0, step, past, EAST)
        return new

    @property
    def places(self) -> list[tuple[float, float]]:
        n = self.tracks.number[0]
        places = zip(self.tracks.row[0, :n], self.tracks.col[0, :n], strict=True)
        return [(float(r), float(c)) for r, c in places]


def test_tracks_that_a_look_says_nothing_of_stay_to_the_bit() -> None:
    past = Past()
    for row, col, seen in ((3.21, 14.37, 2), (7.0, 0.3, 4), (5.4, 28.9, 8)):
        past.track(row, col, seen)
    before = past.places
    assert past.hear(5, {}, [(10, 3)]) == 0
    assert past.places == before


def test_a_track_is_confirmed_where_it_was_then() -> None:
    past = Past()
    past.track(3.0, 15.0, 1)  # at column 12.5 in step 5
    assert past.hear(5, {(3, 12): 1}, [(3, c) for c in range(10, 15)]) == 0
    assert past.tracks.seen[0, 0] == 5
    (row, col), *_ = past.places
    assert (row, col) == pytest.approx((3.0, 15.0), abs=0.1)


def test_a_first_sighting_is_carried_on_to_where_it_must_be_now() -> None:
    past = Past()
    assert past.hear(6, {(3, 12): 1}, [(3, 12)]) == 1
    ((row, col),) = past.places
    assert (row, col) == pytest.approx((3.0, 14.0))
    assert past.tracks.born[0, 0] == past.tracks.seen[0, 0] == 6


def test_what_was_seen_since_accounts_for_a_count_and_stays() -> None:
    past = Past()
    past.track(3.0, 15.0, 8)
    before = past.places
    assert past.hear(5, {(3, 12): 1}, [(3, c) for c in range(10, 15)]) == 0
    assert past.places == before and past.tracks.seen[0, 0] == 8
    assert past.hear(5, {}, [(3, c) for c in range(10, 15)]) == 0, "and it is not given up"
    assert past.places == before
    assert past.hear(8, {}, [(3, c) for c in range(10, 18)]) == 0, "nor by another of that step"
    assert past.places == before


def test_what_the_look_pushes_out_of_sight_drifts_on_from_there() -> None:
    past = Past()
    past.track(3.0, 15.0, 1)
    past.hear(5, {}, [(3, 12)])
    ((row, col),) = past.places
    assert (row, col) != (3.0, 15.0) and abs(row - 3.0) + abs(col - 15.0) < 1.1


def test_what_was_not_there_is_given_up_or_out_of_sight() -> None:
    past = Past()
    past.track(3.0, 15.0, 1)
    assert past.hear(5, {}, [(r, c) for r in range(8) for c in range(8, 18)]) == 0
    assert past.places == [] and past.lost.number[0] == 1


@pytest.mark.parametrize("taken", [True, False])
def test_what_would_have_been_seen_or_taken_since_is_no_new_item(taken: bool) -> None:
    """In step 7 it would have been at column 12.5, that of node 13 by a hair, and then at 13."""
    past = Past()
    seen = np.full(len(SEA), NEVER, np.int16)
    at = NOBODY
    if taken:
        at = np.array([SEA.node_of_cell[3, 13]], np.int32)
    else:
        seen[SEA.node_of_cell[3, 13]] = 7
    st.remember(past.particles, 0, 7, seen, at)
    assert past.hear(5, {(3, 12): 1}, [(3, 12)]) == 0
    assert past.places == [] and past.lost.number[0] == 1


def test_what_a_forager_came_to_was_taken_unless_it_was_seen_since() -> None:
    at = np.array([SEA.node_of_cell[3, 12]], np.int32)
    for seen, left, lost in ((1, 0, 1), (4, 0, 0), (7, 1, 0)):
        past = Past()
        past.track(3.0, 15.0, seen)  # at column 12 when the forager came, in step 5
        past.hear(5, {}, [(10, 3)], at)
        assert len(past.places) == left
        assert past.lost.number[0] == lost, "lost if it had not been seen just before"


def test_particles_are_run_again_through_what_is_heard_late() -> None:
    """As if the view had been known in time; the others are where they were, to the bit."""
    on_time, late = Search((0.3, 0.0), noise=0.05), Search((0.3, 0.0), noise=0.05)
    patch = [(r, c) for r in range(22, 27) for c in range(15, 22)]
    on_time.view(6, *patch)
    for search in (on_time, late):
        search.draw(10, tries=150)
    many = int(late.particles.number[0])
    late.view(6, *patch)
    st.retest(late.particles, WIDE_SHORE, KEY, 0, 10)
    n = int(on_time.particles.number[0])
    assert int(late.particles.number[0]) == n < many
    for name in ("row", "col", "label"):
        one, two = (np.sort(getattr(s.particles, name)[0, :n]) for s in (on_time, late))
        np.testing.assert_array_equal(one, two)


def test_particles_that_began_in_a_late_view_of_the_start_are_gone() -> None:
    search, west = Search(), [(r, c) for r in range(40) for c in range(20)]
    search.draw(3, tries=150)
    assert search.expected[:, :20].sum() > 0.0
    search.view(0, *west)
    st.retest(search.particles, WIDE_SHORE, KEY, 0, 3)
    assert search.expected[:, :20].sum() == 0.0 < search.expected.sum()


def test_a_lost_item_is_looked_for_in_the_later_of_two_late_views() -> None:
    """One begun between two views that are heard together is held against the second."""
    node = int(WIDE.node_of_cell[20, 20])
    for since, left in ((6, False), (8, True)):
        search = Search()
        st.lose(search.particles, search.wind, WIDE_SHORE, KEY, 0, node, since, 10)
        search.view(3, (0, 0))
        search.view(8, (20, 20))
        assert search.particles.number[0] > 0
        st.retest(search.particles, WIDE_SHORE, KEY, 0, 10)
        assert bool(search.particles.number[0] > 0) == left


def test_looks_of_one_step_are_shown_together() -> None:
    views = SEA.views((1.0,))
    nodes = np.array([SEA.node_of_cell[5, 5], SEA.node_of_cell[5, 6]], np.int32)
    shown = np.zeros((2, 5), np.int16)
    both = list(views.of(int(nodes[0]))).index(SEA.node_of_cell[5, 6])
    shown[0, both] = 2
    glance = lt.glance(len(SEA))
    for step in (3, 4):
        lt.show(step, nodes, shown, np.zeros(2, np.int64), views, glance)
        assert int((glance.last_seen == step).sum()) == 8
        assert (glance.last_seen[glance.last_seen != step] == NEVER).all()
        assert glance.belief[SEA.node_of_cell[5, 6]] == 2, "the larger count of a node"
