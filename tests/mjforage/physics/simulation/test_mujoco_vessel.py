"""One vessel in MuJoCo, for manoeuvres."""

import dataclasses

import pytest

from mjforage.base.errors import UserError
from mjforage.physics.hydrodynamics.conditions import Conditions
from mjforage.physics.manoeuvre import run_test
from mjforage.physics.simulation.instability import InstabilityError
from mjforage.physics.simulation.mujoco_vessel import MujocoVessel
from mjforage.physics.vessels import load_vessel


@pytest.mark.parametrize("lag_s", [0.1, 0.01])
def test_long_steps_do_not_break_the_thrusters(lag_s: float) -> None:
    """Runge-Kutta on the lag alone is unstable beyond 2.785 time constants, silently."""
    vessel = dataclasses.replace(load_vessel("otter"), lag_s=lag_s)
    fine, coarse = (run_test(vessel, "stop", dt_s=dt) for dt in (0.005, 0.05))
    assert coarse.states[-1] == pytest.approx(fine.states[-1], abs=2e-3)


def test_lags_too_short_to_step_are_named() -> None:
    quick = dataclasses.replace(load_vessel("otter"), lag_s=1e-5)
    with pytest.raises(UserError, match=r"vessel otter: lag_s = 1e-05 s .*; give 0.001 s or more"):
        MujocoVessel(quick, Conditions())


def test_a_vessel_that_moves_starts_with_its_velocity_over_ground() -> None:
    start = Conditions(heading_rad=0.7, velocity_mps=(0.5, -0.1), yaw_rate_radps=0.2)
    assert MujocoVessel(load_vessel("otter"), start).state() == pytest.approx(start.start)


def test_instability_is_reported() -> None:
    hull = MujocoVessel(load_vessel("otter"), Conditions(velocity_mps=(1e9, 1e9)))
    with pytest.raises(InstabilityError, match=r"unstable at seed 0, t = .* body"):
        for _ in range(50):
            hull.step(103.0, -101.0, 1.0)
