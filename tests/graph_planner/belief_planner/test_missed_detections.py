"""Missed detections and false positives, by hand."""

import numpy as np
import pytest

from mjforage.graph_planner.belief_planner import hotspots as hs
from mjforage.graph_planner.belief_planner import late as lt
from mjforage.graph_planner.belief_planner import missed_detections as ms
from mjforage.graph_planner.belief_planner import reconciling as rc
from mjforage.graph_planner.belief_planner import tracks as tr
from mjforage.graph_planner.belief_planner.boundary import boundary_of
from mjforage.graph_planner.belief_planner.missed_detections import remember, view_history
from mjforage.graph_planner.belief_planner.settings import BeliefSettings
from mjforage.graph_planner.belief_planner.spatial_prior import spatial_prior_of
from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.mission.sensors.detection import real_if_missed, real_if_new, real_if_seen

SEA = navigation_graph(np.ones((20, 20), np.bool_), 1.0, False)
BOUNDARY, KEY, NODES = boundary_of(SEA), np.uint64(5), 400
RADII = (2.0, 4.0)
VIEWS = SEA.views(RADII)
CHANCE = np.array([0.8, 0.6, 0.5, 0.5, 0.4, *[0.1] * 12])  # by squared distance
HERE, BESIDE, THERE = 210, 211, 213  # on one row


def looking(at: list[int], radius: list[int]) -> ms.Looking:
    """Scans from nodes (look,) with radius numbers (look,)."""
    nodes, numbers = np.array(at, np.int32), np.array(radius, np.int64)
    return ms.Looking(nodes, numbers, VIEWS, SEA.rows, SEA.cols)


def seen_by(at: list[int], radius: list[int], step: int) -> np.ndarray:
    """(node,) `step` where one of these looks reaches."""
    last_seen = np.full(NODES, -1, np.int16)
    for node, number in zip(at, radius, strict=True):
        last_seen[VIEWS.of(node, number)] = step
    return last_seen


def look(
    missed_detections: ms.MissedDetections, at: list[int], radius: list[int], step: int = 3
) -> None:
    ms.look_at(missed_detections, 0, step, seen_by(at, radius, step), looking(at, radius))


def test_the_nearest_who_looks_decides_what_is_missed() -> None:
    missed_detections = ms.missed_detections(1, NODES, 10, CHANCE)
    look(missed_detections, [THERE, HERE], [1, 0])
    assert ms.missed(missed_detections, 0, 3, HERE) == pytest.approx(0.2), "its own node"
    assert ms.missed(missed_detections, 0, 3, HERE + 1) == pytest.approx(0.4), (
        "one from the one, two the other"
    )
    assert ms.missed(missed_detections, 0, 3, THERE + 4) == pytest.approx(0.9)
    assert ms.missed(missed_detections, 0, 3, HERE - 3) == 1.0, "out of view"
    assert ms.missed(missed_detections, 0, 4, HERE) == 1.0, "another step"
    assert missed_detections.factor[[HERE, HERE + 1, HERE - 3]] == pytest.approx([0.2, 0.4, 1.0])


def test_a_view_that_is_heard_of_later_counts_by_what_it_adds() -> None:
    """Missed in .5 by the first, in .2 by both: the second multiplies by .2 / .5."""
    missed_detections = ms.missed_detections(1, NODES, 10, CHANCE)
    look(missed_detections, [HERE - 20 + 1], [0])
    assert missed_detections.factor[HERE] == pytest.approx(0.5)
    look(missed_detections, [HERE], [0])
    assert missed_detections.factor[HERE] == pytest.approx(0.4)
    look(missed_detections, [HERE + 2], [1])
    assert missed_detections.factor[HERE] == 1.0, "a look from farther off adds nothing"
    assert ms.missed(missed_detections, 0, 3, HERE) == pytest.approx(0.2)


def test_without_misses_a_view_leaves_nothing_unseen() -> None:
    missed_detections = ms.missed_detections(1, NODES, 10, np.ones(17))
    look(missed_detections, [HERE], [0])
    assert ms.is_certain(missed_detections) and missed_detections.near.size == 0
    assert (missed_detections.factor == (seen_by([HERE], [0], 3) != 3)).all()
    assert not ms.is_certain(ms.missed_detections(1, NODES, 10, CHANCE))


def test_chances_that_an_item_is_there() -> None:
    assert real_if_missed(0.9, 0.7) == pytest.approx(0.27 / 0.37) == pytest.approx(0.7297, abs=1e-4)
    assert real_if_missed(0.9, 1.0) == pytest.approx(0.0)
    assert real_if_seen(0.5, 0.8, 0.1) == pytest.approx(0.4 / 0.45)
    assert real_if_seen(0.5, 0.8, 0.0) == 1.0
    assert real_if_new(0.5, 0.8, 0.1) == pytest.approx(0.4 / 0.5)
    assert real_if_new(0.0, 0.8, 0.0) == 1.0


class Watch:
    """Tracks of one episode, and one scout at `HERE` that may miss and invent items."""

    def __init__(self, chance: float, false_rate: float = 0.0, expected: float = 0.0) -> None:
        self.tracks, self.ways, self.lost = tr.tracks(1, 20), tr.ended(90), tr.losses(20)
        self.missed_detections = ms.missed_detections(1, NODES, 40, np.full(17, chance))
        self.memory, self.step = np.zeros(NODES, np.int16), 0
        everywhere = np.full(NODES, expected)
        self.doubts = rc.Doubts(self.missed_detections, false_rate, everywhere, 0.0)

    def view(self, **counts: int) -> int:
        """See `here`, `beside` and the rest; new tracks."""
        belief, nobody = (
            np.zeros(NODES, np.int16),
            rc.Catch(np.zeros(0, np.int32), np.zeros(0, np.int64)),
        )
        belief[HERE], belief[BESIDE] = counts.get("here", 0), counts.get("beside", 0)
        look(self.missed_detections, [HERE], [1], self.step)
        view = rc.View(self.step, belief, seen_by([HERE], [1], self.step))
        about = SEA.neighbours, 0, view, 0.05, nobody, self.doubts, self.memory
        self.lost.number[0] = 0
        new = rc.reconcile(self.tracks, BOUNDARY, *about, self.ways, self.lost)
        self.step += 1
        return new

    @property
    def real(self) -> list[float]:
        return [float(real) for real in self.tracks.real[0, : self.tracks.number[0]]]


def test_a_track_that_is_not_shown_stays_until_it_is_unlikely() -> None:
    """At p = .5: .9 -> .818 -> .692 -> .529 -> .36 -> .22 -> .123, and then it is given up."""
    watch, real = Watch(0.5), 0.9
    assert watch.view(here=1) == 1 and watch.real == [1.0]
    for expected in (0.8182, 0.6923, 0.5294, 0.36, 0.2195, 0.1233):
        assert watch.view() == 0
        real = real_if_missed(real, 0.5)
        assert watch.real == pytest.approx([expected], abs=1e-4) == [pytest.approx(real)]
        assert watch.lost.number[0] == 0
    watch.view()
    assert watch.real == [] and watch.lost.number[0] == 1


def test_a_track_that_is_shown_again_is_certain() -> None:
    watch = Watch(0.5)
    watch.view(here=1)
    watch.view()
    assert watch.view(here=1) == 0 and watch.real == [1.0]


def test_where_nothing_is_missed_a_track_that_is_not_shown_is_lost_at_once() -> None:
    watch = Watch(1.0)
    watch.view(here=1)
    watch.view()
    assert watch.real == [] and watch.lost.number[0] == 1
    assert watch.lost.born_node[0] == HERE and watch.lost.born[0] == 0


def test_a_sighting_where_nothing_was_expected_is_taken_for_a_ghost() -> None:
    assert Watch(0.8, 0.01, expected=1e-6).view(here=1) == 0
    doubtful = Watch(0.8, 0.01, expected=0.0125)
    assert doubtful.view(here=1) == 1
    assert doubtful.real == pytest.approx([0.5])
    doubtful.view(here=1)
    assert doubtful.real == pytest.approx([0.4 / 0.405]), "seen twice it is hardly one"


def test_late_news_is_out_once_views_since_would_hardly_have_missed_it() -> None:
    """Missed with .5 by each of the views since: .125 after three, .0625 after four."""
    for views, kept in ((3, 1), (4, 0)):
        watch = Watch(0.5)
        history = view_history(1, NODES, 40, 0, watch.missed_detections)
        tr.begin(watch.tracks, BOUNDARY, 0, HERE, 1, watch.ways)
        for step in range(2, 2 + views):
            look(watch.missed_detections, [HERE], [1], step)
            remember(history, 0, step, seen_by([HERE], [1], step), np.zeros(0, np.int32))
        drift, ways = np.zeros(2), (watch.ways, watch.lost)
        new = lt.doubt(watch.tracks, history, BOUNDARY, 0, 1, 1, 10, drift, *ways)
        assert new == kept == watch.tracks.number[0]


def test_a_hotspot_is_less_likely_where_views_showed_nothing_but_not_refuted() -> None:
    spots, still = hs.hotspots(1, NODES, 1, 10, BeliefSettings()), np.arange(NODES, dtype=np.int32)
    factor = np.where(np.arange(NODES) == HERE, 0.3, 1.0).astype(np.float32)
    for _ in range(2):
        hs.look(spots, 0, still[None], factor)
    assert spots.unseen[0, 0, HERE] == pytest.approx(0.09) and spots.unseen[0, 0, BESIDE] == 1.0


def test_a_sighting_that_was_of_nothing_is_taken_back() -> None:
    settings, prior = BeliefSettings(), spatial_prior_of(SEA, 3.0)
    once, twice = (hs.hotspots(1, NODES, 1, 10, settings) for _ in range(2))
    true, ghost = np.array([HERE], np.int32), np.array([15], np.int32)
    hs.sight(once, prior, BOUNDARY, 0, 0, true, 0.0, 0.0)
    hs.sight(twice, prior, BOUNDARY, 0, 0, ghost, 0.0, 0.0)
    hs.sight(twice, prior, BOUNDARY, 0, 0, true, 0.0, 0.0)
    assert twice.number[0] == 2
    hs.retract(twice, prior, BOUNDARY, 0, 15, 7)
    assert twice.number[0] == 2, "another step"
    hs.retract(twice, prior, BOUNDARY, 0, 15, 0)
    assert twice.number[0] == 1 and twice.node[0, 0] == HERE
    np.testing.assert_allclose(twice.log_starts[0, 0], once.log_starts[0, 0])
    np.testing.assert_allclose(twice.chance[0, 0], once.chance[0, 0])
