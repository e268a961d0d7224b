"""Missed detections and false positives of scans, by the numbers of the formulas."""

from dataclasses import replace

import numpy as np
import pytest

from mjforage.base.errors import UserError
from mjforage.graph_planner.graph.visibility import disc_offsets
from mjforage.mission.sensors.detection import chances_by_square, corrected
from mjforage.scenario.roles import Role
from mjforage.scenario.scenario_file import load_scenario
from mjforage.scenario.sensors import Sensors
from tests.mjforage.mission.watching import Watched, task_of

SCOUT = Role(count=1, moves=1, radius=4.0, collects=False)
FORAGER = Role(count=1, moves=1, radius=4.0, collects=True)
SEA = task_of((9, 9), scouts=SCOUT)
MIDDLE, EAST, NORTH, FAR_EAST = 40, 41, 31, 44  # nodes of a sea of 9 x 9
MANY = 4000


def error(p: float) -> float:
    """Four standard errors of a share of many episodes."""
    return float(4.0 * np.sqrt(p * (1.0 - p) / MANY))


def found(watched: Watched) -> float:
    return float((watched.ledger.t_discovered[:, 0] >= 0).mean())


def test_perfect_is_what_shows_all() -> None:
    assert Sensors().perfect and Sensors(position_noise_m=1.0, persistence=0.3).perfect
    one_each = (
        Sensors(detection=0.9),
        Sensors(half_range_node=3.0),
        Sensors(detection_table=((0.0, 1.0),)),
        Sensors(false_rate=0.1),
        Sensors(merge=0.1),
        Sensors(fov_deg=359.0),
    )
    assert not any(one.perfect for one in one_each)


def test_three_scans_at_an_item() -> None:
    """1 - .3^3 = .973; with persistence .3 1 - prod (b + j)/(a + b + j) = .9047, a + b = 7/3."""
    for persistence, expected in ((0.0, 0.973), (0.3, 0.9047)):
        sensors = Sensors(detection=0.7, persistence=persistence)
        for scans, share in ((1, 0.7), (3, expected)):
            seen = found(Watched(SEA, sensors, [MIDDLE], [EAST], scans - 1, MANY))
            assert abs(seen - share) < error(share), (persistence, scans, seen)


def test_items_hard_to_see_stay_so_by_a_table_too() -> None:
    """As above, where a scenario has .7 at any distance in a table; not where all are seen."""
    persistence = "sensors.persistence=0.3"
    table = load_scenario("comb-port", ["sensors.detection_table=[[0,0.7],[9,0.7]]", persistence])
    seen = found(Watched(SEA, table.sensors, [MIDDLE], [EAST], 2, MANY))
    assert abs(seen - 0.9047) < error(0.9047)
    sure = ["sensors.detection=0.5", "sensors.detection_table=[[0,1],[9,0.5]]", persistence]
    with pytest.raises(UserError, match="with the same chance of 1 near by"):
        load_scenario("comb-port", sure)


def test_detection_falls_with_the_distance() -> None:
    """p0 / (1 + exp((d - half) / slope)): half of p0 at half, .8 / (1 + e) a slope beyond."""
    chance = chances_by_square(17, 0.8, 2.0, 1.0)
    assert chance[4] == pytest.approx(0.4) and chance[9] == pytest.approx(0.8 / (1.0 + np.exp(1.0)))
    sensors = Sensors(detection=0.8, half_range_node=2.0)
    for node, expected in ((MIDDLE + 2, 0.4), (MIDDLE - 3 * 9, 0.21515)):
        seen = found(Watched(SEA, sensors, [MIDDLE], [node], 0, MANY))
        assert abs(seen - expected) < error(expected)
    assert chances_by_square(2, 0.5, 1e4, 1e-3).tolist() == [0.5, 0.5], "no overflow"


def test_a_table_is_linear_between_its_rows_and_constant_beyond() -> None:
    chance = chances_by_square(17, 1.0, 0.0, 1.0, ((1.0, 0.8), (3.0, 0.2)))
    assert chance[[0, 1, 4, 9, 16]] == pytest.approx([0.8, 0.8, 0.5, 0.2, 0.2])
    sensors = Sensors(detection_table=((1.0, 0.8), (3.0, 0.2)))
    seen = found(Watched(SEA, sensors, [MIDDLE], [MIDDLE + 2], 0, MANY))
    assert abs(seen - 0.5) < error(0.5)


@pytest.mark.parametrize("fov, nodes", [(360, 49), (180, 29), (90, 15), (75, 11), (0, 5)])
def test_nodes_in_a_field_of_view_about_the_heading(fov: float, nodes: int) -> None:
    offsets = disc_offsets(4.0, (9, 9))
    for yaw, ahead, side in ((0.0, (0, 1), (1, 0)), (np.pi / 2, (-1, 0), (0, 1))):
        sensors = Sensors(fov_deg=fov, detection=0.999)
        watched = Watched(SEA, sensors, [MIDDLE], [MIDDLE], 0, 1, yaw)
        seen = watched.shown[0][0, 0] >= 0
        assert seen.sum() == nodes
        along, across = offsets @ ahead, np.abs(offsets @ side)
        assert seen[(along == 0) & (across == 0)].all(), "its own node"
        if 0 < fov < 180:
            assert (along[seen] >= 0).all() and seen[(across == 0) & (along > 0)].all()
        known = watched.knowledge.last_seen[0] == 0
        assert known.sum() == nodes, "what is behind it was not looked at"


def test_a_filtered_map_by_hand() -> None:
    """75 items on 81 nodes, p .5: nothing seen leaves half; one seen is then believed in."""
    assert corrected(0.8, 0.5, 0.0, 0) == pytest.approx(0.4)
    assert corrected(0.8, 0.5, 0.1, 2) == pytest.approx(0.4 + 2 * 0.4 / 0.5)
    assert corrected(0.0, 1.0, 0.0, 3) == 3.0, "what is seen is there if nothing is invented"
    sensors = Sensors(detection=0.5, map="filtered")
    watched = Watched(SEA, sensors, [MIDDLE], [EAST], 3, 50)
    place = 1 + SEA.views.of(MIDDLE).tolist().index(EAST)
    for e in range(50):
        density = 75.0 / 81.0
        for shown in watched.shown:
            density = 0.5 * density + float(shown[e, 0, place - 1] > 0)
        assert watched.knowledge.belief[e, EAST] == int(density + 0.5)
    assert (watched.knowledge.belief[:, 0] == 0).all(), "nothing is believed of what nobody saw"
    sensors = Sensors(detection_table=((1.0, 0.9), (2.0, 0.1)), map="filtered")
    task = task_of((5, 5), scouts=replace(SCOUT, count=2))  # 3 items expected in each node
    for at in ([11, 14], [14, 11]):
        belief = Watched(task, sensors, at, [-1], 0, 1).knowledge.belief[0]
        assert belief[[6, 12, 13]].tolist() == [0, 0, 0], "the nearer scan counts"


@pytest.mark.parametrize(
    "override, words",
    [
        ("sensors.detection_table=[[0,1],[0,0.5]]", r"detection_table: \[0, 0.5\] after \[0, 1\]"),
        ("sensors.detection_table=[[0,0.5],[2,0.9]]", "chances that do not grow"),
        ("sensors.half_range_node=-1", "sensors.half_range_node = -1 should be "),
        ("sensors.map=best", "sensors.map"),
        ("sensors.map=filtered", "but scans are perfect"),
        ("sensors.persistence=0.3", "with the same chance of 1 near by"),
        ("sensors.false_hold=0", "sensors.false_hold = 0 should be "),
    ],
)
def test_what_cannot_be_sensed_so_is_refused(override: str, words: str) -> None:
    with pytest.raises(UserError, match=words):
        load_scenario("comb-port", [override])


def test_a_table_and_a_half_range_are_one_too_many() -> None:
    overrides = ["sensors.detection_table=[[0,1],[3,0.5]]", "sensors.half_range_node=2"]
    with pytest.raises(UserError, match="give one of them"):
        load_scenario("comb-port", overrides)
