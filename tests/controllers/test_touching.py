"""How fast a hull may turn and go beside quays and other hulls, against closed forms."""

import math

import pytest

from controllers import Chart
from controllers.chart import LandArray, headland, nearest_land
from controllers.guidance import striking_speed
from controllers.helm import packed
from controllers.legs import REACTION_S
from controllers.loops import surge_drag, yaw_drag
from controllers.state import VesselState
from controllers.steering import safe_force, safe_moment
from controllers.touching import (
    BLUR_M,
    HULL_SHARE,
    INSET_M,
    NEAR_M,
    TOUCH_HULL_MPS,
    TOUCH_QUAY_MPS,
    heed_hull,
    heed_land,
)
from mjforage.physics.vessel_helm import helm_of
from mjforage.physics.vessels import load_vessel
from tests.controllers.plant import blank
from tests.graph_planner.charts import grid

P = packed(helm_of(load_vessel("forager")))
REACTION = P.lag_s + 2.0 * REACTION_S
LEVER = 0.5 * P.length_m - INSET_M  # of the corners of a hull along a quay
BASIN = Chart(grid(".....", ".....", "....."), 4.0).land  # quays at y = -2 and 10
FREE = 1e3


def hull(x: float, y: float, yaw: float = 0.0) -> VesselState:
    s = blank()
    s.x, s.y, s.yaw = x, y, yaw
    s.most_ahead = s.most_astern = s.most_port = s.most_starboard = FREE
    return s


def beside(gap: float) -> VesselState:
    """A forager along the southern quay, in the middle of a cell."""
    return hull(8.0, -2.0 + 0.5 * P.beam_m + gap)


def striking(gap: float) -> float:
    return striking_speed(gap - BLUR_M, P.brake_mps2, REACTION, TOUCH_QUAY_MPS)


@pytest.mark.parametrize("gap", [0.0, 0.1, 0.3])
def test_beside_a_quay_the_corners_limit_the_turn(gap: float) -> None:
    s = beside(gap)
    heed_land(s, P, BASIN, 4.0)
    assert s.most_port == s.most_starboard == pytest.approx(striking(gap) / LEVER)
    assert s.most_ahead == s.most_astern == FREE  # along the quay, over the seams of its cells


def test_moving_aside_uses_up_what_turning_may_have() -> None:
    s = beside(0.1)
    s.vy = -0.05
    heed_land(s, P, BASIN, 4.0)
    assert s.most_port == pytest.approx((striking(0.1) - 0.05) / LEVER)


def test_turning_uses_up_what_going_may_have() -> None:
    """Bow on, the corner to starboard comes nearer in a turn to port."""
    s = hull(8.0, -2.0 + 0.5 * P.length_m + 0.1, -0.5 * math.pi)
    heed_land(s, P, BASIN, 4.0)
    still = s.most_ahead
    s.most_ahead, s.rate = FREE, 0.1
    heed_land(s, P, BASIN, 4.0)
    assert still == pytest.approx(striking(0.1))
    assert s.most_ahead == pytest.approx(still - 0.1 * (0.5 * P.beam_m - INSET_M))
    assert s.most_astern == FREE


def test_far_from_everything_nothing_is_limited() -> None:
    s = beside(NEAR_M + 0.01)
    heed_land(s, P, BASIN, 4.0)
    heed_hull(s, P, hull(8.0, 4.0), P)
    assert s.most_port == s.most_starboard == s.most_ahead == FREE


def test_a_quay_that_juts_out_limits_a_hull_passing_it() -> None:
    """Its corner lies to starboard, 0.5 m before midships: a turn to starboard brings it nearer."""
    land = Chart(grid("...", "...", "#.."), 4.0).land  # a corner at (2, 2)
    off, half = 0.5 * P.beam_m + 0.1, math.sqrt(0.5)
    s = hull(2.0 + half * (off - 0.5), 2.0 + half * (off + 0.5), -0.25 * math.pi)
    heed_land(s, P, land, 4.0)
    assert s.most_port == FREE
    assert s.most_starboard == pytest.approx(striking(0.1) / 0.5)


@pytest.mark.parametrize("gap", [0.0, 0.2])
def test_two_hulls_have_half_of_the_gap_each(gap: float) -> None:
    s, other = hull(0.0, 0.0), hull(0.0, P.beam_m + gap)
    heed_hull(s, P, other, P)
    brake = HULL_SHARE * P.brake_mps2
    most = striking_speed(0.5 * (gap - BLUR_M), brake, REACTION, TOUCH_HULL_MPS)
    assert s.most_port == pytest.approx(most / P.length_m * 2.0, rel=0.06)  # the other's corners
    assert s.most_port == s.most_starboard


def test_a_force_that_has_wound_up_does_not_press_a_hull_on() -> None:
    s = hull(0.0, 0.0)
    s.most_ahead = 0.08
    most = surge_drag(P, 0.08) + P.mass_surge_kg * 0.08 / (P.lag_s + REACTION_S)
    assert safe_force(s, P, 0.0, 240.0) == pytest.approx(most)
    assert safe_force(s, P, 0.0, -100.0) == -100.0
    assert safe_force(s, P, 1.0, 50.0) < -0.9 * P.mass_surge_kg * P.brake_mps2  # brakes


def test_a_moment_keeps_to_the_safe_turn_whatever_the_reference_wants() -> None:
    s = hull(0.0, 0.0)
    s.most_port, s.rate = 0.1, 0.1
    assert safe_moment(s, P, 50.0) == pytest.approx(yaw_drag(P, 0.1))
    assert safe_moment(s, P, -50.0) == -50.0
    s.rate = 0.3
    assert safe_moment(s, P, 50.0) < -30.0


@pytest.fixture
def corner() -> LandArray:
    return Chart(grid("..", "#."), 4.0).land  # land around (0, 0), its corner at (2, 2)


def test_the_way_to_the_nearest_land(corner: LandArray) -> None:
    assert nearest_land(corner, 4.0, 1.0, 2.5, 1.0) == pytest.approx((0.0, -0.5))
    assert nearest_land(corner, 4.0, 2.3, 2.4, 1.0) == pytest.approx((-0.3, -0.4))
    assert nearest_land(corner, 4.0, 5.9, 4.0, 1.0) == pytest.approx((0.1, 0.0))  # the map's edge
    assert nearest_land(corner, 4.0, 1.0, 1.0, 1.0) == (0.0, 0.0)
    assert nearest_land(corner, 4.0, 3.9, 3.9, 1.0)[0] == math.inf


def test_where_land_juts_out(corner: LandArray) -> None:
    assert headland(corner, 0, 0)
    assert not headland(corner, 0, 1)  # a straight quay, along the map's edge
    assert not headland(corner, 1, 1)  # a corner of the basin
