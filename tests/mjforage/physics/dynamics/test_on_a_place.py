"""Missions on a place whose quays follow its outline."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely

import mjforage as mf
from mjforage.controllers import Chart
from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.graph_planner.policies import create_policy
from mjforage.mission.dynamics import BLOCKED
from mjforage.mission.mission import Mission, Observer
from mjforage.mission.setup import Setup
from mjforage.mission.trajectory import TrajectoryRecorder
from mjforage.physics.dynamics.berths import Turn, berths
from mjforage.physics.dynamics.touch import touches
from mjforage.physics.run_warnings import run_warnings
from mjforage.physics.scene.quays import walls_of
from mjforage.physics.vessels import load_vessel
from mjforage.physics.worlds import create_mission
from mjforage.scenario.maps import GridMap
from mjforage.scenario.place import Place

MARINA = Path(__file__).parents[4] / "examples/places/marina.geojson"
TURN = Turn(1.34, 0.74)  # of a forager


@pytest.fixture(scope="module")
def marina(tmp_path_factory: pytest.TempPathFactory) -> tuple[GridMap, Place]:
    found = mf.Map.of_chart(MARINA, tmp_path_factory.mktemp("places") / "marina", rotate="auto")
    assert found.place is not None
    return GridMap(found.name, found.water, found.place), found.place


def land_in(place: Place) -> shapely.Geometry:
    land = shapely.Polygon()
    for ring in place.quays:
        land = land.symmetric_difference(shapely.Polygon(ring))
    shapely.prepare(land)
    return land


class _Outcomes(Observer):
    def __init__(self) -> None:
        self.outcome: list[object] = []

    def see(self, mission: Mission) -> None:
        self.outcome.append(mission.state.outcome.copy())


def test_a_mission_in_a_marina(marina: tuple[GridMap, Place]) -> None:
    """Four vessels among pontoons: none is held, no hull and no item comes onto the land."""
    grid, place = marina
    basic = mf.load_scenario("comb-port").scenario
    scenario = replace(basic, map=replace(basic.map, starts=None, pitch_m=4.0), horizon=60)
    setup, tracks, seen = Setup(scenario, grid), TrajectoryRecorder(), _Outcomes()
    mission = create_mission(setup, "physics", tracks)
    mission.reset(1, np.arange(1))
    mission.run(create_policy("greedy"), (seen,))
    assert len(setup.fleet) == 4
    assert not (np.array(seen.outcome[1:]) == BLOCKED).any()
    pose, land = tracks.frames.pose.astype(float), land_in(place)
    names = [scenario.physics.vessels.get(name, name) for name in ("scout", "forager")]
    least = min((load_vessel(name) for name in names), key=lambda one: one.beam_m)
    ahead = np.stack((np.cos(pose[..., 2]), np.sin(pose[..., 2])), axis=-1)
    corners = [
        pose[..., :2] + a * least.length_m * ahead + b * least.beam_m * ahead[..., ::-1] * [-1, 1]
        for a, b in ((0.5, 0.5), (0.5, -0.5), (-0.5, -0.5), (-0.5, 0.5))
    ]
    hulls = shapely.polygons(np.stack(corners, axis=-2))
    assert not shapely.intersects(land, hulls).any()
    items = tracks.frames.items[tracks.frames.present].astype(float)
    assert len(items) > 100
    assert not shapely.contains_xy(land, *items.T).any()


def test_berths_have_room(marina: tuple[GridMap, Place]) -> None:
    """Over a hundred middles of nodes lie within 1 m of a quay; berths and ways have room."""
    grid, place = marina
    graph = navigation_graph(grid.navigable, place.pitch_m, False)
    middles = graph.metres(np.stack((graph.rows, graph.cols), axis=1).astype(float))
    land = Chart(grid.navigable, place.pitch_m, walls_of(place)).land
    found = berths(land, place.pitch_m, middles, TURN)
    assert np.abs(found - middles).max() <= 0.5 * place.pitch_m
    quays = shapely.boundary(land_in(place))
    shapely.prepare(quays)
    before, after = (shapely.distance(quays, shapely.points(xy)) for xy in (middles, found))
    assert (before < 1.0).sum() > 100 and (after < 1.3).sum() == 0
    same = before >= TURN.radius_m + 2.0 * place.pitch_m
    np.testing.assert_array_equal(found[same], middles[same])
    east = np.argwhere((np.diff(graph.cols) == 1) & (np.diff(graph.rows) == 0))[:, 0]
    ways = shapely.linestrings(np.stack((found[east], found[east + 1]), axis=1))
    assert shapely.distance(quays, ways).min() > 0.7


def test_touches_are_those_of_walls() -> None:
    """A hull slides along a slanted quay amid cells of land and of water: a touch, no impact."""
    turn = np.radians(30.0)
    way, out = np.array([np.cos(turn), np.sin(turn)]), np.array([-np.sin(turn), np.cos(turn)])
    walls = np.array([[10.0, 10.0, *way, 8.0]])
    water = np.ones((6, 6), np.bool_)
    water[3:, 3:] = False
    quays = Chart(water, 4.0, walls).land, 4.0
    size = np.array([[1.0, 0.5]])
    for gap, speed, touching, closing in (
        (0.0, 1.5 * way, True, 0.0),
        (0.002, way - 0.3 * out, True, 0.3),
        (0.02, way - 0.3 * out, False, 0.0),
    ):
        pose = np.array([[*(np.array([10.0, 10.0]) + (0.55 + gap) * out), turn]])
        hit, fast = np.zeros(1, np.bool_), np.zeros(1)
        velocity = np.array([[*speed, 0.0]])
        touches(pose, velocity, size, *quays, hit, fast)
        assert hit[0] == touching
        assert fast[0] == pytest.approx(closing, abs=1e-9)


def basin(room_m: float) -> GridMap:
    """Six by six cells of 4 m; quays on two of land leave so much to both sides of that between."""
    rings = tuple(
        ((west, 6.2), (east, 6.2), (east, 9.8), (west, 9.8), (west, 6.2))
        for west, east in ((2.0, 8.0 - room_m), (8.0 + room_m, 14.0))
    )
    water = np.ones((6, 6), np.bool_)
    water[3, [1, 3]] = False
    return GridMap("basin", water, Place(43.0, -20.0, 4.0, 6, 6, quays=rings))


@pytest.mark.parametrize("room_m", [1.0, 1.2, 1.8])
def test_berths_with_too_little_room_are_told(room_m: float) -> None:
    """A forager of 2 m x 1.08 m turns in 2.27 m; walls have a thickness."""
    bay = mf.load_scenario("open-bay").scenario
    setup = Setup(replace(bay, map=replace(bay.map, starts=())), basin(room_m))
    lines = [line for line in run_warnings(setup, ("graph", "physics")) if "narrowest" in line]
    assert len(lines) == (room_m < 1.136 + 0.05)
    assert setup.grid.place is not None
    latitude, longitude = setup.grid.place.latlon([3, 2])
    for line in lines:
        assert line == (
            "map basin: in 1 of 34 nodes quays leave a berth less than the 2.27 m that vessel "
            f"forager needs to turn, and it may touch them; the narrowest, of 1.9 m, is at "
            f"{latitude:.5f}, {longitude:.5f}; make the place with a larger --share, or give a "
            "smaller vessel"
        )
    assert not any("narrowest" in line for line in run_warnings(setup, ("graph",)))
