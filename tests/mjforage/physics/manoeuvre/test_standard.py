"""Standard tests and their key figures, against closed forms and balances of force."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from mjforage.physics.hydrodynamics.conditions import Conditions
from mjforage.physics.manoeuvre import STANDARD_TESTS, key_figures, run_test
from mjforage.physics.manoeuvre.key_figures import (
    coast_time_s,
    crossing_s,
    last_turn_s,
    rise_time_s,
    zigzag_figures,
)
from mjforage.physics.manoeuvre.standard import shares
from mjforage.physics.vessels import load_vessel

OTTER, SCOUT, FORAGER = (load_vessel(name) for name in ("otter", "scout", "forager"))
TIMES = np.linspace(0.0, 40.0, 4001)


def figures(vessel: str, test: str, conditions: Conditions | None = None) -> dict[str, float]:
    run = run_test(load_vessel(vessel), test, conditions)
    return {name: figure.value for name, figure in key_figures(run).items()}


def test_rise_and_coast_of_an_exponential_are_its_time_constant() -> None:
    assert rise_time_s(TIMES, 1.0 - np.exp(-TIMES / 3.0)) == pytest.approx(3.0, abs=1e-4)
    assert coast_time_s(TIMES, 2.0 * np.exp(-TIMES / 3.0)) == pytest.approx(3.0, abs=1e-4)
    assert rise_time_s(TIMES + 5.0, 1.0 - np.exp(-TIMES / 3.0)) == pytest.approx(3.0, abs=1e-4)


def test_crossing_lies_between_rows_or_is_nan() -> None:
    times, values = np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0, 3.0])
    assert crossing_s(times, values, 2.0) == 1.5
    assert math.isnan(crossing_s(times, values, 5.0))


def test_last_turn_of_a_steady_and_of_no_turn() -> None:
    assert last_turn_s(TIMES, -0.5 * TIMES) == pytest.approx(2.0 * math.pi / 0.5)
    assert math.isnan(last_turn_s(TIMES, 0.1 * TIMES))


def test_zigzag_of_a_sine_by_hand() -> None:
    """14 degrees sin(2 pi t / 8) overshoots 10 degrees by 4, with a period of 8 s."""
    heading = np.radians(14.0) * np.sin(2.0 * np.pi * TIMES / 8.0)
    overshoots, period = zigzag_figures(TIMES, heading, math.radians(10.0))
    np.testing.assert_allclose(np.degrees(overshoots), 4.0, atol=1e-4)
    assert len(overshoots) == 9  # the last of ten half swings is cut off
    assert period == pytest.approx(8.0, abs=1e-6)


def test_zigzag_without_a_swing_has_no_figures() -> None:
    overshoots, period = zigzag_figures(TIMES, 0.01 * TIMES, 0.1)
    assert overshoots == []
    assert math.isnan(period)


def test_shares_are_of_the_thrust_of_each_way() -> None:
    assert shares(SCOUT, 0.5, -0.5) == pytest.approx((16.8, -9.95))
    assert shares(OTTER, 1.0, -1.0) == pytest.approx((103.94, -101.74))
    assert shares(OTTER, 0.25, 0.0) == pytest.approx((51.97, 0.0))


@pytest.mark.parametrize("test", STANDARD_TESTS)
@pytest.mark.parametrize("vessel", ["otter", "scout", "forager"])
def test_every_test_gives_finite_figures_with_unit_and_meaning(vessel: str, test: str) -> None:
    run = run_test(load_vessel(vessel), test)
    found = key_figures(run)
    assert {"top_speed", "final_speed", "distance"} <= set(found)
    assert all(math.isfinite(f.value) and f.unit and f.meaning for f in found.values())


@pytest.mark.parametrize(("test", "angle"), [("zigzag", 10.0), ("zigzag-20", 20.0)])
def test_zigzag_reverses_past_its_angle_on_both_sides(test: str, angle: float) -> None:
    run = run_test(OTTER, test, Conditions(heading_rad=1.0))
    heading = np.degrees(run.states[:, 2] - 1.0)
    switches = np.flatnonzero(np.diff(run.commands[:, 0] - run.commands[:, 1]))[1:] + 1
    assert switches.size > 10
    rate = np.degrees(np.abs(run.states[:, 5]).max())
    assert (np.abs(heading[switches]) >= angle).all()
    assert (np.abs(heading[switches]) < angle + 0.05 * rate).all()
    assert (np.sign(heading[switches[1:]]) == -np.sign(heading[switches[:-1]])).all()
    overshoots = [v.value for k, v in key_figures(run).items() if k.startswith("overshoot")]
    assert len(overshoots) == 4
    assert np.abs(heading).max() == pytest.approx(angle + max(overshoots), abs=0.3)


def test_leeway_of_the_forager_head_to_wind_balances_air_and_water() -> None:
    """1/2 rho A CDl (W - s)^2 = (d + k s) s of the speed s astern."""

    def surplus(s: float) -> float:
        return 0.5 * 1.224 * 0.45 * 0.55 * (8.0 - s) ** 2 - (31.9 + 25.6 * s) * s

    speed = brentq(surplus, 0.0, 1.0)
    found = figures("forager", "drift", Conditions(wind_mps=(-8.0, 0.0)))
    assert found["drift_speed"] == pytest.approx(speed, rel=1e-6)
    assert found["leeway"] == pytest.approx(speed / 0.08, rel=1e-6)


def test_a_vessel_that_feels_no_wind_has_no_leeway_rather_than_none_of_it() -> None:
    found = figures("otter", "drift", Conditions(wind_mps=(0.0, 8.0)))
    assert "leeway" not in found and found["drift_speed"] == 0.0
