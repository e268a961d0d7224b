"""MuJoCo with the callback and the plain ODE are two ways to the same manoeuvre."""

import dataclasses

import numpy as np
import pytest

from mjforage.base.errors import UserError
from mjforage.physics.hydrodynamics.conditions import Conditions
from mjforage.physics.hydrodynamics.ode_hull import OdeHull
from mjforage.physics.manoeuvre import manoeuvre, run_test
from mjforage.physics.simulation.instability import InstabilityError
from mjforage.physics.simulation.mujoco_hull import MujocoHull
from mjforage.physics.vessels import load_vessel


@pytest.mark.parametrize(
    ("vessel", "test", "current", "wind"),
    [
        ("otter", "turning-circle", "0@0", "0@0"),
        ("otter", "zigzag", "0.3@90", "0@0"),
        ("otter", "straight", "0@0", "0@0"),
        ("scout", "stop", "0@0", "3@45"),
        ("forager", "turning-circle", "0.2@10", "6@90"),
        ("forager", "drift", "0.3@40", "8@10"),
    ],
)
def test_mujoco_moves_a_hull_like_the_equations_of_motion(
    vessel: str, test: str, current: str, wind: str
) -> None:
    """Positions to 2 mm and yaw to 1e-4 rad over one to three minutes.

    The rest is the thrusters' lag, which MuJoCo integrates and the oracle solves.
    """
    ode = manoeuvre(vessel, test=test, current=current, wind=wind).states
    boat = manoeuvre(vessel, test=test, current=current, wind=wind, simulate=MujocoHull).states
    assert ode.shape == boat.shape
    assert np.abs(boat[:, :2] - ode[:, :2]).max() < 2e-3
    assert np.abs(boat[:, 2] - ode[:, 2]).max() < 1e-4
    assert np.abs(boat[:, 3:] - ode[:, 3:]).max() < 1e-3


@pytest.mark.parametrize(("name", "lag_s"), [("otter", 0.1), ("scout", 0.2), ("otter", 0.01)])
@pytest.mark.parametrize("dt_s", [0.35, 0.5, 1.0])
def test_long_steps_do_not_break_the_thrusters(name: str, lag_s: float, dt_s: float) -> None:
    """Runge-Kutta on the lag alone is unstable beyond 2.785 time constants, silently."""
    vessel = dataclasses.replace(load_vessel(name), lag_s=lag_s)
    ode, boat = (
        run_test(vessel, "stop", duration_s=30.0, dt_s=dt, simulate=hull)
        for dt, hull in ((0.01, OdeHull), (dt_s, MujocoHull))
    )
    same = np.searchsorted(ode.times_s, boat.times_s[-1])
    assert boat.states[-1] == pytest.approx(ode.states[same], abs=2e-3)


@pytest.mark.parametrize("name", ["otter", "forager", "scout"])
def test_steps_of_shipped_vessels_stay_whole(name: str) -> None:
    """A step of 0.05 s, however rounded, is one step of MuJoCo."""
    hull = MujocoHull(load_vessel(name), Conditions())
    assert [hull.substeps(h) for h in (1e-9, 0.01, 0.05, 0.05 + 1e-9)] == [1, 1, 1, 1]
    assert [hull.substeps(h) for h in (0.0501, 0.1, 1.0)] == [2, 2, 20]


def test_lags_too_short_to_step_are_named() -> None:
    quick = dataclasses.replace(load_vessel("otter"), lag_s=1e-5)
    with pytest.raises(UserError, match=r"vessel otter: lag_s = 1e-05 s .*; give 0.001 s or more"):
        MujocoHull(quick, Conditions())


def test_a_hull_that_moves_starts_with_its_velocity_over_ground() -> None:
    start = Conditions(heading_rad=0.7, velocity_mps=(0.5, -0.1), yaw_rate_radps=0.2)
    assert MujocoHull(load_vessel("otter"), start).state() == pytest.approx(start.start)


def test_instability_is_reported() -> None:
    hull = MujocoHull(load_vessel("otter"), Conditions(velocity_mps=(1e9, 1e9)))
    with pytest.raises(InstabilityError, match=r"unstable at seed 0, t = .* body"):
        for _ in range(50):
            hull.step(103.0, -101.0, 1.0)
