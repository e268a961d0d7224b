"""Motions with closed forms, and the symmetries that they must have."""

import dataclasses
import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from mjforage.physics.hydrodynamics import pack
from mjforage.physics.hydrodynamics.conditions import Conditions, to_body
from mjforage.physics.hydrodynamics.motion import kinetic_energy
from mjforage.physics.hydrodynamics.ode_hull import simulate
from mjforage.physics.vessels import ForceThruster, Vessel, load_vessel

NAMES = ("otter", "scout", "forager")
STEP = 0.05


def run(
    vessel: Vessel,
    duration_s: float,
    command: tuple[float, float] = (0.0, 0.0),
    conditions: Conditions | None = None,
    step_s: float = STEP,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    times = np.arange(round(duration_s / step_s) + 1, dtype=np.float64) * step_s
    commands = np.tile(command, (times.size - 1, 1))
    return times, simulate(vessel, conditions or Conditions(), times, commands)


def turning(vessel: Vessel, side: float = 1.0) -> tuple[float, float]:
    """Commands of a stable turn to port."""
    top = vessel.thruster.command_range[1]
    inner, outer = 0.3 * top, 0.55 * top
    return (inner, outer) if side > 0 else (outer, inner)


@pytest.mark.parametrize("name", NAMES)
def test_at_rest_in_a_calm_nothing_moves(name: str) -> None:
    _, states = run(load_vessel(name), 300.0, step_s=0.2)
    assert not states.any()


@settings(max_examples=20)
@given(st.floats(-2.0, 2.0), st.floats(-1.0, 1.0), st.floats(-1.5, 1.5))
@pytest.mark.parametrize("name", NAMES)
def test_unpowered_energy_never_rises(name: str, u: float, v: float, r: float) -> None:
    vessel = load_vessel(name)
    start = Conditions(velocity_mps=(u, v), yaw_rate_radps=r)
    _, states = run(vessel, 10.0, conditions=start)
    energy = np.array([kinetic_energy(pack(vessel), *state[3:]) for state in states])
    assert (np.diff(energy) <= 1e-12).all()


def test_quadratic_hull_accelerates_as_a_hyperbolic_tangent() -> None:
    """M u' = T - k u^2: u = U tanh(t U k / M), U = sqrt(T / k), once the lag is taken away."""
    scout = dataclasses.replace(
        load_vessel("scout"),
        lag_s=1e-6,
        windage=load_vessel("otter").windage,
    )
    times = np.concatenate(([0.0], 1e-5 + STEP * np.arange(300)))  # thrust is there from 1e-5 s on
    states = simulate(scout, Conditions(), times, np.full((300, 2), 20.0))
    top = math.sqrt(40.0 / 17.3)
    np.testing.assert_allclose(states[:, 3], top * np.tanh(times * top * 17.3 / 38.25), atol=1e-5)


def test_quadratic_hull_coasts_as_a_hyperbola() -> None:
    """M u' = -k u^2: u = u0 / (1 + u0 k t / M), x = M / k ln(1 + u0 k t / M)."""
    scout = dataclasses.replace(load_vessel("scout"), windage=load_vessel("otter").windage)
    times, states = run(scout, 20.0, conditions=Conditions(velocity_mps=(1.9, 0.0)))
    falling = 1.0 + 1.9 * 17.3 / 38.25 * times
    np.testing.assert_allclose(states[:, 3], 1.9 / falling, atol=1e-7)
    np.testing.assert_allclose(states[:, 0], 38.25 / 17.3 * np.log(falling), atol=1e-7)


def test_otter_accelerates_in_closed_form_with_its_propeller_lag() -> None:
    """M u' = T (1 - exp(-t/lag))^2 - d u, a sum of three exponentials."""
    times, states = run(load_vessel("otter"), 10.0, (60.0, 60.0), step_s=0.01)
    mass, a, b = 85.28, 77.55 / 85.28, 10.0
    decay, lag, square = np.exp(-a * times), np.exp(-b * times), np.exp(-2.0 * b * times)
    shape = (1.0 - decay) / a - 2.0 * (lag - decay) / (a - b) + (square - decay) / (a - 2.0 * b)
    thrust = 2.0 * 0.01108 * 60.0**2
    np.testing.assert_allclose(states[:, 3], thrust / mass * shape, atol=1e-6)
    assert states[-1, 3] == pytest.approx(thrust / 77.55, rel=1e-3)


def test_forager_follows_its_own_equation_in_surge() -> None:
    """M u' = T - X(u), X with linear, quadratic and wind drag of the own speed."""
    times, states = run(load_vessel("forager"), 10.0, (90.0, 90.0), step_s=0.01)
    air = 0.5 * 1.224 * 0.45 * 0.55

    def slope(t: float, u: NDArray[np.float64]) -> NDArray[np.float64]:
        thrust = 2.0 * 0.01108 * (90.0 * (1.0 - math.exp(-t / 0.1))) ** 2
        drag = 77.55 + (30.0 + air) * u
        return np.asarray((thrust - drag * u) / 85.28)

    expected = solve_ivp(slope, (0.0, 10.0), [0.0], t_eval=times[:-1], rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(states[:-1, 3], expected.y[0], atol=1e-6)


@pytest.mark.parametrize("name", NAMES)
def test_turning_circles_to_both_sides_are_mirror_images(name: str) -> None:
    vessel = load_vessel(name)
    _, port = run(vessel, 60.0, turning(vessel))
    _, starboard = run(vessel, 60.0, turning(vessel, -1.0))
    mirror = np.array([1.0, -1.0, -1.0, 1.0, -1.0, -1.0])
    np.testing.assert_allclose(starboard * mirror, port, atol=1e-9)
    assert port[-1, 5] > 0.05  # less thrust to port turns to port
    assert port[-1, 4] < 0.0  # and the hull slides outwards


@pytest.mark.parametrize("name", NAMES)
def test_moving_with_the_current_is_still_water_carried_along(name: str) -> None:
    vessel, current = load_vessel(name), (0.3 * math.cos(0.7), 0.3 * math.sin(0.7))
    carried = Conditions(
        current_mps=current,
        wind_mps=current,
        heading_rad=0.4,
        velocity_mps=to_body(current, 0.4),
    )
    times, moving = run(vessel, 60.0, turning(vessel), carried)
    _, still = run(vessel, 60.0, turning(vessel), Conditions(heading_rad=0.4))
    np.testing.assert_allclose(moving[:, :2], still[:, :2] + times[:, None] * current, atol=1e-6)
    np.testing.assert_allclose(moving[:, [2, 5]], still[:, [2, 5]], atol=1e-6)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("heading", [0.5, 2.0, -2.5])
def test_all_headings_are_alike(name: str, heading: float) -> None:
    """Turned start, current and wind turn the whole motion."""
    vessel = load_vessel(name)
    c, s = math.cos(heading), math.sin(heading)
    current, wind = (0.2, -0.1), (-3.0, 2.0)

    def turned(vector: tuple[float, float]) -> tuple[float, float]:
        return c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]

    _, east = run(vessel, 60.0, turning(vessel), Conditions(current, wind))
    there = Conditions(turned(current), turned(wind), heading)
    _, other = run(vessel, 60.0, turning(vessel), there)
    np.testing.assert_allclose(other[:, :2] @ np.array([[c, -s], [s, c]]), east[:, :2], atol=1e-6)
    np.testing.assert_allclose(other[:, 2] - heading, east[:, 2], atol=1e-6)
    np.testing.assert_allclose(other[:, 3:], east[:, 3:], atol=1e-6)


@pytest.mark.parametrize("name", NAMES)
def test_step_halving_converges_with_the_fourth_order(name: str) -> None:
    """Without the scout's dead zone, whose jump no step resolves."""
    vessel = load_vessel(name)
    if isinstance(vessel.thruster, ForceThruster):
        smooth = dataclasses.replace(vessel.thruster, dead_zone_newton=0.0)
        vessel = dataclasses.replace(vessel, thruster=smooth)
    ends = {n: run(vessel, 8.0, turning(vessel), step_s=0.1 / n)[1][-1] for n in (1, 2, 4, 32)}
    errors = [float(np.abs(ends[n] - ends[32]).max()) for n in (1, 2, 4)]
    orders = [math.log2(a / b) for a, b in pairwise(errors)]
    assert all(3.7 < order < 4.5 for order in orders), orders


@pytest.mark.parametrize("name", NAMES)
def test_unpowered_hull_reaches_the_current(name: str) -> None:
    """In a calm that moves with the water, the hull ends at rest in the water."""
    flow = (0.3, 0.2)
    conditions = Conditions(current_mps=flow, wind_mps=flow, heading_rad=1.0)
    _, states = run(load_vessel(name), 2000.0, conditions=conditions, step_s=0.2)
    yaw, u, v = states[-1, 2:5]
    c, s = math.cos(yaw), math.sin(yaw)
    np.testing.assert_allclose((c * u - s * v, s * u + c * v), flow, atol=0.002)


def test_otter_loses_speed_to_the_water_at_the_rate_of_its_linear_drag() -> None:
    """From rest over ground, head on: u = c (1 - exp(-d t / M))."""
    times, states = run(load_vessel("otter"), 8.0, conditions=Conditions(current_mps=(0.4, 0.0)))
    np.testing.assert_allclose(
        states[:, 3], 0.4 * (1.0 - np.exp(-77.55 / 85.28 * times)), atol=1e-7
    )


@pytest.mark.parametrize(("speed", "grows"), [(1.0, False), (1.3, True)])
def test_otter_is_directionally_unstable_above_1_15_metres_per_second(
    speed: float, grows: bool
) -> None:
    command = math.sqrt(77.55 * speed / 2.0 / 0.01108)
    start = Conditions(velocity_mps=(speed, 0.0), yaw_rate_radps=1e-5)
    _, states = run(load_vessel("otter"), 60.0, (command, command), start)
    assert (abs(states[-1, 5]) > 2e-6) == grows


@pytest.mark.parametrize(
    ("name", "low", "high"), [("scout", 1.6, 2.0), ("forager", 1.7, 2.0), ("otter", 3.0, 3.15)]
)
def test_flat_out(name: str, low: float, high: float) -> None:
    vessel = load_vessel(name)
    top = vessel.thruster.command_range[1]
    _, states = run(vessel, 20.0, (top, top))
    assert low <= states[-1, 3] <= high
