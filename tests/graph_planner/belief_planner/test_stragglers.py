import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.base.randomness import episode_keys
from mjforage.graph_planner.belief_planner import hotspots as hs
from mjforage.graph_planner.belief_planner import stragglers as st
from mjforage.graph_planner.belief_planner import wind as wd
from mjforage.graph_planner.belief_planner.boundary import boundary_of
from mjforage.graph_planner.belief_planner.settings import BeliefSettings
from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.graph_planner.graph.walls import WALLS
from mjforage.mission.dynamics import start_state
from mjforage.mission.initial_state import InitialState
from mjforage.mission.item_rule import ItemRule
from mjforage.scenario.fleet import Fleet, Role

SEA = navigation_graph(np.ones((40, 40), np.bool_), 1.0, False)
BOUNDARY, KEY = boundary_of(SEA), np.uint64(77)


class Search:
    """One episode without foragers in the way, on the open sea with a known drift."""

    def __init__(self, drift: tuple[float, float] = (0.0, 0.0), noise: float = 0.0) -> None:
        self.particles = st.stragglers(1, len(SEA), 60, 1, noise)
        self.wind = wd.wind(1, BeliefSettings())
        self.wind.mean[0], self.wind.deviation[0] = drift, 0.0
        self.spots = hs.hotspots(1, len(SEA), 1, 10, BeliefSettings())
        self.spots.chance[0, 0] = 0.0
        self.spots.chance[0, 0, SEA.node_of_cell[20, 20]] = 1.0
        self.spots.sighted[0, 0] = 1

    def view(self, step: int, *cells: tuple[int, int], forager: tuple[int, int] = (39, 39)) -> None:
        last_seen = np.full(len(SEA), -1, np.int16)
        last_seen[[SEA.node_of_cell[cell] for cell in cells]] = step
        at = np.array([SEA.node_of_cell[forager]], np.int32)
        st.remember(self.particles, 0, step, last_seen, at)

    def draw(self, now: int, tries: int = 400) -> None:
        spots, wind = self.spots, self.wind
        st.try_more(self.particles, spots, wind, BOUNDARY, KEY, 0, now, 4.0, tries)

    @property
    def expected(self) -> NDArray[np.float64]:
        out = np.zeros(len(SEA))
        st.expect_stragglers(self.particles, BOUNDARY, 0, 75.0, 0.5, out)
        return out.reshape(40, 40)


def test_without_views_all_items_are_expected_around_the_hotspot() -> None:
    search = Search()
    search.draw(0, tries=180)
    assert search.particles.number[0] == search.particles.tried[0] == 180
    assert search.expected.sum() == pytest.approx(75)
    assert search.expected[8:33, 8:33].sum() > 70
    row = (search.expected.sum(axis=1) * np.arange(40)).sum() / 75
    assert row == pytest.approx(20, abs=1)


def test_a_view_leaves_no_particle_in_it() -> None:
    search, west = Search(), [(r, c) for r in range(40) for c in range(20)]
    search.view(0, *west)
    search.draw(0)
    expected = search.expected
    assert expected[:, :20].sum() == 0
    assert expected.sum() == pytest.approx(37.5 + 75 * 0.05, rel=0.15)  # of the column 20 too


def test_particles_that_drift_into_a_later_view_are_gone() -> None:
    """Column 25 is watched from step 1 on; in 30 steps of 0.4 all from 14 to 25 would pass it."""
    late, early = Search(drift=(0.0, 0.4)), Search(drift=(0.0, 0.4))
    early.draw(0)
    for search in (late, early):
        for step in range(1, 31):
            search.view(step, *((r, 25) for r in range(40)))
            st.advance(search.particles, BOUNDARY, KEY, 0, step)
    late.draw(30)
    for search in (late, early):
        assert search.particles.number[0] >= 3
        assert search.expected[:, 26:37].sum() == 0 < search.expected.sum()
    assert late.expected.sum() == pytest.approx(early.expected.sum(), rel=0.6)


def test_a_lost_item_is_expected_where_it_drifted_and_not_where_it_would_be_seen() -> None:
    search = Search(drift=(0.1, 0.0), noise=0.2)
    node = int(SEA.node_of_cell[10, 10])
    for step in range(24, 31):
        search.view(step, *((r, c) for r in range(9, 14) for c in range(10, 12)))
    st.lose(search.particles, search.wind, BOUNDARY, KEY, 0, node, 10, 30)
    expected = search.expected
    assert expected.sum() == pytest.approx(0.5)
    assert expected[9:14, 10:12].sum() == 0
    assert expected[10:16, 6:16].sum() == pytest.approx(0.5)
    assert not st.find(search.particles, BOUNDARY, 0, int(SEA.node_of_cell[30, 30]))
    assert st.find(search.particles, BOUNDARY, 0, int(SEA.node_of_cell[12, 9]))
    assert search.particles.number[0] == 0 and search.expected.sum() == 0


def test_what_a_forager_would_have_collected_is_no_straggler() -> None:
    search = Search()
    search.view(1, forager=(10, 10))
    st.lose(search.particles, search.wind, BOUNDARY, KEY, 0, int(SEA.node_of_cell[10, 10]), 0, 1)
    assert search.particles.number[0] == 0


def test_draws_depend_on_the_key_and_the_number_alone() -> None:
    whole, parts = Search(noise=0.09), Search(noise=0.09)
    whole.draw(12, tries=100)
    for _ in range(4):
        parts.draw(12, tries=25)
    np.testing.assert_array_equal(whole.particles.row, parts.particles.row)


BAY = navigation_graph(np.pad(np.ones((6, 6), np.bool_), 1), 1.0, False)
SCOUT = Fleet.of({"scouts": Role(count=1, moves=1, radius=1.0, collects=False)})
STEPS, NOISE, EPISODES, EACH = 30, 0.09, 10, 800


def starts(cell: tuple[int, int]) -> NDArray[np.float64]:
    """(episode, item, 2) anywhere in a cell of the bay."""
    return np.array(cell) + np.random.default_rng(0).uniform(-0.5, 0.5, (EPISODES, EACH, 2))


def items_adrift(
    cell: tuple[int, int], drift: tuple[float, float], walls: str
) -> NDArray[np.float64]:
    """(node,) share of items there that the rule of the items leaves there."""
    node = np.full((EPISODES, EACH), BAY.node_of_cell[cell], np.int32)
    counts = np.full(EPISODES, EACH, np.int32)
    initial = InitialState(counts, starts(cell), node, np.tile(drift, (EPISODES, 1)), node[:, :1])
    state = start_state(initial, np.stack((BAY.rows, BAY.cols), axis=1).astype(np.float64))
    rule = ItemRule(BAY, SCOUT, NOISE, walls)
    rule.reset(initial, episode_keys(0, np.arange(EPISODES)), state)
    for step in range(1, STEPS + 1):
        rule.advance(np.ones(EPISODES, np.bool_), np.full(EPISODES, step, np.int32))
    return np.bincount(state.item_node.ravel(), minlength=len(BAY)) / node.size


def particles_adrift(
    cell: tuple[int, int], drift: tuple[float, float], walls: str
) -> NDArray[np.float64]:
    """(node,) share of particles there that nobody sees."""
    particles, boundary = (
        st.stragglers(EPISODES, len(BAY), STEPS, 0, NOISE),
        boundary_of(BAY, walls),
    )
    particles.row[:, :EACH], particles.col[:, :EACH] = np.moveaxis(starts(cell), -1, 0)
    particles.drift[:], particles.label[:, :EACH] = drift, np.arange(EACH)
    particles.number[:] = particles.lost[:, 0] = EACH  # and each is of loss 0
    shares = np.zeros(len(BAY))
    for e in range(EPISODES):
        for step in range(1, STEPS + 1):
            st.advance(particles, boundary, np.uint64(e), e, step)
        st.expect_stragglers(particles, boundary, e, 0.0, 1.0 / EPISODES, shares)
    return shares


@pytest.mark.parametrize("walls", WALLS)
@pytest.mark.parametrize("drift", [(-0.05, 0.06), (0.04, -0.08), (0.06, 0.05), (-0.03, -0.03)])
@pytest.mark.parametrize("cell", [(1, 1), (3, 1), (6, 3)])
def test_particles_spread_along_quays_as_items_do(
    cell: tuple[int, int], drift: tuple[float, float], walls: str
) -> None:
    """Half the sum of the differences; by the rule of clip it is up to 0.69 under the others."""
    off = items_adrift(cell, drift, walls) - particles_adrift(cell, drift, walls)
    assert 0.5 * abs(off).sum() < 0.04
