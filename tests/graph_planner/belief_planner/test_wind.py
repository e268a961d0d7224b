import numpy as np
import pytest

from mjforage.graph_planner.belief_planner import tracks as tr
from mjforage.graph_planner.belief_planner import wind as wd
from mjforage.graph_planner.belief_planner.boundary import boundary_of
from mjforage.graph_planner.belief_planner.settings import BeliefSettings
from mjforage.graph_planner.graph.navigation import navigation_graph
from tests.graph_planner.charts import grid

SEA = boundary_of(navigation_graph(np.ones((80, 80), np.bool_), 1.0, False))
CHANNEL = navigation_graph(grid("..........", ".........."), 1.0, False)


def learned(ways: list[tuple[int, float, float]], start: int = 40 * 81) -> wd.Wind:
    """Wind after ways of (axis, shift, steps), all from one node of the sea."""
    wind, ended, none = wd.wind(1, BeliefSettings()), tr.ended(999), tr.tracks(1, 4)
    for i, (axis, shift, steps) in enumerate(ways):
        ended.axis[i], ended.shift[i], ended.steps[i], ended.start[i] = axis, shift, steps, start
    ended.number[0] = len(ways)
    wd.settle(wind, SEA, 0, ended)
    wd.estimate(wind, none, SEA, 0)
    assert ended.number[0] == 0
    return wind


def test_nothing_known_is_no_drift_within_the_range() -> None:
    wind = learned([])
    assert wind.mean[0] == pytest.approx([0, 0], abs=1e-12)
    assert 0.05 < wind.deviation[0, 0] < 0.1
    assert wind.chance[0].sum(axis=1) == pytest.approx([1, 1])


def test_the_estimate_is_the_true_drift_of_many_ways() -> None:
    """Items at uniform places of their squares, 30 steps of 0.07 and -0.04 with noise."""
    rng = np.random.default_rng(0)
    ways = []
    for _ in range(40):
        for axis, drift in ((0, 0.07), (1, -0.04)):
            end = rng.uniform(-0.5, 0.5) + 30 * drift + rng.uniform(-0.09, 0.09, 30).sum()
            ways.append((axis, float(np.rint(end)), 30.0))
    wind = learned(ways)
    assert wind.mean[0] == pytest.approx([0.07, -0.04], abs=0.006)
    assert (wind.deviation[0] < 0.012).all()


def test_a_few_mistaken_tracks_do_not_mislead_it() -> None:
    ways = [(0, 2.0, 30.0)] * 10 + [(0, -9.0, 30.0)] * 3
    assert learned(ways).mean[0, 0] == pytest.approx(2 / 30, abs=0.02)


def test_drift_beyond_the_expected_range_is_found_by_strong_evidence() -> None:
    assert learned([(1, 6.0, 30.0)] * 20).mean[0, 1] == pytest.approx(0.2, abs=0.02)


def test_what_lies_at_a_quay_says_nothing_of_drift_against_it() -> None:
    """At the north wall an item stays in any northward drift, but not in a southward one."""
    total = np.zeros(5)
    grid_of_drifts = np.array([-0.03, -0.015, 0.0, 0.015, 0.03])
    wd.log_likelihood(0.0, 40.0, 0, 20, 0.0027, grid_of_drifts, total)
    assert total[0] == total[1] == total[2] > total[3] > total[4]
    total[:] = 0.0
    wd.log_likelihood(0.0, 40.0, 20, 20, 0.0027, grid_of_drifts, total)
    assert total[2] > total[1] == total[3] > total[0] == total[4]


@pytest.mark.parametrize(("walls", "drift"), [("clip", 0.08), ("project", 0), ("published", 0)])
def test_what_a_quay_may_hold_up_says_nothing_of_the_drift_along_it(
    walls: str, drift: float
) -> None:
    """Three tracks of 50 steps along the north quay, by live tracks and by ways that ended."""
    boundary = boundary_of(
        navigation_graph(np.pad(np.ones((80, 80), np.bool_), 1), 1.0, False), walls
    )
    live, ended, none = tr.tracks(1, 4), tr.ended(9), tr.tracks(1, 4)
    live.base_node[0, :3], live.seen_node[0, :3], live.seen[0, :3] = 40, 44, 50
    ended.axis[:3], ended.start[:3], ended.shift[:3], ended.steps[:3] = 1, 40, 4.0, 50.0
    live.number[0] = ended.number[0] = 3
    for tracks, ways in ((live, tr.ended(1)), (none, ended)):
        wind = wd.wind(1, BeliefSettings())
        wd.settle(wind, boundary, 0, ways)
        wd.estimate(wind, tracks, boundary, 0)
        assert wind.mean[0, 1] == pytest.approx(drift, abs=0.015)
        assert (wind.deviation[0, 1] > 0.05) == (walls != "clip")


def test_live_tracks_count_too() -> None:
    wind, live = wd.wind(1, BeliefSettings()), tr.tracks(1, 4)
    node = 40 * 80 + 40
    for i in range(3):
        live.seen[0, i], live.seen_node[0, i] = 50, node + 4 * 80
        live.base_node[0, i] = node
    live.number[0] = 3
    wd.estimate(wind, live, SEA, 0)
    assert wind.mean[0] == pytest.approx([0.08, 0.0], abs=0.015)


@pytest.mark.parametrize("turned", [False, True])
def test_a_quay_on_either_side_holds_up_and_ways_off_it_count_all_the_same(turned: bool) -> None:
    """Of 3 ways along a southern (eastern) quay and 3 in open water behind them, these count."""
    graph = navigation_graph(np.pad(np.ones((80, 80), np.bool_), 1), 1.0, False)
    boundary, axis = boundary_of(graph, "published"), 0 if turned else 1
    at = (40, 80) if turned else (80, 40)
    quay, sea = graph.node_of_cell[at], graph.node_of_cell[40, 40]
    wind, ended = wd.wind(1, BeliefSettings()), tr.ended(9)
    ended.axis[:6], ended.start[:3], ended.start[3:6] = axis, quay, sea
    ended.shift[:3], ended.shift[3:6], ended.steps[:6] = -4.0, 4.0, 50.0
    ended.number[0] = 6
    wd.settle(wind, boundary, 0, ended)
    wd.estimate(wind, tr.tracks(1, 4), boundary, 0)
    assert wind.mean[0, axis] == pytest.approx(0.08, abs=0.015)


def test_the_edge_of_the_map_holds_nothing_up() -> None:
    """Items are clipped to it and go on along it, whatever the rule (definitions, section 1)."""
    open_sea = navigation_graph(np.ones((80, 80), np.bool_), 1.0, False)
    boundary, ended = boundary_of(open_sea, "published"), tr.ended(9)
    ended.axis[:3], ended.start[:3], ended.shift[:3], ended.steps[:3] = 1, 40, 4.0, 50.0
    ended.number[0], wind = 3, wd.wind(1, BeliefSettings())
    wd.settle(wind, boundary, 0, ended)
    wd.estimate(wind, tr.tracks(1, 4), boundary, 0)
    assert wind.mean[0, 1] == pytest.approx(0.08, abs=0.015)
