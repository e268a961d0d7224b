"""Metres and compass words of missions in both worlds: what is told, logged and recorded."""

from pathlib import Path

import numpy as np
import pytest

from mjforage.mission.dynamics import ARRIVED
from mjforage.mission.episode_log import EpisodeLog
from mjforage.physics.worlds import create_mission
from tests.mjforage.mission.hands import (
    PERIOD_S,
    PITCH_M,
    TOWARD,
    amidst,
    sea,
)

BOTH = pytest.mark.parametrize("world", ["graph", "physics"])
WIND_M = 0.03 * 4.0 * PERIOD_S  # in a decision, of an item in a wind of 4 m/s
STAYS = np.eye(9)[None, None, 8]


@BOTH
def test_a_mission_tells_how_wind_and_current_carry_items(world: str, tmp_path: Path) -> None:
    """To the north-east at 0.03 of 4 m/s, and with hulls by 0.97 of 0.1 m/s more to the east."""
    wind = ("weather.wind_speed_mps=4", "weather.wind_from_deg=225")
    current = ("weather.current_speed_mps=0.1", "weather.current_toward_deg=0")
    setup = sea(tmp_path, *wind, *current)
    mission = create_mission(setup, world)
    mission.reset(0, np.array([amidst(setup)]))
    each = WIND_M / PITCH_M * np.sqrt(0.5)
    flow = 0.97 * 0.1 * PERIOD_S / PITCH_M if world == "physics" else 0.0
    truth = mission.truth
    assert truth.drift_rc[0] == pytest.approx([-each, each + flow], abs=0.06)
    west = setup.graph.node_of_cell[15, 2]  # where the hook does not turn the stream
    assert mission.node_drift_rc[0, west] == pytest.approx([-each, each + flow], abs=0.06)
    here = mission.state.item_node[0, 0]  # whose centre the item is on
    assert mission.node_drift_rc[0, here] == pytest.approx(truth.drift_rc[0], rel=1e-5)
    before = mission.state.item_rc[0, 0].copy()
    mission.advance(STAYS)
    assert mission.state.item_rc[0, 0] - before == pytest.approx([-each, each + flow], abs=0.1)


@BOTH
def test_a_move_ends_where_its_compass_word_says(world: str, tmp_path: Path) -> None:
    setup = sea(tmp_path)
    mission = create_mission(setup, world)
    mission.reset(0, np.full(8, amidst(setup)))
    log = EpisodeLog(mission)
    log.see(mission)
    mission.advance(np.eye(9)[:8, None])
    log.see(mission)
    steps = np.array(list(TOWARD.values()), np.float64)
    near = 0.0 if world == "graph" else 0.3
    moved = log.agent_rc[:, 1, 0] - (15, 8)
    assert moved == pytest.approx(np.stack((-steps[:, 1], steps[:, 0]), axis=1), abs=near)
    assert (mission.state.outcome == ARRIVED).all()
    assert log.direction[:, 1, 0].tolist() == list(range(8))
    cells = [(setup.graph.rows[n], setup.graph.cols[n]) for n in log.target[:, 1, 0]]
    assert cells == [(15 - north, 8 + east) for east, north in steps.tolist()]
    np.testing.assert_array_equal(log.agent_node[:, 1], log.target[:, 1])
    assert mission.state.distance[:, 0] == pytest.approx(
        np.hypot(*steps.T), abs=0.5 if world == "physics" else 0.0
    )
    if world == "graph":  # headings counter-clockwise from east
        to_go = np.degrees(log.yaw[:, 1, 0])
        assert to_go % 360.0 == pytest.approx([90.0, 45.0, 0.0, 315.0, 270.0, 225.0, 180.0, 135.0])
