"""What a scenario's numbers come to in missions: random moves, scans, ranges."""

from pathlib import Path

import numpy as np
import pytest

from mjforage.mission.mission import Mission
from mjforage.mission.setup import Setup
from tests.mjforage.mission.hands import NAMES, amidst, sea, told

TEAMS = ("team.pilots.count=2", "team.skimmers.count=2")
STARTS = "map.starts=[[15, 8], [15, 12], [9, 8], [9, 12]]"


@pytest.mark.parametrize(("team", "places"), [("pilots", [0, 1]), ("skimmers", [2, 3])])
def test_the_team_that_is_named_is_corrupted(team: str, places: list[int], tmp_path: Path) -> None:
    """All want to go east: those do, but whom chance moves goes there once in nine times."""
    choice = (f"corruption.team={team}", "corruption.epsilon=1")
    setup = sea(tmp_path, *TEAMS, STARTS, *choice)
    assert setup.fleet.names == ("pilots_0", "pilots_1", "skimmers_0", "skimmers_1")
    assert np.flatnonzero(setup.corruption.epsilon).tolist() == places
    mission = Mission(setup)
    mission.reset(0, np.arange(90))
    east = np.eye(9)[np.full((90, 4), NAMES.index("E"))]
    to_east = (mission.decide(east).direction == NAMES.index("E")).mean(axis=0)
    true = [k for k in range(4) if k not in places]
    assert (to_east[true] == 1.0).all()
    assert (to_east[places] < 0.3).all()


def test_an_epsilon_is_the_share_of_corrupted_decisions(tmp_path: Path) -> None:
    """One in four is drawn from nine moves: 3/4 + 1/36 = 7/9 go where they want, of 2000."""
    choice = ("corruption.team=pilots", "corruption.epsilon=0.25")
    mission = Mission(sea(tmp_path, *choice))
    mission.reset(0, np.arange(2000))
    moves = mission.decide(np.eye(9)[np.full((2000, 1), NAMES.index("W"))])
    share = (moves.direction == NAMES.index("W")).mean()
    assert abs(share - 7 / 9) < 4 * np.sqrt(7 / 9 * 2 / 9 / 2000)


def _pair(tmp_path: Path, apart: int, *overrides: str) -> Setup:
    """Two pilots, so many nodes to the east of each other."""
    starts = f"map.starts=[[15, 8], [15, {8 + apart}]]"
    return sea(tmp_path, "team.pilots.count=2", starts, *overrides)


@pytest.mark.parametrize(("apart", "received"), [(6, True), (7, False)])
def test_a_radio_reaches_metres(apart: int, received: bool, tmp_path: Path) -> None:
    """31 m, 6.2 nodes of 5 m: what one has just seen is known to the other, or not."""
    setup = _pair(tmp_path, apart, "link.model=disk", "link.range_m=31")
    assert setup.task.reach_node == pytest.approx(6.2)
    mission = Mission(setup)
    mission.reset(0, np.array([amidst(setup)]))
    told(mission, "stay", "stay")
    beyond = setup.graph.node_of_cell[17, [8, 8 + apart]]  # in view of one of them
    known = mission.held.last_seen[:, beyond] >= 0
    assert known.sum() == (4 if received else 2)
    assert known[[0, 1]].any(axis=1).all()


def test_a_field_of_view_is_in_degrees_about_the_bow(tmp_path: Path) -> None:
    """After a move to the north, 60 degrees of view: what is up to 30 degrees off the bow."""
    setup = sea(tmp_path, "sensors.fov_deg=60")
    mission = Mission(setup)
    mission.reset(0, np.array([amidst(setup)]))
    for _ in range(2):
        told(mission, "N")
    row, col = 13, 8
    around = [(row - 3, col), (row, col + 3), (row + 3, col), (row, col - 3)]
    around += [(row - 2, col + 1), (row - 2, col + 2)]  # 27 and 45 degrees to starboard
    nodes = [setup.graph.node_of_cell[cell] for cell in around]
    seen = mission.knowledge.last_seen[0, nodes] == 2
    assert seen.tolist() == [True, False, False, False, True, False]
