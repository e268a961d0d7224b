import numpy as np
from numpy.typing import NDArray

from mjforage.graph_planner.belief_planner import reconciling as rc
from mjforage.graph_planner.belief_planner import tracks as tr
from mjforage.graph_planner.belief_planner.boundary import Boundary, boundary_of
from mjforage.graph_planner.graph.navigation import navigation_graph
from tests.graph_planner.driver import no_doubts

SEA = navigation_graph(np.ones((12, 12), np.bool_), 1.0, False)
BOUNDARY = boundary_of(SEA)


class Watch:
    """One episode's tracks, fed with views by hand."""

    def __init__(self, boundary: Boundary = BOUNDARY) -> None:
        self.boundary, self.tracks = boundary, tr.tracks(1, 20)
        self.ways, self.lost, self.memory = (
            tr.ended(50),
            tr.losses(20),
            np.zeros(len(SEA), np.int16),
        )
        self.last_seen = np.full(len(SEA), -32768, np.int16)

    doubts = no_doubts(len(SEA))

    def view(
        self,
        now: int,
        counts: dict[tuple[int, int], int],
        hidden: set[tuple[int, int]] | None = None,
        caught: dict[tuple[int, int], int] | None = None,
    ) -> int:
        """See the whole sea but the hidden cells; the new tracks.

        `caught` are the items that foragers in some cells have taken.
        """
        belief = np.zeros(len(SEA), np.int16)
        self.last_seen[:] = now
        for cell in hidden or set():
            self.last_seen[SEA.node_of_cell[cell]] = now - 1
        for cell, count in counts.items():
            belief[SEA.node_of_cell[cell]] = count
        edges, wander, view = SEA.neighbours, 0.1, rc.View(now, belief, self.last_seen)
        at = np.array([SEA.node_of_cell[cell] for cell in caught or {}], np.int32)
        self.catch = rc.Catch(at, np.array(list((caught or {}).values()), np.int64))
        about = edges, 0, view, wander, self.catch
        memory = self.doubts, self.memory, self.ways, self.lost
        return rc.reconcile(self.tracks, self.boundary, *about, *memory)

    @property
    def cells(self) -> list[tuple[int, int]]:
        nodes = self.tracks.node[0, : self.tracks.number[0]]
        return sorted((int(SEA.rows[v]), int(SEA.cols[v])) for v in nodes)


def test_what_a_hull_took_is_not_lost_and_what_it_missed_is_not_new() -> None:
    watch = Watch()
    watch.view(0, {(3, 3): 3, (9, 9): 1})
    assert watch.view(1, {(3, 3): 1}, caught={(3, 4): 2}) == 0
    assert watch.cells == [(3, 3)] and watch.catch.left.tolist() == [0]
    assert watch.lost.born_node[: watch.lost.number[0]].tolist() == [SEA.node_of_cell[9, 9]]


def test_what_is_seen_becomes_tracks_once() -> None:
    watch = Watch()
    assert watch.view(0, {(3, 3): 2, (8, 1): 1}) == 3
    assert watch.view(1, {(3, 3): 2, (8, 1): 1}) == 0
    assert watch.cells == [(3, 3), (3, 3), (8, 1)]
    assert (watch.tracks.seen[0, :3] == 1).all() and (watch.tracks.born[0, :3] == 0).all()
    assert (watch.memory == 0).all()


def test_a_track_moves_to_the_nearest_node_that_lacks_one() -> None:
    watch = Watch()
    watch.view(0, {(3, 3): 1, (8, 8): 1})
    assert watch.view(1, {(3, 4): 1, (8, 7): 1}) == 0
    assert watch.cells == [(3, 4), (8, 7)]
    assert watch.lost.number[0] == 0


def test_one_too_far_off_is_a_new_track_and_the_old_one_is_lost() -> None:
    watch = Watch()
    watch.view(0, {(3, 3): 1})
    assert watch.view(1, {(9, 9): 1}) == 1
    assert watch.cells == [(9, 9)]
    lost = watch.lost
    assert (lost.number[0], lost.born_node[0], lost.born[0]) == (1, SEA.node_of_cell[3, 3], 0)


def test_what_is_not_where_it_should_be_is_just_out_of_sight_if_it_can_be() -> None:
    watch = Watch()
    watch.view(0, {(3, 3): 1})
    assert watch.view(1, {}, hidden={(3, 4), (9, 9)}) == 0
    assert watch.cells == [(3, 4)] and watch.tracks.seen[0, 0] == 0
    assert watch.view(2, {(3, 4): 1}) == 0  # and confirmed there later
    assert watch.tracks.seen[0, 0] == 2 and watch.tracks.born[0, 0] == 0


def test_an_unseen_track_is_pulled_in_before_a_new_one_is_made() -> None:
    watch = Watch()
    watch.view(0, {(3, 3): 1})
    assert watch.view(1, {(3, 2): 1}, hidden={(3, 3)}) == 0
    assert watch.cells == [(3, 2)]


def test_foragers_end_the_tracks_in_their_nodes_and_doubtful_ones_are_lost() -> None:
    watch = Watch()
    watch.view(4, {(3, 3): 2, (8, 8): 1})
    at = SEA.node_of_cell[[3], [3]].astype(np.int32)
    tr.collect(watch.tracks, BOUNDARY, 0, 5, at, watch.ways, watch.lost)
    assert watch.cells == [(8, 8)] and watch.lost.number[0] == 0
    at = SEA.node_of_cell[[8], [8]].astype(np.int32)
    tr.collect(watch.tracks, BOUNDARY, 0, 9, at, watch.ways, watch.lost)
    assert watch.cells == [] and watch.lost.number[0] == 1


def test_tracks_are_carried_by_the_drift() -> None:
    watch = Watch()
    watch.view(0, {(3, 3): 1})
    for _ in range(10):
        tr.carry(watch.tracks, BOUNDARY, 0, 0.1, -0.2)
    assert watch.cells == [(4, 1)]
    np.testing.assert_allclose([watch.tracks.row[0, 0], watch.tracks.col[0, 0]], [4.0, 1.0])


def reported(ways: tr.Ended) -> list[tuple[int, float, float]]:
    n = ways.number[0]
    shift: NDArray[np.float64] = ways.shift[:n]
    return sorted(zip(ways.axis[:n].tolist(), shift.tolist(), ways.steps[:n].tolist(), strict=True))


def test_an_ended_track_reports_its_way_along_both_axes() -> None:
    watch = Watch()
    watch.view(0, {(3, 3): 1})
    watch.view(6, {(4, 3): 1})
    watch.view(12, {(5, 4): 1})
    tr.drop(watch.tracks, BOUNDARY, 0, 0, watch.ways)
    assert reported(watch.ways) == [(0, 2.0, 12.0), (1, 1.0, 12.0)]


def test_a_way_along_a_quay_that_holds_items_up_is_one_of_its_own() -> None:
    along = {"clip": [(1, 3.0, 18.0)], "published": [(1, 1.0, 6.0), (1, 1.0, 6.0)]}
    for walls, expected in along.items():
        basin = navigation_graph(np.pad(np.ones((12, 12), np.bool_), 1), 1.0, False)
        watch = Watch(boundary_of(basin, walls))  # the same nodes, between quays
        for step, cell in enumerate(((2, 3), (1, 4), (0, 5), (0, 6))):
            watch.view(6 * step, {cell: 1})
        tr.drop(watch.tracks, watch.boundary, 0, 0, watch.ways)
        assert reported(watch.ways) == [(0, -2.0, 18.0), *expected]
