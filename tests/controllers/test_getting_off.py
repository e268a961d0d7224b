"""Vessels that are held: they leave a corner of two quays, and only when they have to."""

import math
from dataclasses import replace

import numpy as np
import pytest

from mjforage.controllers import Chart
from mjforage.controllers.getting_off import (
    HELD_S,
    MOST_ROOM_M,
    OFF_M,
    OFF_S,
    PICKING_S,
    TOUCHING_M,
    choose_way_off,
    heading_off,
    is_in_the_way,
    note_held,
    patience,
    room_along,
)
from mjforage.controllers.safety import PAST_QUAY_MPS, PAST_VESSEL_MPS, limit_speeds
from mjforage.controllers.state import HOLD, TRANSIT, FleetArray, VesselState
from mjforage.controllers.vessel_model import ModelArray
from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.physics.vessels import load_vessel
from tests.controllers.plant import FORAGER as P
from tests.controllers.plant import vessel_at
from tests.controllers.walks import PITCH_M, Walk
from tests.graph_planner.charts import grid
from tests.mjforage.mission.by_hand import CALM

STEP_S = 0.1
ROWS = (".......",) * 5
BASIN = Chart(grid(*ROWS), PITCH_M).land  # water from -2 to 26 m east, -2 to 18 m north
EAST_X, SOUTH_Y = 26.0, -2.0


def cornered(yaw: float) -> VesselState:
    """A vessel under way that leans on both quays of the south-eastern corner."""
    c, t = abs(math.cos(yaw)), abs(math.sin(yaw))
    wide = 0.5 * (c * P.length_m + t * P.beam_m)
    high = 0.5 * (t * P.length_m + c * P.beam_m)
    s = vessel_at(EAST_X - wide, SOUTH_Y + high, yaw)
    s.mode, s.in_contact, s.was_x, s.was_y = TRANSIT, 1.0, s.x, s.y
    return s


def fleet_of(*vessels: VesselState) -> tuple[FleetArray, ModelArray]:
    return np.array(vessels), np.array([P] * len(vessels))


def wait(fleet: FleetArray, models: ModelArray, seconds: float, i: int = 0) -> None:
    for _ in range(round(seconds / STEP_S)):
        note_held(fleet, models, BASIN, PITCH_M, i, STEP_S)


@pytest.mark.parametrize(
    ("yaw", "way"), [(0.0, -1.0), (math.pi, 1.0), (-0.5 * math.pi, -1.0), (0.5 * math.pi, 1.0)]
)
def test_square_in_a_corner_a_vessel_goes_off_straight(yaw: float, way: float) -> None:
    """Bow on, it goes astern; stern on, ahead; a turn towards open water is worth some room."""
    fleet, models = fleet_of(cornered(yaw))
    about = fleet, models, BASIN, PITCH_M, 0
    choose_way_off(*about)
    heading = fleet["off_heading"][0]
    assert fleet["off_way"][0] == way
    assert abs(heading - yaw) < 0.7
    assert room_along(*about, heading, way) >= room_along(*about, yaw, way)
    assert room_along(*about, yaw, -way) < 0.0, "the quay is there"


def test_room_is_up_to_the_hulls_of_others_too() -> None:
    """Astern, the last place looked at is 2 m off: of the gap to one there as much less is left."""
    s = vessel_at(12.0, 8.0)
    fleet, models = fleet_of(s, vessel_at(s.x - 2.0 - P.length_m - 0.4, 8.0))
    assert room_along(fleet, models, BASIN, PITCH_M, 0, 0.0, -1.0) == pytest.approx(0.4)
    assert room_along(fleet, models, BASIN, PITCH_M, 0, 0.0, 1.0) == MOST_ROOM_M


def test_with_another_astern_a_vessel_goes_off_beside_it() -> None:
    """Bow at a quay, in the middle of it: straight astern if nobody lies there, else slantwise."""
    s = vessel_at(EAST_X - 0.5 * P.length_m, 8.0)
    other = vessel_at(s.x - P.length_m - 0.3, 7.6)
    alone, pair = fleet_of(s), fleet_of(s, other)
    for fleet, models in (alone, pair):
        choose_way_off(fleet, models, BASIN, PITCH_M, 0)
    assert (alone[0]["off_way"][0], alone[0]["off_heading"][0]) == (-1.0, 0.0)
    assert (pair[0]["off_way"][0], pair[0]["off_heading"][0]) != (-1.0, 0.0)


def test_while_it_leans_it_does_not_turn_nor_push_as_before() -> None:
    s = cornered(0.5)
    s.heading_ref, s.rate_ref, s.moment_integral, s.surge_integral = 1.0, 0.3, 50.0, -40.0
    fleet, models = fleet_of(s)
    choose_way_off(fleet, models, BASIN, PITCH_M, 0)
    s = fleet[0]
    assert (s.heading_ref, s.rate_ref, s.moment_integral, s.surge_integral) == (0.5, 0.0, 0.0, 0.0)
    s.off_heading = 0.9
    assert heading_off(s) == 0.5
    s.in_contact = 0.0
    assert heading_off(s) == 0.9


def test_it_waits_first_and_ends_in_time_or_when_it_is_off() -> None:
    fleet, models = fleet_of(cornered(0.5))
    s = fleet[0]
    wait(fleet, models, HELD_S - STEP_S)
    assert s.off_s == 0.0
    wait(fleet, models, 3.0 * STEP_S)
    assert s.off_s == pytest.approx(OFF_S, abs=0.3)
    wait(fleet, models, OFF_S)
    assert s.off_s == 0.0, "it has not moved: it begins anew, after as long a while"
    wait(fleet, models, HELD_S + STEP_S)
    assert s.off_s > 0.0
    s.x -= OFF_M + 0.1
    wait(fleet, models, STEP_S)
    assert s.off_s == s.held_s == 0.0
    assert (s.was_x, s.was_y) == (s.x, s.y)


def test_one_that_moves_waits_for_others_or_touches_nothing_is_not_held() -> None:
    """But one that has no way left at all, and waits for that, is."""
    moving, waiting, free, stuck = (cornered(0.5) for _ in range(4))
    waiting.wait = stuck.wait = stuck.stuck = 1.0
    free.in_contact = 0.0
    fleets = [fleet_of(s) for s in (moving, waiting, free, stuck)]
    for _ in range(round(1.5 * HELD_S / STEP_S)):
        fleets[0][0]["x"] -= 0.02
        for fleet, models in fleets:
            wait(fleet, models, STEP_S)
    assert [fleet["off_s"][0] > 0.0 for fleet, _ in fleets] == [False, False, False, True]


def test_one_that_rests_makes_way_for_one_that_touches_it_and_gets_off() -> None:
    resting, other = cornered(0.0), cornered(0.0)
    resting.mode, resting.place_x, resting.place_y = HOLD, resting.x, resting.y
    other.x -= P.length_m + 0.5 * TOUCHING_M
    fleet, models = fleet_of(resting, other)
    wait(fleet, models, 2.0 * HELD_S)
    assert fleet["off_s"][0] == 0.0
    fleet["off_s"][1] = OFF_S
    assert is_in_the_way(fleet, models, 0) and not is_in_the_way(fleet, models, 1)
    wait(fleet, models, STEP_S)
    assert fleet["off_s"][0] > 0.0
    fleet["x"][1] -= TOUCHING_M
    assert not is_in_the_way(fleet, models, 0)


def test_patience() -> None:
    s = cornered(0.0)
    assert patience(s) == HELD_S
    s.mode, s.place_x, s.place_y = HOLD, s.x, s.y
    assert patience(s) == math.inf, "in its place it may lean"
    s.place_x += 1.0
    assert patience(s) == HELD_S
    s.item_x, s.item_y = s.x, s.y
    assert patience(s) == PICKING_S


@pytest.mark.parametrize("off_s", [0.0, 5.0])
def test_lee_limits_are_for_vessels_that_do_not_get_off(off_s: float) -> None:
    s = cornered(-0.5 * math.pi)
    s.in_contact, s.off_s, s.y, s.drift_y = 0.0, off_s, s.y + 0.1, -0.3
    fleet, models = fleet_of(s)
    limit_speeds(fleet, models, BASIN, PITCH_M, 0)
    assert (fleet["lee_y"][0] < 0.0) == (off_s == 0.0)


@pytest.mark.parametrize(("off_s", "most"), [(0.0, 0.05), (5.0, 0.53)])
def test_the_lee_of_vessels_is_for_those_too(off_s: float, most: float) -> None:
    """Another .5 m ahead, towards which .3 m/s of water goes: (.5 - .3) m / 4 s, or its brake."""
    s = vessel_at(12.0, 8.0)
    s.off_s, s.drift_x = off_s, 0.3
    fleet, models = fleet_of(s, vessel_at(12.5 + P.length_m, 8.0))
    limit_speeds(fleet, models, BASIN, PITCH_M, 0)
    assert fleet["most_ahead"][0] == pytest.approx(most, abs=0.01)


@pytest.mark.parametrize(("off_s", "most"), [(0.0, PAST_VESSEL_MPS), (5.0, PAST_QUAY_MPS)])
def test_beside_another_a_vessel_that_gets_off_goes_as_fast_as_along_a_quay(
    off_s: float, most: float
) -> None:
    """Two abreast in open water, .1 m between them, drawn together by .3 m/s of water."""
    s = vessel_at(12.0, 8.0)
    s.off_s, s.drift_y = off_s, 0.3
    fleet, models = fleet_of(s, vessel_at(12.0, 8.1 + P.beam_m))
    limit_speeds(fleet, models, BASIN, PITCH_M, 0)
    assert fleet["most_ahead"][0] == pytest.approx(most)


def test_vessels_leave_a_corner_that_the_water_sets_into() -> None:
    """16 headings, .2 m/s diagonally into the corner; the node two to the west within 100 s."""
    graph = navigation_graph(grid(*ROWS), PITCH_M, False)
    water = replace(CALM, current_speed_mps=0.2, current_to_deg=135.0)
    walk = Walk(
        graph, [load_vessel("forager")], [(4, 6)], scouts=0, episodes=16, weather=water, seed=3
    )
    pose = np.zeros((16, 1, 3))
    pose[..., :2] = walk.centres[walk.node]
    pose[:, 0, 2] = np.linspace(-np.pi, np.pi, 16, endpoint=False)
    walk.simulation.place_vessels(pose)
    for _ in range(200):
        walk.tick()
    origin = walk.centres[walk.node]
    target, arrival = origin - np.array([2.0 * PITCH_M, 0.0]), np.full(16, np.inf)
    for tick in range(1000):
        if tick % 100 == 0:
            walk.pilot.order(np.ones(16, np.bool_), origin, target, np.zeros((16, 1), np.bool_))
        walk.tick()
        off = (walk.simulation.vessel_pose[..., :2] - target)[:, 0]
        near = np.hypot(off[:, 0], off[:, 1]) < 1.0
        arrival = np.minimum(arrival, np.where(near, 0.1 * (tick + 1), np.inf))
    assert np.isfinite(arrival).all(), arrival
