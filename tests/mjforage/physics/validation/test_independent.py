"""Our Otter against the independent one, which has six degrees of freedom and marine axes."""

import math

import numpy as np
import pytest
from scipy.linalg import eigvals

from mjforage.physics.hydrodynamics.conditions import Conditions
from mjforage.physics.manoeuvre import Schedule, run_manoeuvre
from mjforage.physics.simulation.mujoco_vessel import MujocoVessel
from mjforage.physics.vessels import load_vessel
from tests.mjforage.physics.validation import independent
from tests.mjforage.physics.validation.independent import IndependentOtter

OTTER = load_vessel("otter")
CASES = {
    "turn to starboard": (((0.0, 50.0, 30.0),), Conditions(), 60.0),
    "hard turn to starboard": (((0.0, 100.0, 40.0),), Conditions(), 60.0),
    "turn to port, carried": (
        ((2.0, 60.0, 80.0),),
        Conditions(current_mps=(0.2, -0.3), heading_rad=0.7),
        60.0,
    ),
    "spin": (((0.0, 60.0, -60.0), (20.0, -60.0, 60.0)), Conditions(), 40.0),
    "ahead, coasting": (((0.0, 60.0, 60.0), (15.0, 0.0, 0.0)), Conditions(), 30.0),
    "flat out, astern": (((0.0, 103.9, 103.9), (10.0, -101.7, -101.7)), Conditions(), 15.0),
    "open-loop zigzag": (
        ((0.0, 57.0, 57.0), *((15.0 + 3.5 * k, 40.0 + 29.0 * (k % 2), 69.0 - 29.0 * (k % 2))
                             for k in range(10))),
        Conditions(),
        50.0,
    ),
    "adrift": (((0.0, 0.0, 0.0),), Conditions(current_mps=(0.2, 0.3), heading_rad=0.5), 60.0),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_schedules_give_the_same_motion(case: str) -> None:
    """Roll, pitch and heave, which ours lacks, cost 3 cm and 0.2 degrees in a minute, no more."""
    rows, conditions, seconds = CASES[case]
    schedule = Schedule(tuple(t for t, _, _ in rows), tuple((a, b) for _, a, b in rows))
    ours, theirs = (
        run_manoeuvre(OTTER, schedule, conditions, seconds, simulate=kind).states
        for kind in (MujocoVessel, IndependentOtter)
    )
    off = np.abs(ours - theirs).max(axis=0)
    assert np.hypot(*off[:2]) < 0.04
    assert math.degrees(off[2]) < 0.25
    assert (off[3:5] < 0.03).all() and off[5] < 3e-3
    last = np.abs(ours - theirs)[-1]
    assert (last[3:5] < 1e-3).all() and last[5] < 3e-4


def test_the_independent_hull_rolls_and_settles() -> None:
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


@pytest.mark.parametrize(("speed", "unstable"), [(1.10, False), (1.20, True)])
def test_straight_course_loses_its_stability_between(speed: float, unstable: bool) -> None:
    """Linear sway and yaw at a speed (Fossen 2021, section 15.1): about 1.15 m/s, by Munk."""
    m, x = independent.MASS_KG, independent.COG_X_M
    a11, a22, a66 = independent.ADDED[[0, 1, 5], [0, 1, 5]]
    mass = np.array([[m + a22, m * x], [m * x, 16.01 + a66]])
    slope = np.array([[162.5, (m + a11) * speed], [(a22 - a11) * speed, 40.05 + m * x * speed]])
    assert (eigvals(-slope, mass).real.max() > 0.0) == unstable
    command = math.sqrt(77.55 * speed / 2.0 / independent.K_AHEAD)
    start = Conditions(velocity_mps=(speed, 0.0), yaw_rate_radps=1e-4)
    steady = Schedule((0.0,), ((command, command),))
    run = run_manoeuvre(OTTER, steady, start, 120.0, simulate=MujocoVessel)
    early, late = np.abs(run.states[[400, -1], 5])
    assert (late > early) == unstable
