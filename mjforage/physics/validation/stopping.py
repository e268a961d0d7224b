"""Crash stop: full astern from full speed."""

import numpy as np

from mjforage.physics.manoeuvre import Trajectory, key_figures, run_test
from mjforage.physics.manoeuvre.standard import AHEAD_S
from mjforage.physics.simulation.mujoco_hull import MujocoHull
from mjforage.physics.validation.finding import Float64Array, Line, Panel, near_share
from mjforage.physics.validation.known_checks import Parts, check
from mjforage.physics.validation.shared_runs import independent_run
from mjforage.physics.vessels import load_vessel

FIGURES = {"top_speed": "m/s", "stopping_time": "s", "stopping_distance": "m"}


@check("crash-stop", "6", "Crash stop")
def crash_stop() -> Parts:
    """The plain otter flat out for 20 s, then full astern.

    Speed, time and track until it stops, against the independent model of the same hull.
    """
    ours = run_test(load_vessel("otter"), "stop", simulate=MujocoHull)
    theirs = independent_run("stop")
    found, expected = key_figures(ours), key_figures(theirs)
    measures = tuple(
        near_share(name.replace("_", " "), found[name].value, expected[name].value, 0.01, unit)
        for name, unit in FIGURES.items()
    )
    return measures, _panels(ours, theirs)


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
