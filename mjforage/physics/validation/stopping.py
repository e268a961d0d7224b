"""Crash stop: full astern from full speed."""

import math
from functools import partial

import numpy as np

from mjforage.physics.manoeuvre import Trajectory, key_figures, run_test
from mjforage.physics.manoeuvre.standard import AHEAD_S
from mjforage.physics.simulation.mujoco_hull import MujocoHull
from mjforage.physics.validation.finding import Float64Array, Line, Measure, Panel, near_share
from mjforage.physics.validation.known_checks import Parts, check
from mjforage.physics.validation.shared_runs import (
    CASES,
    case_name,
    independent_run,
    momentum_run,
)
from mjforage.physics.vessels import load_vessel

FIGURES = {"top_speed": "m/s", "stopping_time": "s", "stopping_distance": "m"}


@check("crash-stop", "6", "Crash stop")
def crash_stop() -> Parts:
    """Every hull flat out for 20 s, then full astern, the forager with 100 items too.

    Speed, time and track until it stops: of the plain otter against its independent model with six
    degrees of freedom, of all against the momentum of hull and water.
    """
    otter = run_test(load_vessel("otter"), "stop", simulate=MujocoHull)
    independent = independent_run("stop")
    measures = _measures("otter, six degrees of freedom", otter, independent, 0.01)
    for name, load in CASES:
        hull = partial(MujocoHull, load=load)
        ours = run_test(load_vessel(name), "stop", simulate=hull)
        theirs = momentum_run("stop", name, load, ours.times_s[-1])
        measures += _measures(case_name(name, load), ours, theirs, 1e-3)
    return tuple(measures), _panels(otter, independent)


def _measures(case: str, ours: Trajectory, theirs: Trajectory, share: float) -> list[Measure]:
    found, expected = key_figures(ours), key_figures(theirs)
    return [
        near_share(
            f"{case}: {name.replace('_', ' ')}",
            found[name].value if name in found else math.nan,
            expected[name].value,
            share,
            unit,
        )
        for name, unit in FIGURES.items()
    ]


def _panels(ours: Trajectory, theirs: Trajectory) -> tuple[Panel, ...]:
    seen = ours.times_s >= AHEAD_S - 1.0
    times = ours.times_s[seen] - AHEAD_S
    runs = (("MuJoCo", ours, False), ("independent model", theirs, True))
    speed = tuple(
        Line(name, times, run.states[seen, 3], expected=second) for name, run, second in runs
    )
    way = tuple(Line(name, times, _way(run)[seen], expected=second) for name, run, second in runs)
    return (
        Panel("Speed", "time after the order (s)", "surge (m/s)", speed),
        Panel("Track", "time after the order (s)", "way since the order (m)", way),
    )


def _way(run: Trajectory) -> Float64Array:
    """(row,) metres since the order."""
    x = run.states[:, 0]
    return np.asarray(x - np.interp(AHEAD_S, run.times_s, x))
