"""One item, one vessel, one wind and one current in both worlds, in metres and compass words."""

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.base.randomness import episode_keys
from mjforage.graph_planner.graph.navigation import COMPASS, STAY
from mjforage.mission.dynamics import ARRIVED, LATE, Dynamics, Transition
from mjforage.mission.episode_log import EpisodeLog
from mjforage.mission.moves import Moves
from mjforage.mission.trajectory import TrajectoryRecorder
from mjforage.physics.worlds import WORLDS, create_mission
from mjforage.scenario.roles import Role
from mjforage.scenario.scenario import MapChoice, Weather
from tests.mjforage.mission.by_hand import (
    CALM,
    EAST,
    NORTH,
    PERIOD_S,
    PITCH_M,
    SOUTH,
    WEST,
    by_hand,
)

SEA = np.ones((9, 15), np.bool_)
ITEM = np.array([3.0, 9.25])  # row, column: 46.25 m to the east, 25 m to the north
START = (5, 4)  # of the vessel: 20 m to the east, 15 m to the north
TABLES: dict[str, Any] = {
    "map": MapChoice("sea", pitch_m=PITCH_M, starts=(START,)),
    "team": {"team": Role(count=1, moves=2, radius=2.5, collects=False)},
}
FROM = {"north": 0.0, "east": 90.0, "south": 180.0, "west": 270.0}
PUSHED = {"north": SOUTH, "east": WEST, "south": NORTH, "west": EAST}
TOWARD = FROM  # of a current: the bearing that it flows to
AXES = {"north": NORTH, "east": EAST, "south": SOUTH, "west": WEST}
HEADS = {  # compass word -> (x, y) of a move of a node, yaw [degrees counter-clockwise from east]
    "N": ((0.0, 1.0), 90.0),
    "NE": ((1.0, 1.0), 45.0),
    "E": ((1.0, 0.0), 0.0),
    "SE": ((1.0, -1.0), -45.0),
    "S": ((0.0, -1.0), -90.0),
    "SW": ((-1.0, -1.0), -135.0),
    "W": ((-1.0, 0.0), 180.0),
    "NW": ((-1.0, 1.0), 135.0),
}


class Played(NamedTuple):
    """Some decisions of one vessel and one item."""

    dynamics: Dynamics
    state: Transition
    trajectory: TrajectoryRecorder

    def carried(self, frames: int) -> NDArray[np.float64]:
        """(x, y) by which the item went in the trajectory's last frames [m]."""
        way: NDArray[np.float64] = (
            self.trajectory.frames.items[-1, 0] - self.trajectory.frames.items[-1 - frames, 0]
        )
        return way


def played(
    world: str,
    weather: Weather = CALM,
    direction: int = STAY,
    decisions: int = 1,
    period_s: float = 8.0,
    collects: bool = False,
    item: NDArray[np.float64] = ITEM,
) -> Played:
    team = {"team": replace(TABLES["team"]["team"], collects=collects)}
    setup = by_hand(SEA, map=TABLES["map"], team=team, weather=weather, period_s=period_s)
    kind, trajectory, keys = WORLDS[world], TrajectoryRecorder(), episode_keys(0, np.arange(1))
    dynamics = kind.dynamics(setup.graph, setup.fleet, kind.adapt(setup.scenario), trajectory, None)
    initial = setup.create_initial_state(keys)
    node = setup.graph.node_of_cell[int(item[0]), int(item[1])]
    initial = replace(initial, item_rc=item[None, None], item_node=np.array([[node]], np.int32))
    state = dynamics.reset(initial, keys, ["0"])
    for step in range(1, decisions + 1):
        node = int(state.agent_node[0, 0])
        target, steps = node, 0
        while direction != STAY and steps < 2:
            target, steps = int(setup.graph.neighbours[target, direction]), steps + 1
        moves = Moves(
            np.array([[direction]], np.int8),
            np.array([[target]], np.int32),
            np.array([[steps]], np.int8),
            np.array([[False]]),
        )
        state = dynamics.advance(np.array([True]), np.array([step], np.int32), moves)
    return Played(dynamics, state, trajectory)


def frames_of(world: str) -> int:
    """Frames of a decision of 8 s: one in the graph, one every half second with hulls."""
    return 1 if world == "graph" else 16


@pytest.mark.parametrize("world", ["graph", "physics"])
@pytest.mark.parametrize("origin", FROM)
def test_a_wind_carries_an_item_away_from_where_it_blows(world: str, origin: str) -> None:
    """4 m/s for 8 s at 0.03 of it: 0.96 m, 0.192 node of 5 m; no drift blows beside a wind."""
    weather = replace(CALM, wind_speed_mps=4.0, wind_from_deg=FROM[origin], drift_node_per_step=0.1)
    found, (x, y) = played(world, weather, decisions=2), PUSHED[origin]
    exact = 1e-5 if world == "graph" else 0.02  # films have 32 bits; an item gathers speed
    np.testing.assert_allclose(found.carried(frames_of(world)), (0.96 * x, 0.96 * y), atol=exact)
    gone = found.state.item_rc[0, 0] - ITEM
    np.testing.assert_allclose(gone, (-2 * 0.192 * y, 2 * 0.192 * x), atol=0.03)
    told = found.dynamics.drift_rc(ITEM[None, None])[0, 0]
    np.testing.assert_allclose(told, (-0.192 * y, 0.192 * x), atol=1e-9)
    np.testing.assert_allclose(found.trajectory.frames.wind[-1], (4.0 * x, 4.0 * y), atol=1e-6)


@pytest.mark.parametrize("direction", TOWARD)
def test_a_current_carries_an_item_where_it_flows_to(direction: str) -> None:
    """0.2 m/s for 8 s in still air, which holds 0.03 of it back: 1.552 m, 0.3104 node of 5 m."""
    weather = replace(CALM, current_speed_mps=0.2, current_to_deg=TOWARD[direction])
    found, (x, y) = played("physics", weather, decisions=2), AXES[direction]
    np.testing.assert_allclose(found.carried(16), (1.552 * x, 1.552 * y), atol=0.02)
    told = found.dynamics.drift_rc(ITEM[None, None])[0, 0]
    np.testing.assert_allclose(told, (-0.3104 * y, 0.3104 * x), atol=1e-4)
    np.testing.assert_array_equal(found.trajectory.frames.wind[-1], (0.0, 0.0))
    np.testing.assert_array_equal(played("graph", weather).state.item_rc[0, 0], ITEM)


def test_what_is_told_of_a_current_that_wanders_is_that_of_the_decision_to_come() -> None:
    weather = replace(CALM, current_speed_mps=0.05, current_wander_mps=0.2)
    now, then = (played("physics", weather, decisions=count) for count in (5, 6))
    x, y = then.carried(16) / PITCH_M
    np.testing.assert_allclose(now.dynamics.drift_rc(ITEM[None, None])[0, 0], (-y, x), atol=0.03)


def test_the_noise_of_an_item_is_that_of_the_graph_in_every_decision() -> None:
    """The same draw moves its water for 4 s, and the item comes up to 0.97 of that speed."""
    weather = replace(CALM, noise_node_per_step=0.5)
    graph, physics = (
        played(world, weather, decisions=3, period_s=4.0).trajectory.frames.items[:, 0]
        for world in ("graph", "physics")
    )
    noise = np.diff(graph, axis=0)  # of each decision [m]
    ends = physics[8::8] - physics[7::8]  # in its last half second
    np.testing.assert_allclose(8.0 * ends, 0.97 * noise, atol=0.1)
    assert np.abs(np.diff(noise, axis=0)).max(axis=1).min() > 0.5


@pytest.mark.parametrize("side", AXES)
@pytest.mark.parametrize("water", [False, True])
def test_wind_and_current_push_a_vessel_that_stays_at_first(side: str, water: bool) -> None:
    blown, borne = {toward: origin for origin, toward in PUSHED.items()}, TOWARD[side]
    wind = replace(CALM, wind_speed_mps=8.0, wind_from_deg=FROM[blown[AXES[side]]])
    weather = replace(CALM, current_speed_mps=0.3, current_to_deg=borne) if water else wind
    pushed = played("physics", weather).trajectory.frames.pose[2, 0, :2] - (20.0, 15.0)
    x, y = AXES[side]
    along, aside = pushed[0] * x + pushed[1] * y, pushed[0] * y - pushed[1] * x
    assert along > 0.01
    assert abs(aside) < 0.3 * along


@pytest.mark.parametrize("world", ["graph", "physics"])
@pytest.mark.parametrize("word", HEADS)
def test_a_move_of_two_nodes_takes_a_vessel_ten_metres_that_way(world: str, word: str) -> None:
    found = played(world, direction=COMPASS.index(word), period_s=20.0)
    (x, y), degrees = HEADS[word]
    pose, exact = found.trajectory.frames.pose[-1, 0], 1e-5 if world == "graph" else 1.0
    np.testing.assert_allclose(pose[:2], (20.0 + 10.0 * x, 15.0 + 10.0 * y), atol=exact)
    np.testing.assert_allclose(found.state.agent_rc[0, 0], (5 - 2 * y, 4 + 2 * x), atol=0.2)
    length = 2.0 * np.hypot(x, y)  # in nodes, as the log and the energy have it
    for told in (found.state.distance, found.state.energy, found.state.agent_speed):
        assert told[0, 0] == pytest.approx(length, abs=1e-9 if world == "graph" else 0.3)
    if (world, word) == ("physics", "W"):
        degrees = 0.0  # where a vessel's bow is at the start: it goes astern
    for yaw in (pose[2], found.state.agent_yaw[0, 0]):
        off = np.angle(np.exp(1j * (yaw - np.radians(degrees))))
        assert abs(off) < (1e-6 if world == "graph" else 0.5)
    assert found.trajectory.interval_s == (20.0 if world == "graph" else 0.5)


@pytest.mark.parametrize("world", ["graph", "physics"])
def test_ways_add_up_and_speeds_do_not(world: str) -> None:
    state = played(world, direction=COMPASS.index("E"), decisions=2, period_s=20.0).state
    exact = 1e-9 if world == "graph" else 0.3
    assert [state.distance[0, 0], state.energy[0, 0]] == pytest.approx([4.0, 4.0], abs=2 * exact)
    assert state.agent_speed[0, 0] == pytest.approx(2.0, abs=exact)


@pytest.mark.parametrize("world", ["graph", "physics"])
@pytest.mark.parametrize("collects", [False, True])
def test_a_vessel_takes_the_item_of_its_node_if_it_collects(world: str, collects: bool) -> None:
    found = played(world, collects=collects, item=np.array([5.25, 4.25]))
    assert found.state.collected_by.tolist() == [[0 if collects else -1]]
    assert (found.state.item_node[0, 0] == -1) == collects
    assert found.trajectory.frames.present[:, 0].tolist()[-1] != collects


@pytest.mark.parametrize("world", ["graph", "physics"])
def test_a_mission_tells_how_wind_and_current_carry_items(world: str) -> None:
    """Northwards at 0.03 of 4 m/s, and with hulls by 0.97 of 0.1 m/s to the east as well."""
    weather = replace(CALM, wind_speed_mps=4.0, wind_from_deg=180.0)
    weather = replace(weather, current_speed_mps=0.1, current_to_deg=90.0)
    setup = by_hand(SEA, weather=weather, **TABLES)
    mission = create_mission(setup, world)
    mission.reset(0, np.arange(1))
    flow = 0.97 * 0.1 * PERIOD_S / PITCH_M if world == "physics" else 0.0
    node = setup.graph.node_of_cell[4, 9]
    assert mission.node_drift_rc[0, node] == pytest.approx([-0.192, flow], abs=1e-3)
    assert mission.truth.drift_rc[0] == pytest.approx([-0.192, flow], abs=0.06)


@pytest.mark.parametrize("world", ["graph", "physics"])
def test_a_move_is_logged_as_its_compass_word_says(world: str) -> None:
    setup = by_hand(SEA, period_s=20.0, **TABLES)
    mission = create_mission(setup, world)
    mission.reset(0, np.arange(8))
    log = EpisodeLog(mission)
    log.see(mission)
    mission.advance(np.eye(9)[:8, None])
    log.see(mission)
    (x, y), degrees = np.array([HEADS[w][0] for w in COMPASS[:8]]).T, [HEADS[w][1] for w in HEADS]
    near = 0.0 if world == "graph" else 0.3
    ends = np.stack((START[0] - 2 * y, START[1] + 2 * x), axis=1)
    assert log.agent_rc[:, 1, 0] == pytest.approx(ends, abs=near)
    assert (mission.state.outcome == ARRIVED).all()
    assert log.direction[:, 1, 0].tolist() == list(range(8))
    targets = [(setup.graph.rows[n], setup.graph.cols[n]) for n in log.target[:, 1, 0]]
    assert targets == [tuple(end) for end in ends.tolist()]
    np.testing.assert_array_equal(log.agent_node[:, 1], log.target[:, 1])
    if world == "graph":
        assert np.degrees(log.yaw[:, 1, 0]) % 360.0 == pytest.approx(np.array(degrees) % 360.0)


def test_a_hull_that_comes_too_late_is_logged_with_the_node_it_was_sent_to() -> None:
    setup = by_hand(SEA, period_s=2.0, **TABLES)
    mission = create_mission(setup, "physics")
    mission.reset(0, np.arange(1))
    log = EpisodeLog(mission)
    log.see(mission)
    mission.advance(np.eye(9)[[COMPASS.index("E")], None])
    log.see(mission)
    sent = setup.graph.node_of_cell[START[0], START[1] + 2]
    assert log.outcome[0, 1, 0] == LATE and log.target[0, 1, 0] == sent != log.agent_node[0, 1, 0]
