"""Vessels that quays hold: they leave a corner of two quays, and only when they have to."""

import math
from dataclasses import replace

import numpy as np
import pytest

from mjforage.controllers import Chart
from mjforage.controllers.getting_off import (
    HELD_S,
    OFF_M,
    OFF_S,
    PICKING_S,
    choose_way_off,
    note_held,
    patience,
    room_along,
)
from mjforage.controllers.safety import limit_speeds
from mjforage.controllers.state import HOLD, TRANSIT, VesselState
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


def wait(s: VesselState, seconds: float) -> None:
    for _ in range(round(seconds / STEP_S)):
        note_held(s, P, BASIN, PITCH_M, STEP_S)


@pytest.mark.parametrize(
    ("yaw", "way"), [(0.0, -1.0), (math.pi, 1.0), (-0.5 * math.pi, -1.0), (0.5 * math.pi, 1.0)]
)
def test_square_in_a_corner_a_vessel_goes_off_straight(yaw: float, way: float) -> None:
    """Bow on, it goes astern; stern on, ahead; a turn towards open water is worth some room."""
    s = cornered(yaw)
    choose_way_off(s, P, BASIN, PITCH_M)
    assert s.off_way == way
    assert abs(s.off_heading - yaw) < 0.7
    straight = room_along(s, P, BASIN, PITCH_M, yaw, way)
    assert room_along(s, P, BASIN, PITCH_M, s.off_heading, way) >= straight
    assert room_along(s, P, BASIN, PITCH_M, yaw, -way) < 0.0, "the quay is there"


def test_it_waits_first_and_ends_in_time_or_when_it_is_off() -> None:
    s = cornered(0.5)
    wait(s, HELD_S - STEP_S)
    assert s.off_s == 0.0
    wait(s, 3.0 * STEP_S)
    assert s.off_s == pytest.approx(OFF_S, abs=0.3)
    wait(s, OFF_S)
    assert s.off_s == 0.0, "it has not moved: it begins anew, after as long a while"
    wait(s, HELD_S + STEP_S)
    assert s.off_s > 0.0
    s.x -= OFF_M + 0.1
    wait(s, STEP_S)
    assert s.off_s == s.held_s == 0.0
    assert (s.was_x, s.was_y) == (s.x, s.y)


def test_one_that_moves_waits_for_others_or_touches_nothing_is_not_held() -> None:
    moving, waiting, free = cornered(0.5), cornered(0.5), cornered(0.5)
    waiting.wait, free.in_contact = 1.0, 0.0
    for _ in range(2 * round(HELD_S / STEP_S)):
        moving.x -= 0.02
        for s in (moving, waiting, free):
            note_held(s, P, BASIN, PITCH_M, STEP_S)
    assert moving.off_s == waiting.off_s == free.off_s == 0.0


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
    limit_speeds(np.array([s]), np.array([P]), BASIN, PITCH_M, 0)
    fleet = np.array([s])
    limit_speeds(fleet, np.array([P]), BASIN, PITCH_M, 0)
    assert (fleet["lee_y"][0] < 0.0) == (off_s == 0.0)


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
