"""MuJoCo with the callback and the plain ODE are two ways to the same manoeuvre."""

import numpy as np
import pytest

from mjforage.hydrodynamics.conditions import Conditions
from mjforage.manoeuvre import manoeuvre
from mjforage.simulation.errors import InstabilityError
from mjforage.simulation.hull import MujocoHull
from mjforage.vessels import load_vessel


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


def test_a_hull_that_moves_starts_with_its_velocity_over_ground() -> None:
    start = Conditions(heading_rad=0.7, velocity_mps=(0.5, -0.1), yaw_rate_radps=0.2)
    assert MujocoHull(load_vessel("otter"), start).state() == pytest.approx(start.start)


def test_instability_is_reported() -> None:
    hull = MujocoHull(load_vessel("otter"), Conditions(velocity_mps=(1e9, 1e9)))
    with pytest.raises(InstabilityError, match=r"unstable at seed 0, t = .* body"):
        for _ in range(50):
            hull.step(103.0, -101.0, 1.0)
