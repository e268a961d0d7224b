"""Moves of which only the end node has to be free, and starts that count as unseen."""

import numpy as np
import pytest

from mjforage.base.errors import UserError
from mjforage.graph_planner.belief_planner.ways import ways_of
from mjforage.graph_planner.encodings import LegalMoves
from mjforage.graph_planner.encodings.masks import legal_of_agent
from mjforage.graph_planner.graph.navigation import OFFSETS, STAY, navigation_graph
from mjforage.mission.mission import Mission
from mjforage.mission.moves import FINAL, MoveRules, Moves, all_targets, reachable_share
from mjforage.mission.resolver import Corruption, Resolver
from mjforage.mission.setup import Setup
from mjforage.mission.task import NEVER
from mjforage.physics.worlds import create_mission
from mjforage.scenario.roles import Fleet, Role
from mjforage.scenario.scenario_file import load_scenario
from tests.graph_planner.charts import grid
from tests.graph_planner.driver import task_of
from tests.mjforage.mission.test_moves import E, N, S, resolve, where

JUMP = MoveRules(stay=False, shorten=False, jump=True)
SCOUT, FORAGER = Role(1, 2, 4.0, False), Role(1, 1, 1.0, True)
QUAY = navigation_graph(grid(".#...", ".#...", ".#..#"), 1.0, True)


def test_a_move_tests_its_end_node_only() -> None:
    """From (0, 0) two nodes east cross the quay; from (2, 2) they end on land, and are illegal."""
    assert where(QUAY, resolve(QUAY, {"scouts": SCOUT}, [(0, 0)], [[E]], JUMP), 0) == (0, 2)
    assert where(QUAY, resolve(QUAY, {"scouts": SCOUT}, [(2, 2)], [[E, N]], JUMP), 0) == (0, 2)
    beside = {"scouts": SCOUT, "foragers": FORAGER}
    over = resolve(QUAY, beside, [(0, 2), (1, 3)], [[E], [N]], JUMP)
    assert [where(QUAY, over, a) for a in (0, 1)] == [(0, 4), (0, 3)] and over.steps[0, 0] == 2
    closed = resolve(QUAY, beside, [(0, 2), (1, 4)], [[E, S], [N]], JUMP)
    assert [where(QUAY, closed, a) for a in (0, 1)] == [(2, 2), (0, 4)]


def test_a_move_across_land_needs_the_energy_of_its_length() -> None:
    moves = resolve(QUAY, {"scouts": SCOUT}, [(0, 0)], [[E, S]], JUMP, energy=1.9)
    assert moves.blocked[0, 0] and moves.steps[0, 0] == 0


def final(
    roles: dict[str, Role],
    cells: list[tuple[int, int]],
    wanted: list[int],
    rules: MoveRules,
    energy: float = np.inf,
) -> Moves:
    """Resolve one final move of each agent."""
    preferences, fleet = np.zeros((1, len(cells), 9)), Fleet.of(roles)
    for agent, move in enumerate(wanted):
        preferences[0, agent, move] = FINAL
    return Resolver(QUAY, fleet, rules, Corruption(np.zeros(len(cells))))(
        np.ones(1, np.bool_),
        preferences,
        np.array([[QUAY.node_of_cell[cell] for cell in cells]], np.int32),
        np.full((1, len(cells)), energy),
        np.zeros((1, len(QUAY)), np.int16),
        np.ones(1, np.int32),
        np.zeros(1, np.uint64),
    )


def test_a_final_move_may_share_a_node_and_counts_its_way_where_it_is_blocked() -> None:
    both = {"scouts": SCOUT, "foragers": FORAGER}
    shared = final(both, [(0, 2), (1, 4)], [E, N], JUMP)
    assert [where(QUAY, shared, a) for a in (0, 1)] == [(0, 4), (0, 4)]
    assert not shared.blocked.any() and shared.steps.tolist() == [[2, 1]]
    stayed = final(both, [(2, 2), (1, 4)], [E, S], JUMP)
    assert [where(QUAY, stayed, a) for a in (0, 1)] == [(2, 2), (1, 4)]
    assert stayed.blocked.all() and stayed.steps.tolist() == [[2, 1]]
    assert stayed.direction.tolist() == [[E, S]]


def test_a_final_move_needs_the_energy_of_its_length() -> None:
    moves = final({"scouts": SCOUT}, [(0, 0)], [E], JUMP, energy=1.9)
    assert moves.blocked[0, 0] and moves.steps[0, 0] == 0


def test_without_jumps_a_final_move_is_one_like_any() -> None:
    moves = final({"scouts": SCOUT}, [(0, 0)], [E], MoveRules(False, False))
    assert where(QUAY, moves, 0) == (2, 0)


def test_targets_masks_ways_and_reach_follow_the_rule() -> None:
    """Against every move of every node worked out by its cells."""
    task = task_of(QUAY, JUMP, scouts=SCOUT, foragers=FORAGER)
    nodes = np.arange(len(QUAY), dtype=np.int32)
    mask = LegalMoves(task)(np.stack((nodes, nodes), 1), np.full((len(QUAY), 2), np.inf))
    number, targets = all_targets(QUAY, task.fleet.moves, JUMP)
    for agent, stride in enumerate((2, 1)):
        ends = ways_of(QUAY, stride, JUMP).ends
        for node in nodes:
            about = task.arrays, np.zeros(0, np.int64), -1, agent, int(node)
            alone, tired = legal_of_agent(*about, np.inf), legal_of_agent(*about, stride - 0.1)
            assert tired.nonzero()[0].tolist() == [STAY]
            for move in range(8):
                row = QUAY.rows[node] + stride * OFFSETS[move, 0]
                col = QUAY.cols[node] + stride * OFFSETS[move, 1]
                inside = 0 <= row < 3 and 0 <= col < 5
                end = QUAY.node_of_cell[row, col] if inside else -1
                assert targets[number[agent], node, move] == ends[node, move] == end
                assert mask[node, agent, move] == alone[move] == (end >= 0)
            assert targets[number[agent], node, STAY] == -1
    first = QUAY.node_of_cell[0, 0]
    assert reachable_share(QUAY, first, 1, JUMP) == pytest.approx(3 / 11)  # the quay is too wide
    assert reachable_share(QUAY, first, 2, JUMP) == pytest.approx(5 / 11)


def test_a_blocked_move_counts_as_way_in_a_mission() -> None:
    mission = Mission(
        Setup.of(load_scenario("published-2025", ("map.file=open_bay", "map.starts=[]")))
    )
    mission.reset(0, np.arange(1))
    wanted = np.zeros((1, 4, 9))
    wanted[..., N] = FINAL
    for _ in range(60):
        mission.advance(wanted)
    assert mission.state.distance[0].tolist() == [120.0, 120.0, 60.0, 60.0]
    assert len(set(mission.state.agent_node[0].tolist())) <= 4


def test_the_view_at_the_start_is_believed_but_unseen_until_the_first_step() -> None:
    missions = []
    for seen in ("true", "false"):
        missions.append(
            Mission(Setup.of(load_scenario("published-2025", (f"rules.start_seen={seen}",))))
        )
        missions[-1].reset(0, np.arange(40))
    known, unseen = (mission.observation for mission in missions)
    assert known.belief.any() and known.belief.tobytes() == unseen.belief.tobytes()
    assert (known.last_seen == 0).any() and (unseen.last_seen == NEVER).all()
    for mission in missions:
        mission.advance(np.zeros((40, 4, 9)))
    seen_now = [mission.observation.last_seen == 1 for mission in missions]
    assert seen_now[1].any() and (seen_now[0] == seen_now[1]).all()
    again = missions[1].restart(np.array([2]), missions[1].keys[2:3])
    assert again.n_items.size == 1
    assert (missions[1].observation.last_seen[2] == NEVER).all()
    assert (missions[1].observation.last_seen[1] == 1).any()


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (("rules.shorten=true",), "rules.jump = true with rules.shorten"),
        (("link.model=disk",), 'rules.start_seen = false with link.model = "disk"'),
    ],
)
def test_rules_that_contradict_each_other_are_refused(changes: tuple[str, ...], words: str) -> None:
    with pytest.raises(UserError, match=words):
        load_scenario("published-2025", changes)


def test_hulls_do_not_jump() -> None:
    setup = Setup.of(load_scenario("published-2025"))
    with pytest.raises(UserError, match="hulls cannot cross land; use the graph world"):
        create_mission(setup, "physics")
