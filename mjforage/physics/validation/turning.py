"""Turning circles to both sides against their balance of forces, and one in a current."""

import math
from functools import partial

import numpy as np
from scipy.optimize import fsolve

from mjforage.physics.hydrodynamics.conditions import Conditions
from mjforage.physics.manoeuvre import Trajectory, key_figures, run_test
from mjforage.physics.simulation.mujoco_hull import MujocoHull
from mjforage.physics.validation import independent as otter
from mjforage.physics.validation.finding import Float64Array, Line, Measure, Panel, near, near_share
from mjforage.physics.validation.known_checks import Parts, check
from mjforage.physics.validation.shared_runs import CASES, case_name, momentum_run
from mjforage.physics.vessels import load_vessel

CURRENT = (0.24, -0.1)  # [m/s], 0.26 together
SHOWN = 1201  # rows of a minute
STEADY_S = 90.0
FIGURES = ("turning_speed", "turning_diameter", "drift_angle")
SIDES = {"port": "turning-circle", "starboard": "turning-circle-starboard"}


def steady_turn(inner_share: float = 0.2, outer_share: float = 0.6) -> tuple[float, float, float]:
    """Surge, sway [m/s] and yaw rate [rad/s] at which the Otter's forces balance, port positive.

    The three steady equations, written out from the published numbers and solved by root finding.

    Parameters
    ----------
    inner_share, outer_share : of the largest thrust ahead of the port and starboard propeller
    """
    most = otter.K_AHEAD * otter.N_MAX**2
    left, right = inner_share * most, outer_share * most
    a11, a22 = otter.ADDED[0, 0], otter.ADDED[1, 1]
    d11, d22, d66 = otter.DAMPING[[0, 1, 5]]
    m, x = otter.MASS_KG, otter.COG_X_M

    def balance(motion: Float64Array) -> tuple[float, float, float]:
        u, v, r = motion
        flow = v + otter.STRIP_X_M * r
        drag = -otter.STRIP_FACTOR * np.abs(flow) * flow
        surge = left + right - d11 * u + (m + a22) * v * r + m * x * r * r
        sway = drag.sum() - d22 * v - (m + a11) * u * r
        yaw = otter.LEVER_M * (right - left) + otter.STRIP_X_M @ drag
        yaw -= d66 * (1.0 + otter.YAW_GROWTH_S * abs(r)) * r + m * x * u * r + (a22 - a11) * u * v
        return float(surge), float(sway), float(yaw)

    u, v, r = fsolve(balance, [1.2, -0.1, 0.2])
    return float(u), float(v), float(r)


@check("turning-circle", "4", "Turning circle, both ways and in a current")
def turning_circle() -> Parts:
    """The plain otter with 0.2 of the largest thrust on one side and 0.6 on the other, for 180 s.

    Steady speed, yaw rate, diameter and drift angle against a root of the three steady equations,
    which is independent of the code that moves the hull. In a current of 0.26 m/s the circle's
    centre has to move with it. Then every hull, the forager with 100 items too, for 90 s against
    the momentum of hull and water.
    """
    vessel, (u, v, r) = load_vessel("otter"), steady_turn()
    runs = {side: run_test(vessel, test, simulate=MujocoHull) for side, test in SIDES.items()}
    measures = [m for side, run in runs.items() for m in _measures(side, run, (u, v, r))]
    here = Conditions(current_mps=CURRENT)
    carried = run_test(vessel, SIDES["port"], here, simulate=MujocoHull)
    drift = key_figures(carried)["centre_drift"].value
    measures.append(
        near_share("centre's drift in the current", drift, math.hypot(*CURRENT), 0.02, "m/s")
    )
    for name, load in CASES:
        measures += _against_momentum(name, load)
    return tuple(measures), _panels(runs | {"port, in current": carried}, r)


def _against_momentum(name: str, load: float) -> list[Measure]:
    hull, test = partial(MujocoHull, load=load), SIDES["port"]
    ours = run_test(load_vessel(name), test, duration_s=STEADY_S, simulate=hull)
    theirs = momentum_run(test, name, load, STEADY_S)
    found, expected = key_figures(ours), key_figures(theirs)
    return [
        near_share(
            f"{case_name(name, load)}: {figure.replace('_', ' ')}",
            found[figure].value,
            expected[figure].value,
            2e-3,
            expected[figure].unit,
        )
        for figure in FIGURES
    ]


def _measures(
    side: str, run: Trajectory, steady: tuple[float, float, float]
) -> tuple[Measure, ...]:
    u, v, r = steady
    speed, sign = math.hypot(u, v), 1.0 if side == "port" else -1.0
    found = {name: figure.value for name, figure in key_figures(run).items()}
    angle = sign * math.degrees(math.atan2(v, u))
    rate = float(run.states[-1, 5])
    return (
        near_share(f"{side}: speed", found["turning_speed"], speed, 1e-3, "m/s"),
        near_share(f"{side}: yaw rate", rate, sign * r, 1e-3, "rad/s"),
        near_share(f"{side}: diameter", found["turning_diameter"], 2.0 * speed / r, 2e-3, "m"),
        near(f"{side}: drift angle", found["drift_angle"], angle, 0.05, "deg"),
    )


def _panels(runs: dict[str, Trajectory], rate: float) -> tuple[Panel, ...]:
    tracks = tuple(
        Line(name, run.states[:, 0], run.states[:, 1], colour)
        for colour, (name, run) in enumerate(runs.items())
    )
    rates = tuple(
        Line(name, run.times_s[:SHOWN], np.degrees(run.states[:SHOWN, 5]), colour)
        for colour, (name, run) in enumerate(runs.items())
        if "current" not in name
    )
    ends, level = np.array([0.0, 60.0]), math.degrees(rate)
    steady = (
        Line("steady equations", ends, np.full(2, level), expected=True),
        Line("", ends, np.full(2, -level), expected=True),
    )
    return (
        Panel("Tracks over ground, 180 s", "x, east (m)", "y, north (m)", tracks, equal=True),
        Panel("Yaw rate, first minute", "time (s)", "counter-clockwise (deg/s)", (*rates, *steady)),
    )
