from dataclasses import replace

import numpy as np
import pytest

from mjforage.base.errors import UserError
from mjforage.base.randomness import episode_keys
from mjforage.controllers import quayside
from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.mission.capture_chances import (
    Chances,
    chances_from,
    chances_of,
    delays_from,
    pickup_of,
)
from mjforage.mission.capture_rule import capture_cell, quays_beside
from mjforage.mission.dynamics import Transition, start_state
from mjforage.mission.initial_state import InitialState
from mjforage.mission.item_rule import ItemRule
from mjforage.mission.mission import Mission
from mjforage.mission.setup import Setup
from mjforage.mission.task import IDLE, MISSED, TAKEN
from mjforage.physics.worlds import create_mission
from mjforage.scenario.capture import (
    BESIDE_M,
    QUAYS,
    Capture,
    CaptureCell,
    CaptureFollow,
    load_capture,
)
from mjforage.scenario.roles import Fleet, Role
from mjforage.scenario.scenario_file import load_scenario
from tests.graph_planner.charts import grid

GRAPH = navigation_graph(grid("...", "...", "..."), 4.0, False)
FORAGER = Fleet.of({"foragers": Role(count=1, moves=1, radius=1.0, collects=True)})
NEVER, ALWAYS = 0.0, 1.0
CORNER = GRAPH.node_of_cell[0, 0]


@pytest.mark.parametrize(
    ("east", "north", "yaw", "cell"),
    [
        (1.4, 0.0, 0.0, (0, 0)),
        (1.5, 0.0, 0.0, (1, 0)),
        (0.0, 4.9, 0.0, (2, 2)),  # abeam: where the third bin of bearings begins
        (0.0, -5.1, 0.0, (3, 2)),
        (-2.0, -0.1, 0.0, (1, 3)),
        (-2.0, -0.1, np.pi, (1, 0)),
        (2.0, 2.1, 4 * np.pi, (1, 1)),
    ],
)
def test_cells_are_of_distance_and_bearing_to_either_side(
    east: float, north: float, yaw: float, cell: tuple[int, int]
) -> None:
    assert capture_cell(east, north, yaw) == cell


@pytest.mark.parametrize(
    ("row", "col", "quays"),
    [
        (1.0, 1.0, 0),
        (0.45, -0.49, 1),
        (-0.34, 0.0, 0),  # 0.64 m off
        (-0.36, 0.0, 1),  # 0.56 m off
        (-0.49, -0.49, 2),
        (2.49, 1.0, 1),
        (2.49, 2.49, 2),
        (1.0, 0.49, 0),
    ],
)
def test_quays_within_reach_are_counted(row: float, col: float, quays: int) -> None:
    assert quays_beside(GRAPH.water.framed, 4.0, row, col) == quays


def test_a_quay_is_beside_an_item_as_the_pilots_have_it() -> None:
    assert quayside.BESIDE_M == BESIDE_M


def chances(first: float, follow: float = NEVER) -> Chances:
    return Chances(np.full((1, 3, 4, 4, 3), first), np.full((1, 3), follow), 4.0)


def started(
    table: Chances, places: list[tuple[float, float]], episodes: int = 1, capacity: int = 0
) -> tuple[ItemRule, Transition]:
    """Items of the corner node, and a forager in it that heads east."""
    role = Role(count=1, moves=1, radius=1.0, collects=True, capacity=capacity)
    fleet, shape = Fleet.of({"foragers": role}), (episodes, len(places))
    initial = InitialState(
        n_items=np.full(episodes, len(places), np.int32),
        item_rc=np.tile(np.array(places), (episodes, 1, 1)),
        item_node=np.full(shape, CORNER, np.int32),
        drift_rc=np.zeros((episodes, 2)),
        agent_node=np.full((episodes, 1), CORNER, np.int32),
    )
    state = start_state(initial, np.stack((GRAPH.rows, GRAPH.cols), axis=1).astype(np.float64))
    rule = ItemRule(GRAPH, fleet, 0.0, "clip", table)
    rule.reset(initial, episode_keys(3, np.arange(episodes)), state)
    return rule, state


def advance(rule: ItemRule, state: Transition, step: int = 1) -> None:
    episodes = len(state.item_node)
    rule.advance(np.ones(episodes, np.bool_), np.full(episodes, step, np.int32))


def test_only_the_item_s_own_cell_decides() -> None:
    """1 m ahead in open water; behind; in the corner. A chance of 1 in one cell, else of 0."""
    places = {(0, 0, 0): (0.0, 0.25), (0, 0, 3): (0.0, -0.25), (2, 1, 3): (-0.49, -0.49)}
    for cell in places:
        table = chances(NEVER)
        table.first[(0, *cell)] = ALWAYS
        for other, place in places.items():
            rule, state = started(table, [place])
            advance(rule, state)
            assert state.pickup[0, 0] == (TAKEN if other == cell else MISSED)
            assert state.collected_by[0, 0] == (0 if other == cell else -1)


def test_the_nearest_item_comes_first_and_a_miss_ends_the_decision() -> None:
    rule, state = started(chances(ALWAYS, NEVER), [(0.3, 0.0), (0.1, 0.1), (0.2, 0.0)])
    advance(rule, state)
    assert state.collected_by[0].tolist() == [-1, 0, -1]
    assert state.pickup[0, 0] == TAKEN
    rule, state = started(chances(NEVER, ALWAYS), [(0.3, 0.0), (0.1, 0.1)])
    advance(rule, state)
    assert state.collected_by[0].tolist() == [-1, -1]
    rule, state = started(chances(ALWAYS, ALWAYS), [(0.3, 0.0), (0.1, 0.1)], capacity=1)
    advance(rule, state)
    assert state.collected_by[0].tolist() == [-1, 0]
    advance(rule, state, 2)
    assert state.pickup[0, 0] == IDLE and rule.room_left[0, 0] == 0


def test_a_forager_that_stays_tries_with_the_next_decision_s_chance() -> None:
    """From where it set out: it has turned since, and that does not count."""
    table = chances(NEVER)
    table.first[0, 0, 0, 0, 2] = ALWAYS
    rule, state = started(table, [(0.0, 0.25)])
    for step, outcome in ((1, MISSED), (2, MISSED), (3, TAKEN)):
        advance(rule, state, step)
        assert state.pickup[0, 0] == outcome
        state.agent_yaw[:] = np.pi


def test_a_forager_that_left_begins_anew_from_where_it_was() -> None:
    """West of the item, headed east, after a decision in another node: ahead, at 3 m or more."""
    table, away = chances(NEVER), GRAPH.node_of_cell[0, 1]
    table.first[0, 0, 2, 3, 0] = ALWAYS
    rule, state = started(table, [(0.0, 0.1)])
    advance(rule, state)
    state.agent_node[:], state.agent_rc[:] = away, (0.0, 1.0)
    advance(rule, state, 2)
    assert state.pickup[0, 0] == IDLE
    state.agent_node[:], state.agent_rc[:] = CORNER, 0.0
    advance(rule, state, 3)
    assert state.pickup[0, 0] == TAKEN


def test_items_are_taken_as_often_as_the_table_says() -> None:
    for first, follow in ((0.3, 0.0), (0.7, 0.6)):
        rule, state = started(chances(first, follow), [(0.0, 0.1), (0.0, 0.2)], 4000)
        advance(rule, state)
        share = (state.collected_by >= 0).mean(axis=0)
        np.testing.assert_allclose(share, [first, first * follow], atol=0.03)


def test_counts_become_chances_by_the_rule_of_succession() -> None:
    capture = Capture(
        10.0,
        (CaptureCell("corner", 3.0, 90.0, 10, (4, 6, 0)),),
        (CaptureFollow("straight", 8, 8),),
    )
    first, follow = chances_from(capture)
    assert first[2, 2, 2].tolist() == [5 / 12, 7 / 8, 1 / 2]
    assert follow.tolist() == [0.0, 9 / 10, 0.0]


def test_chances_become_decisions_lost_over_an_item_and_over_one_more() -> None:
    """Items of the next node are taken by .5, then .75 and .8 of those left, and from the farther
    distances by none, then .5 and .75.
    """
    trials = 1_000_000
    cells = []
    for cell in load_capture("forager").cells:
        delayed = cell.from_m == 5.0
        taken = (0, 500_000, 375_000) if delayed else (500_000, 375_000, 100_000)
        cells.append(replace(cell, trials=trials, taken=taken))
    follows = tuple(CaptureFollow(quays, trials, trials // 4) for quays in QUAYS)
    capture = Capture(10.0, tuple(cells), follows)
    first, more = delays_from(capture)
    soon = 0.5 + 0.5 * 0.25 + 0.5 * 0.25 * 0.2 / 0.8
    late_one = 1.0 + 0.5 + 0.5 * 0.25 / 0.75
    assert first == pytest.approx(np.full((3, 4), 0.5 * (soon + late_one)), abs=1e-4)
    assert more == pytest.approx(0.75, abs=1e-4)


def test_planners_are_told_what_picking_up_takes_only_where_it_can_fail() -> None:
    """By a hull's own trials, for periods of another length too; else by those of the forager."""
    setup = Setup.of(load_scenario("comb-port-weather"))
    first, more = delays_from(load_capture("forager"))
    scout, forager = setup.fleet.discoverers[0], setup.fleet.collectors[0]
    told = pickup_of(setup.fleet, setup.scenario)
    assert (told.first[forager] == first).all() and told.more[forager] == more
    assert not told.first[scout].any() and not told.more[scout]
    halved = load_scenario("comb-port-weather", ["period_s=20.0"])
    assert (pickup_of(setup.fleet, halved).first[forager] == 0.5 * first).all()
    strange = load_scenario("comb-port-weather", ["physics.vessels.foragers=otter"])
    assert (pickup_of(setup.fleet, strange).first[forager] == first).all()
    for world, is_told in (("graph", False), ("debris", False), ("intake", True)):
        assert (create_mission(setup, world).task.pickup is not None) == is_told


def test_a_scenario_gives_its_collectors_the_chances_of_their_vessels() -> None:
    setup = Setup.of(load_scenario("comb-port", ["rules.capture=calibrated"]))
    table = chances_of(setup.fleet, setup.scenario)
    assert table is not None
    first, follow = chances_from(load_capture("forager"))
    for agent, collects in enumerate(setup.fleet.collects):
        assert (table.first[agent] == (first if collects else 0.0)).all()
        assert (table.follow[agent] == (follow if collects else 0.0)).all()
    assert chances_of(setup.fleet, load_scenario("comb-port")) is None
    assert Mission(setup).task.pickup is not None


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("physics.vessels.foragers=otter", "mjforage calibrate otter"),
        ("period_s=20", "vessel forager was calibrated for decisions of 10 s; set period_s=10"),
        ("rules.capture=sure", "rules.capture = 'sure' should be 'certain' or 'calibrated'"),
    ],
)
def test_what_cannot_be_calibrated_is_named(override: str, words: str) -> None:
    with pytest.raises(UserError, match=words):
        Mission(Setup.of(load_scenario("comb-port", ["rules.capture=calibrated", override])))
