import math

import numpy as np
import pytest

from mjforage.controllers.loops import (
    MOST_LEAD_S,
    heading_moment,
    heading_reference,
    heading_windup,
    integrated,
    speed_reference,
    surge_drag,
    surge_force,
    surge_windup,
    turning_limit,
)
from mjforage.controllers.steering import SLOW_MPS, braking_moment
from tests.controllers.plant import FORAGER, blank
from tests.controllers.plant import SCOUT as P


def test_surge_force_is_drag_and_acceleration() -> None:
    s = blank()
    s.speed_ref = 1.0
    force = surge_force(s, P, 0.9, 1.0, 0.1)
    assert force == pytest.approx(
        surge_drag(P, 1.0) + P.mass_surge_kg * P.speed_bandwidth_radps * 0.1
    )


def test_speed_reference_does_not_run_away_from_a_vessel_that_cannot_follow() -> None:
    s = blank()
    for _ in range(100):
        surge_force(s, P, 0.0, 1.5, 0.1)
    assert s.speed_ref <= MOST_LEAD_S * P.acceleration_mps2 + P.acceleration_mps2 * 0.1


@pytest.mark.parametrize(
    ("rate", "wanted", "given", "after"),
    [
        (2.0, 50.0, 50.0, 1.2),  # not saturated
        (2.0, 80.0, 67.0, 1.0),  # saturated, and asking for more of it
        (-2.0, 80.0, 67.0, 0.8),  # saturated, but coming back
        (-2.0, -60.0, -40.0, 1.0),
    ],
)
def test_anti_windup(rate: float, wanted: float, given: float, after: float) -> None:
    assert integrated(1.0, rate, wanted, given, 0.1) == pytest.approx(after)


def test_integrals_stand_still_while_the_thrusters_are_saturated() -> None:
    """Held back at full thrust for a minute, nothing winds up."""
    s = blank()
    for _ in range(600):
        force = surge_force(s, P, 0.0, 1.9, 0.1) + 100.0
        surge_windup(s, P, 0.0, force, 2.0 * P.thrust_high, 0.1)
        moment = heading_moment(s, P, 3.0, P.yaw_rate_radps, 0.1) + 100.0
        heading_windup(s, P, moment, P.lever_m * (P.thrust_high - P.thrust_low), 0.1)
    assert s.surge_integral == 0.0
    assert s.moment_integral == 0.0


def test_integrals_learn_a_steady_error_otherwise() -> None:
    s = blank()
    s.speed_ref = 1.0
    for _ in range(20):
        force = surge_force(s, P, 0.9, 1.0, 0.1)
        surge_windup(s, P, 0.9, force, force, 0.1)
    assert s.surge_integral == pytest.approx(
        20 * 0.1 * P.mass_surge_kg * P.speed_bandwidth_radps * 0.1 / P.speed_integral_s
    )


def test_turning_leaves_thrust_for_braking() -> None:
    s, most = blank(), P.lever_m * -P.thrust_low
    assert braking_moment(s, P, 1.0, -30.0, 1.0, 100.0) == pytest.approx(most)
    assert braking_moment(s, P, 1.0, -30.0, 1.0, -100.0) == pytest.approx(-most)
    assert braking_moment(s, P, 1.0, 30.0, 1.0, 100.0) == 100.0  # not braking
    assert braking_moment(s, P, 0.3, -30.0, 1.0, 100.0) == pytest.approx(0.3 * most)


@pytest.mark.parametrize("share", [0.3, 1.0])
@pytest.mark.parametrize(("way", "brake"), [(1.0, -P.thrust_low), (-1.0, P.thrust_high)])
def test_the_slower_a_vessel_is_the_more_thrust_it_turns_with(
    share: float, way: float, brake: float
) -> None:
    """All of it at rest; between half and that where it is half as slow as it counts as slow."""
    s, most = blank(), P.lever_m * (P.thrust_high - P.thrust_low)
    assert braking_moment(s, P, share, -way, way * 1e-9, 100.0) == pytest.approx(most)
    half = braking_moment(s, P, share, -way, way * 0.5 * SLOW_MPS, 100.0)
    assert half == pytest.approx(0.5 * (most + share * P.lever_m * brake))
    s.in_contact = 1.0
    assert braking_moment(s, P, share, -way, way * 0.5 * SLOW_MPS, 100.0) == 100.0  # it leans


def test_a_turn_under_way_takes_the_moment_of_a_centre_of_gravity_ahead() -> None:
    """M x_g u r, with 80 kg at 0.153 m: of two vessels that turn alike, at rest and at 1.5 m/s."""
    rest, going = blank(), blank()
    going.vx = 1.5
    rest.rate_ref = going.rate_ref = rest.rate = going.rate = 0.2
    still, more = (heading_moment(s, FORAGER, 1.0, 0.2, 0.1) for s in (rest, going))
    assert FORAGER.offset_kgm == pytest.approx(80.0 * 0.153)
    assert more - still == pytest.approx(FORAGER.offset_kgm * 1.5 * 0.2)


def test_speed_while_turning() -> None:
    """u = aside x rate / (1 - cos e), nothing beyond 90 degrees."""
    assert turning_limit(P, 0.5) == pytest.approx(0.12 * 1.35 * P.yaw_rate_radps / 0.5)
    assert turning_limit(P, -0.1) == 0.0
    assert turning_limit(P, 1.0) > 10.0


STEP_S = 0.1


def turn(start: float, wanted: float, rate: float = 0.5, acceleration: float = 1.0) -> np.ndarray:
    """(tick, 2) heading and rate of a reference from rest."""
    state, rows = (start, 0.0), []
    for _ in range(150):
        state = heading_reference(*state, wanted, rate, acceleration, STEP_S)
        rows.append(state)
    return np.array(rows)


@pytest.mark.parametrize("angle", [0.02, 0.5, math.pi / 2, 3.0])
def test_heading_goes_there_without_overshoot_inside_its_limits(angle: float) -> None:
    heading, rate = turn(0.0, angle).T
    assert heading[-1] == pytest.approx(angle, abs=1e-3)
    assert heading.max() <= angle * 1.01 + 1e-3
    assert np.abs(rate).max() <= 0.5 + 1e-12
    assert np.abs(np.diff(rate, prepend=0.0)).max() <= 1.0 * STEP_S + 1e-12


def test_heading_takes_the_short_way() -> None:
    assert turn(3.0, -3.0)[-1, 0] == pytest.approx(2.0 * math.pi - 3.0, abs=1e-3)


def test_a_long_turn_takes_the_time_of_its_rate() -> None:
    heading = turn(0.0, 2.0, rate=0.4, acceleration=10.0)[:, 0]
    assert np.argmax(heading > 1.8) * STEP_S == pytest.approx(1.8 / 0.4, abs=0.3)


@pytest.mark.parametrize(
    ("speed", "wanted", "after"),
    [
        (0.0, 2.0, 0.1),  # 1 m/s2 away from rest
        (0.0, -2.0, -0.1),
        (1.0, 0.0, 0.8),  # 2 m/s2 towards it
        (-1.0, -0.5, -0.8),
        (0.05, -1.0, 0.0),  # through rest, no farther at once
        (1.95, 2.0, 2.0),
    ],
)
def test_speed(speed: float, wanted: float, after: float) -> None:
    assert speed_reference(speed, wanted, 1.0, 2.0, STEP_S) == pytest.approx(after)
