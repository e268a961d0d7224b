import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.graph_planner.belief_planner import hotspots as hs
from mjforage.graph_planner.belief_planner.boundary import boundary_of, nearest_of_cells
from mjforage.graph_planner.belief_planner.drift_hypotheses import DriftHypotheses
from mjforage.graph_planner.belief_planner.settings import BeliefSettings
from mjforage.graph_planner.belief_planner.spatial_prior import (
    bounds,
    gathered,
    scattered,
    spatial_prior_of,
    start_chances,
)
from mjforage.graph_planner.graph.navigation import NavigationGraph, navigation_graph

F64 = NDArray[np.float64]
SEA = navigation_graph(np.ones((40, 40), np.bool_), 1.0, False)
STILL = np.arange(len(SEA), dtype=np.int32)[None]


def table(graph: NavigationGraph, spread: float) -> F64:
    """P0[c, x] of all pairs, from the starts' side."""
    prior, out = spatial_prior_of(graph, spread), np.zeros((len(graph), len(graph)))
    for x in range(len(graph)):
        start_chances(prior, x, out[:, x])
    return out


def test_a_start_counts_for_the_node_nearest_to_its_cell(ragged_coast: NavigationGraph) -> None:
    """P0 from one hotspot against 100,000 normal positions, cell by cell."""
    chances = table(ragged_coast, 2.0)
    np.testing.assert_allclose(chances.sum(axis=1), 1.0, atol=1e-9)
    c, rng, (height, width) = 150, np.random.default_rng(1), ragged_coast.shape
    places = rng.normal((ragged_coast.rows[c], ragged_coast.cols[c]), 2.0, (100_000, 2))
    cells = np.rint(places).astype(int).clip(0, (height - 1, width - 1))
    nodes = nearest_of_cells(ragged_coast)[cells[:, 0], cells[:, 1]]
    drawn = np.bincount(nodes, minlength=len(ragged_coast)) / 100_000
    np.testing.assert_allclose(chances[c], drawn, atol=0.004)


def test_sums_over_starts_and_over_hotspots_are_those_of_the_table(
    ragged_coast: NavigationGraph,
) -> None:
    chances, rng = table(ragged_coast, 2.0), np.random.default_rng(0)
    n, prior = len(ragged_coast), spatial_prior_of(ragged_coast, 2.0)
    value, out, spread_out = rng.random(n), np.full(n, -1.0), np.zeros(n)
    weight = np.where((ragged_coast.rows > 5) & (ragged_coast.rows < 15), rng.random(n), 0.0)
    box = bounds(prior, weight, 0.0)
    gathered(prior, value, box, out)
    inside = (ragged_coast.rows > 5) & (ragged_coast.rows < 15)
    np.testing.assert_allclose(out[inside], (chances @ value)[inside], atol=1e-9)
    assert (out[~inside] == -1.0).all()
    scattered(prior, weight, box, spread_out)
    np.testing.assert_allclose(spread_out, weight @ chances, atol=1e-9)


class Belief:
    """Hotspots of one episode on the open sea, without drift unless given."""

    def __init__(self, **assumptions: float) -> None:
        self.settings = BeliefSettings(**assumptions)  # type: ignore[arg-type]
        self.prior, self.boundary = (
            spatial_prior_of(SEA, self.settings.spread_node),
            boundary_of(SEA),
        )
        self.spots = hs.hotspots(1, len(SEA), 1, 400, self.settings)
        self.expected = np.zeros(len(SEA))

    def look(self, now: int, seen: NDArray[np.bool_]) -> None:
        last_seen = np.where(seen.ravel(), now, -32768).astype(np.int16)
        hs.look(self.spots, 0, STILL, (last_seen != now).astype(np.float32))

    def sight(
        self,
        cells: list[tuple[int, int]],
        now: int = 0,
        drift: tuple[float, float] = (0.0, 0.0),
    ) -> None:
        nodes = np.array([SEA.node_of_cell[cell] for cell in cells], np.int32)
        hs.sight(self.spots, self.prior, self.boundary, 0, now, nodes, *drift)

    def expect(self) -> F64:
        hs.expect(self.spots, self.prior, 0, STILL, self.expected)
        return self.expected.reshape(40, 40)


@pytest.mark.parametrize("hotspots", [1, 2, 5])
def test_before_anything_is_seen_all_items_are_expected_anywhere(hotspots: int) -> None:
    belief = Belief(hotspots=hotspots)
    expected = belief.expect()
    assert expected.sum() == belief.spots.total[0] == pytest.approx(75, rel=1e-6)
    np.testing.assert_allclose(belief.spots.chance[0, :hotspots], 1 / 1600)
    np.testing.assert_allclose(expected[18:22, 18:22], 75 / 1600, rtol=0.02)


def test_an_empty_view_rules_out_the_hotspots_that_would_have_shown() -> None:
    """p(c) is proportional to (b / (b + 1 - U(c)))^a, by the closed form on the table."""
    belief = Belief()
    seen = np.zeros((40, 40), np.bool_)
    seen[15:25, 15:25] = True
    belief.look(3, seen)
    expected = belief.expect()
    visible = table(SEA, 4.47) @ seen.ravel().astype(float)
    a, b = 56.25, 0.75
    chance = (b / (b + visible)) ** a
    np.testing.assert_allclose(belief.spots.chance[0, 0], chance / chance.sum(), atol=1e-9)
    assert (expected[seen] == 0).all()
    assert belief.spots.chance[0, 0].reshape(40, 40)[20, 20] < 1e-6


def test_sightings_place_the_hotspot_and_leave_its_unseen_side_expected() -> None:
    belief = Belief()
    rng = np.random.default_rng(0)
    cells = np.rint(rng.normal((20, 20), 4.47, (75, 2))).astype(int).clip(0, 39)
    seen = np.zeros((40, 40), np.bool_)
    seen[:, :20] = True
    belief.look(0, seen)
    shown = [(int(r), int(c)) for r, c in cells if c < 20]
    belief.sight(shown)
    expected = belief.expect()
    row, col = divmod(int(belief.spots.chance[0, 0].argmax()), 40)
    assert abs(row - 20) <= 1 and abs(col - 20) <= 1
    assert expected.sum() == pytest.approx(75 - len(shown), rel=0.3)
    assert expected[:, 20:].sum() > 0.999 * expected.sum()
    assert belief.spots.total[0] == pytest.approx(75, rel=0.15)


def test_one_hotspot_cannot_be_far_from_its_first_item() -> None:
    belief = Belief()
    belief.sight([(5, 5)])
    belief.expect()
    near = (np.abs(SEA.rows - 5) <= 15) & (np.abs(SEA.cols - 5) <= 15)
    assert belief.spots.chance[0, 0][near].sum() > 0.98


def test_a_second_hotspot_takes_the_sightings_that_the_first_cannot_explain() -> None:
    belief = Belief(hotspots=2)
    rng = np.random.default_rng(0)
    one, two = (rng.normal(c, 3.0, (20, 2)) for c in ((8, 8), (31, 31)))
    cells = [(int(r), int(c)) for r, c in np.rint(np.concatenate((one, two))).clip(0, 39)]
    belief.sight(cells)
    belief.expect()
    assert belief.spots.sighted[0].tolist() == [20, 20, 0, 0]
    for h, middle in enumerate((8, 31)):
        row, col = divmod(int(belief.spots.chance[0, h].argmax()), 40)
        assert abs(row - middle) <= 2 and abs(col - middle) <= 2


def clustered(rng: np.random.Generator, *middles: tuple[int, int]) -> list[tuple[int, int]]:
    """Cells of 25 items around each of the middles."""
    places = np.concatenate([rng.normal(middle, 4.47, (25, 2)) for middle in middles])
    return [(int(r), int(c)) for r, c in np.rint(places).clip(0, 39)]


def test_sightings_that_one_hotspot_cannot_explain_refute_the_assumption_of_one() -> None:
    """Then there is one more than shown, and 75 items are shared by all of them."""
    belief = Belief()
    belief.sight(clustered(np.random.default_rng(0), (6, 6)))
    assert hs.believed(belief.spots, 0) == 1
    belief.expect()
    belief.look(0, (np.arange(1600) < 1000).reshape(40, 40))
    belief.sight(clustered(np.random.default_rng(1), (6, 32)))
    assert hs.believed(belief.spots, 0) == 3
    assert belief.expect()[28:].sum() > 5  # the third, where nobody has looked
    assert belief.spots.total[0] == pytest.approx(75, rel=0.3)


def test_sightings_are_worked_back_along_the_drift() -> None:
    """Seen at step 60 around (26, 17) with drift (0.1, -0.05): they started around (20, 20)."""
    belief = Belief()
    belief.sight(clustered(np.random.default_rng(0), (26, 17)), 60, (0.1, -0.05))
    belief.expect()
    row, col = divmod(int(belief.spots.chance[0, 0].argmax()), 40)
    assert abs(row - 20) <= 1 and abs(col - 20) <= 1
    belief.sight([(26, 17)], 61, (0.0, 0.0))  # the estimate changes: all are worked out again
    belief.expect()
    row, col = divmod(int(belief.spots.chance[0, 0].argmax()), 40)
    assert abs(row - 26) <= 2 and abs(col - 17) <= 2


def test_a_mistaken_sighting_or_two_refute_nothing() -> None:
    belief = Belief()
    belief.sight(clustered(np.random.default_rng(0), (6, 6)))
    belief.expect()
    for n in range(2):
        belief.sight([(32, 30 + n)])
        assert hs.believed(belief.spots, 0) == 1
    belief.sight([(32, 33)])
    assert hs.believed(belief.spots, 0) == 3


def test_an_unsighted_second_hotspot_is_expected_where_nobody_has_looked() -> None:
    """Of 150 +- 10 items it has a gamma number, a = 225 and b = 3: a / (b + share seen) of them."""
    belief = Belief(hotspots=2, items=150.0)
    seen = np.arange(1600) < 800
    belief.look(0, seen.reshape(40, 40))
    belief.sight([(10, 10 + i // 2) for i in range(20)])
    starts = table(SEA, 4.47)
    rate = 3.0 + starts @ seen
    weight = rate**-225.0 / (rate**-225.0).sum()
    expected = np.where(seen, 0.0, (weight * 225.0 / rate) @ starts).reshape(40, 40)
    np.testing.assert_allclose(belief.expect()[30:], expected[30:], rtol=1e-3)
    assert expected[30:].sum() > 40.0, "of the 75 of that hotspot; the first has none there"


def test_currents_carry_every_start_and_are_made_step_by_step() -> None:
    drift_hypotheses = DriftHypotheses(SEA, "clip", 0.1, 150)
    assert drift_hypotheses.drift.shape == (25, 2) and np.abs(drift_hypotheses.drift).max() <= 0.1
    w = int(np.argmin(np.abs(drift_hypotheses.drift - (0.08, -0.04)).sum(axis=1)))
    later = drift_hypotheses.nodes(50)[w].reshape(40, 40)
    assert later[10, 20] == SEA.node_of_cell[14, 18]
    assert later[38, 20] == SEA.node_of_cell[39, 18]
    np.testing.assert_array_equal(drift_hypotheses.nodes(0)[w], np.arange(1600))


def test_starts_that_drifted_into_view_are_seen_only_under_that_drift() -> None:
    drift_hypotheses = DriftHypotheses(SEA, "clip", 0.1, 150)
    spots = hs.hotspots(1, len(SEA), 25, 10, BeliefSettings())
    last_seen = np.full(len(SEA), -32768, np.int16)
    last_seen[SEA.node_of_cell[14, 18]] = 50
    hs.look(spots, 0, drift_hypotheses.nodes(50), (last_seen != 50).astype(np.float32))
    gone = np.argwhere(spots.unseen[0] == 0)
    assert len(gone) == 25
    for w, x in gone:
        drifted = np.array([SEA.rows[x], SEA.cols[x]]) + 50 * drift_hypotheses.drift[w]
        np.testing.assert_allclose(drifted, (14, 18), atol=0.51)


def test_weights_of_the_drifts_follow_the_winds_posterior() -> None:
    axis = np.array([-0.08, -0.04, 0.0, 0.04, 0.08])
    points = np.array([-0.2, -0.05, 0.01, 0.09])
    share = np.zeros(25)
    hs.weigh(axis, points, np.array([[0.1, 0.2, 0.3, 0.4], [0, 0, 1, 0]]), share)
    np.testing.assert_allclose(share.reshape(5, 5)[:, 2], [0.1, 0.2, 0.3, 0, 0.4])
    assert share.sum() == pytest.approx(1)
