"""Zigzags against the independent hulls under the same helm."""

from functools import partial

import numpy as np

from mjforage.physics.manoeuvre import Trajectory, key_figures, run_test
from mjforage.physics.simulation.mujoco_hull import MujocoHull
from mjforage.physics.validation.finding import Line, Measure, Panel, near, near_share
from mjforage.physics.validation.known_checks import Parts, check
from mjforage.physics.validation.shared_runs import (
    CASES,
    case_name,
    independent_run,
    momentum_run,
)
from mjforage.physics.vessels import load_vessel

TESTS = {"10/10": "zigzag", "20/20": "zigzag-20"}
SHOWN_S = (10.0, 60.0)
MINUTE_S = 60.0


@check("zigzag", "5", "Zigzag 10/10 and 20/20")
def zigzag() -> Parts:
    """Overshoots and period at 0.3 +- 0.15 of the largest thrust per side, under the same helm.

    The plain otter against its independent model with six degrees of freedom, marine axes and its
    own integrator; every hull, the forager with 100 items too, in a 20/20 zigzag of a minute
    against the momentum of hull and water.
    """
    measures: list[Measure] = []
    panels = []
    for kind, test in TESTS.items():
        ours = run_test(load_vessel("otter"), test, simulate=MujocoHull)
        theirs = independent_run(test)
        measures += _measures(f"otter {kind}", ours, theirs, 0.05)
        panels.append(_panel(kind, ours, theirs))
    for name, load in CASES:
        hull = partial(MujocoHull, load=load)
        ours = run_test(load_vessel(name), "zigzag-20", duration_s=MINUTE_S, simulate=hull)
        theirs = momentum_run("zigzag-20", name, load, MINUTE_S)
        measures += _measures(f"{case_name(name, load)} 20/20", ours, theirs, 0.02)
    return tuple(measures), tuple(panels)


def _measures(kind: str, ours: Trajectory, theirs: Trajectory, slack_deg: float) -> list[Measure]:
    found, expected = key_figures(ours), key_figures(theirs)
    measures = [
        near(
            f"{kind}: {name.replace('_', ' ')}",
            found[name].value if name in found else np.nan,
            expected[name].value,
            slack_deg,
            "deg",
        )
        for name in expected
        if name.startswith("overshoot")
    ]
    period = found["period"].value
    return [*measures, near_share(f"{kind}: period", period, expected["period"].value, 0.005, "s")]


def _panel(kind: str, ours: Trajectory, theirs: Trajectory) -> Panel:
    seen = (ours.times_s >= SHOWN_S[0]) & (ours.times_s <= SHOWN_S[1])
    times, split = ours.times_s[seen], np.diff(ours.commands, axis=1)[seen, 0]
    ordered = np.sign(split) * float(kind.split("/")[0])
    return Panel(
        f"Zigzag {kind}",
        "time (s)",
        "heading, to port (deg)",
        (
            Line("execute", times, ordered, 1),
            Line("heading", times, np.degrees(ours.states[seen, 2])),
            Line("independent model", times, np.degrees(theirs.states[seen, 2]), expected=True),
        ),
    )
