"""Our Otter against the independent one, which has six degrees of freedom and marine axes."""

import math

import numpy as np
import pytest
from scipy.linalg import eigvals
from scipy.optimize import brentq

from mjforage.physics.hydrodynamics.conditions import Conditions
from mjforage.physics.manoeuvre import Schedule, run_manoeuvre
from mjforage.physics.simulation.mujoco_vessel import MujocoVessel
from mjforage.physics.vessels import load_vessel
from tests.mjforage.physics.validation import independent
from tests.mjforage.physics.validation.independent import IndependentOtter

OTTER = load_vessel("otter")


def test_the_independent_vessel_rolls_and_settles() -> None:
    """Its roll has the period of 967 N m/rad and 17.66 kg m2, coupled to sway by the high mass."""
    hull = IndependentOtter(OTTER, Conditions())
    hull._pose[3] = 0.1
    rolls = []
    for _ in range(400):
        hull.step(0.0, 0.0, 0.01)
        rolls.append(float(hull._pose[3]))
    passed = np.flatnonzero(np.diff(np.sign(rolls)))[:2]
    half = 0.01 * float(np.diff(passed)[0])
    stiff, damped = 967.0 / 17.66, 0.5 * 52.28 / 17.66
    assert half == pytest.approx(math.pi / math.sqrt(stiff - damped**2), rel=0.12)
    assert abs(rolls[-1]) < 1e-3


@pytest.mark.parametrize(("speed", "unstable"), [(1.15, False), (1.25, True)])
def test_straight_course_loses_its_stability_between(speed: float, unstable: bool) -> None:
    """Linear sway and yaw at a speed (Fossen 2021, section 15.1): about 1.2 m/s, by Munk.

    The side that turning makes faster gives less thrust, which damps the turn.
    """
    m, x, lever = independent.MASS_KG, independent.COG_X_M, independent.LEVER_M
    a11, a22, a66 = independent.ADDED[[0, 1, 5], [0, 1, 5]]

    def surplus(n: float) -> float:
        return 2.0 * independent.thrust(n, speed) - float(independent.DAMPING[0]) * speed

    command = float(brentq(surplus, 1.0, independent.N_MAX))
    fall = independent.thrust(command, speed - 1e-4) - independent.thrust(command, speed + 1e-4)
    yaw = 40.05 + 2.0 * lever**2 * fall / 2e-4
    mass = np.array([[m + a22, m * x], [m * x, 16.01 + a66]])
    slope = np.array([[162.5, (m + a11) * speed], [(a22 - a11) * speed, yaw + m * x * speed]])
    assert (eigvals(-slope, mass).real.max() > 0.0) == unstable
    start = Conditions(velocity_mps=(speed, 0.0), yaw_rate_radps=1e-4)
    steady = Schedule((0.0,), ((command, command),))
    run = run_manoeuvre(OTTER, steady, start, 120.0, simulate=MujocoVessel)
    early, late = np.abs(run.states[[400, -1], 5])
    assert (late > early) == unstable
