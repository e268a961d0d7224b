"""Speeds at which a vessel may turn and go beside quays and other vessels, against closed forms."""

import math

import numpy as np
import pytest

from mjforage.controllers import Chart
from mjforage.controllers.chart import WALL_M, LandArray, headland, is_nearer, way_to_cell
from mjforage.controllers.contact import (
    BLUR_M,
    INSET_M,
    NEAR_M,
    PATIENT_S,
    QUAY_SHARE,
    TOUCH_QUAY_MPS,
    TOUCH_VESSEL_MPS,
    VESSEL_SHARE,
    heed_land,
    heed_vessel,
)
from mjforage.controllers.estimate import learn_drift
from mjforage.controllers.guidance import striking_speed
from mjforage.controllers.legs import REACTION_S
from mjforage.controllers.loops import surge_drag, yaw_drag
from mjforage.controllers.state import VesselState
from mjforage.controllers.steering import most_difference, most_gain, push, safe_force, safe_moment
from tests.controllers.plant import FORAGER as P
from tests.controllers.plant import FREE, vessel_at
from tests.graph_planner.charts import grid

REACTION = P.lag_s + 2.0 * REACTION_S
LEVER = 0.5 * P.length_m - INSET_M  # of the corners of a vessel along a quay
BASIN = Chart(grid(".....", ".....", "....."), 4.0).land  # quays at y = -2 and 10
WALL = np.array([[8.0, 2.0 - WALL_M, 1.0, 0.0, 10.0]])
WALLED = Chart(grid(".....", ".....", ".....", "....."), 4.0, WALL).land


def beside(gap: float) -> VesselState:
    """A forager along the southern quay, in the middle of a cell."""
    return vessel_at(8.0, -2.0 + 0.5 * P.beam_m + gap)


def striking(gap: float) -> float:
    brake = QUAY_SHARE * P.brake_mps2
    return striking_speed(gap - BLUR_M, brake, REACTION, TOUCH_QUAY_MPS)


@pytest.mark.parametrize("walled", [False, True])
@pytest.mark.parametrize("gap", [0.0, 0.1, 0.3])
def test_beside_a_quay_the_corners_limit_the_turn(gap: float, walled: bool) -> None:
    """A quay of cells, or the outline of one amid the water, 4 m farther north."""
    s = beside(gap)
    s.y += 4.0 * walled
    heed_land(s, P, WALLED if walled else BASIN, 4.0)
    assert s.most_port == s.most_starboard == pytest.approx(striking(gap) / LEVER)
    assert s.most_ahead == s.most_astern == FREE  # along the quay, over the seams of its cells


def test_moving_aside_uses_up_what_turning_may_have() -> None:
    s = beside(0.1)
    s.vy = -0.05
    heed_land(s, P, BASIN, 4.0)
    assert s.most_port == pytest.approx((striking(0.1) - 0.05) / LEVER)


def test_turning_uses_up_what_going_may_have() -> None:
    """Bow on, the corner to starboard comes nearer in a turn to port."""
    s = vessel_at(8.0, -2.0 + 0.5 * P.length_m + 0.1, -0.5 * math.pi)
    heed_land(s, P, BASIN, 4.0)
    still = s.most_ahead
    s.most_ahead, s.rate = FREE, 0.1
    heed_land(s, P, BASIN, 4.0)
    assert still == pytest.approx(striking(0.1))
    assert s.most_ahead == pytest.approx(still - 0.1 * (0.5 * P.beam_m - INSET_M))
    assert s.most_astern == FREE


def test_the_longer_a_vessel_is_held_the_more_it_lifts() -> None:
    """The load of the drift that it knows, and as much again in every `PATIENT_S`."""
    loads = []
    for held_s in (0.0, PATIENT_S, 2.0 * PATIENT_S):
        s = beside(0.0)
        s.drift_y, s.held_s = -0.2, held_s
        heed_land(s, P, BASIN, 4.0)
        loads.append(s.load_starboard)
    force = (P.linear_sway + P.quadratic_sway * 0.2) * 0.2
    assert loads == pytest.approx([n * force * LEVER for n in (1.0, 2.0, 3.0)])


def test_far_from_everything_nothing_is_limited() -> None:
    s = beside(NEAR_M + 0.01)
    heed_land(s, P, BASIN, 4.0)
    heed_vessel(s, P, vessel_at(8.0, 4.0), P)
    assert s.most_port == s.most_starboard == s.most_ahead == FREE


def test_a_quay_that_juts_out_limits_a_vessel_passing_it() -> None:
    """Its corner lies to starboard, 0.5 m before midships: a turn to starboard brings it nearer."""
    land = Chart(grid("...", "...", "#.."), 4.0).land  # a corner at (2, 2)
    off, half = 0.5 * P.beam_m + 0.1, math.sqrt(0.5)
    s = vessel_at(2.0 + half * (off - 0.5), 2.0 + half * (off + 0.5), -0.25 * math.pi)
    heed_land(s, P, land, 4.0)
    assert s.most_port == FREE
    assert s.most_starboard == pytest.approx(striking(0.1) / 0.5)


@pytest.mark.parametrize(
    ("gap", "off_s", "touch"),
    [(0.0, 0.0, TOUCH_VESSEL_MPS), (0.2, 0.0, TOUCH_VESSEL_MPS), (0.0, 5.0, TOUCH_QUAY_MPS)],
)
def test_two_vessels_have_half_of_the_gap_each(gap: float, off_s: float, touch: float) -> None:
    """One that gets off may touch another as fast as a quay."""
    s, other = vessel_at(0.0, 0.0), vessel_at(0.0, P.beam_m + gap)
    s.off_s = off_s
    heed_vessel(s, P, other, P)
    most = striking_speed(0.5 * (gap - BLUR_M), VESSEL_SHARE * P.brake_mps2, REACTION, touch)
    assert s.most_port == pytest.approx(most / P.length_m * 2.0, rel=0.06)  # the other's corners
    assert s.most_port == s.most_starboard


def test_a_force_that_has_wound_up_does_not_press_a_vessel_on() -> None:
    s = vessel_at(0.0, 0.0)
    s.most_ahead = 0.08
    most = surge_drag(P, 0.08) + P.mass_surge_kg * 0.08 / (P.lag_s + REACTION_S)
    assert safe_force(s, P, 0.0, 240.0) == pytest.approx(most)
    assert safe_force(s, P, 0.0, -100.0) == -100.0
    assert safe_force(s, P, 1.0, 50.0) < -0.9 * P.mass_surge_kg * P.brake_mps2  # brakes


def test_a_force_at_a_safe_speed_is_that_through_the_water() -> None:
    """Water that comes from ahead takes thrust to stand still in."""
    s = vessel_at(0.0, 0.0)
    s.most_ahead, s.drift_x = 0.0, -0.3
    assert safe_force(s, P, 0.0, 240.0) == pytest.approx(surge_drag(P, 0.3))


def test_a_vessel_above_its_limit_brakes_as_fast_as_that_falls() -> None:
    """Of a vessel that stops at a constant brake a, dv/dt = -a v / (v + a t_r)."""
    most, reaction = 0.4, P.lag_s + REACTION_S
    falls = P.brake_mps2 * 0.46 / (most + P.brake_mps2 * reaction)
    assert most_gain(P, 0.46, most) == pytest.approx(-0.06 / reaction - falls)
    assert most_gain(P, most, most) == 0.0
    assert most_gain(P, 2.0, most) == -P.brake_mps2


def test_a_vessel_that_leans_turns_off_against_the_water() -> None:
    """Around the corner it leans on, with the water's load at half its length."""
    s = beside(0.0)
    s.drift_y, s.most_port = -0.3, 0.1
    heed_land(s, P, BASIN, 4.0)
    load = (P.linear_sway + P.quadratic_sway * 0.3) * 0.3 * LEVER
    assert s.in_contact == 1.0
    assert s.load_port == s.load_starboard == pytest.approx(load)
    free = yaw_drag(P, 0.1) + P.inertia_yaw_kgm2 * 0.1 / (P.lag_s + REACTION_S)
    s.most_port = 0.1
    assert safe_moment(s, P, 500.0) == pytest.approx(free + load)


def test_turning_in_contact_presses_a_vessel_on_with_no_more_than_the_surge_wanted() -> None:
    """Full thrust both ways would push it ahead by what it has more ahead than astern."""
    s, surge = beside(0.0), 0.2 * P.thrust_low
    s.in_contact, s.heading_ref = 1.0, 0.0
    port, starboard = push(s, P, 2.0, surge, 0.1)
    assert port + starboard == pytest.approx(surge)
    assert starboard - port == pytest.approx(most_difference(s, P, surge))
    assert most_difference(s, P, 2.0 * P.thrust_low) == -P.thrust_low  # it turns all the same
    assert most_difference(s, P, 2.0 * P.thrust_high - 1.0) == -P.thrust_low
    assert most_difference(s, P, P.thrust_high) == pytest.approx(P.thrust_high)
    s.lee_y = -1.0  # held there by water: all thrust turns it off
    assert most_difference(s, P, surge) == P.thrust_high - P.thrust_low


def test_the_load_of_the_water_is_lifted_to_the_side_to_which_the_vessel_shall_turn() -> None:
    """Also where the reference is at the heading wanted already, and the vessel held."""
    turned = []
    for side in (1.0, 0.0, -1.0):
        s = beside(0.0)
        s.in_contact, s.lee_y, s.load_port, s.load_starboard = 1.0, -1.0, 18.0, 18.0
        s.most_port = s.most_starboard = 1e3
        s.heading_ref = 0.2 * side
        port, starboard = push(s, P, 0.2 * side, 0.0, 0.1)
        turned.append((starboard - port) * P.lever_m)
    spring = P.inertia_yaw_kgm2 * P.heading_bandwidth_radps**2 * 0.2
    assert turned == pytest.approx([spring + 18.0, 0.0, -spring - 18.0], abs=1.0)


def test_what_a_vessel_leans_on_is_not_taken_for_the_water() -> None:
    s = beside(0.0)
    s.drift_y, s.in_contact = -0.3, 1.0
    for _ in range(100):
        learn_drift(s, P, 0.1)
    assert (s.drift_x, s.drift_y) == (0.0, -0.3)
    assert (s.surge, s.sway) == pytest.approx((0.0, 0.3))


def test_a_moment_keeps_to_the_safe_turn_whatever_the_reference_wants() -> None:
    s = vessel_at(0.0, 0.0)
    s.most_port, s.rate = 0.1, 0.1
    assert safe_moment(s, P, 50.0) == pytest.approx(yaw_drag(P, 0.1))
    assert safe_moment(s, P, -50.0) == -50.0
    s.rate = 0.3
    assert safe_moment(s, P, 50.0) < -30.0


@pytest.fixture
def corner() -> LandArray:
    return Chart(grid("..", "#."), 4.0).land  # land around (0, 0), its corner at (2, 2)


def test_the_way_to_a_cell_of_land() -> None:
    assert way_to_cell(4.0, 1.0, 2.5, 0, 0) == pytest.approx((0.0, -0.5))
    assert way_to_cell(4.0, 2.3, 2.4, 0, 0) == pytest.approx((-0.3, -0.4))
    assert way_to_cell(4.0, 5.9, 4.0, 2, 1) == pytest.approx((0.1, 0.0))
    assert way_to_cell(4.0, 1.0, 1.0, 0, 0) == (0.0, 0.0)


def test_of_a_straight_quay_one_cell_counts_and_a_corner_only_if_it_juts_out() -> None:
    assert is_nearer(BASIN, 2, -1, 0.0, -0.5)
    assert not is_nearer(BASIN, 3, -1, 1.0, -0.5)  # its neighbour is nearer
    land = Chart(grid("...", "...", "#.."), 4.0).land
    assert is_nearer(land, 0, 0, -0.3, -0.4)


def test_in_a_corner_of_two_quays_both_limit_a_turn() -> None:
    """The bow is nearer to the western quay, and its starboard corner turns to the northern one."""
    s = vessel_at(-2.0 + 0.5 * P.length_m + 0.05, 10.0 - 0.5 * P.beam_m - 0.1, math.pi)
    heed_land(s, P, BASIN, 4.0)
    assert s.most_starboard == pytest.approx(striking(0.1) / LEVER)


def test_a_vessel_that_draws_away_may_turn_as_if_it_did_not_drift() -> None:
    """Its bow is off the quay: what it makes ahead takes its stern away from there."""
    s = beside(0.5)
    s.yaw, found = 0.3, []
    for vx, vy in ((0.0, 0.0), (0.0, -0.2), (math.cos(0.3), math.sin(0.3) - 0.2)):
        s.most_port, s.vx, s.vy = FREE, vx, vy
        heed_land(s, P, BASIN, 4.0)
        found.append(s.most_port)
    still, drifting, drawing_away = found
    assert drifting < 0.7 * still < FREE
    assert drawing_away == still


def test_where_land_juts_out(corner: LandArray) -> None:
    assert headland(corner, 0, 0)
    assert not headland(corner, 0, 1)  # a straight quay, along the map's edge
    assert not headland(corner, 1, 1)  # a corner of the basin
