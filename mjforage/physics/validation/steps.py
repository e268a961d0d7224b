"""Time steps: convergence at the integrator's order, and the fast against the reference one."""

import math
from itertools import pairwise

import numpy as np

from mjforage.physics.simulation import Integrator
from mjforage.physics.validation.finding import Float64Array, Line, Measure, Panel, at_most, near
from mjforage.physics.validation.known_checks import Parts, check
from mjforage.physics.validation.shared_runs import HARD, SPEED_KIND, STEP_S, TURN, clock, scheduled
from mjforage.physics.vessels import load_vessel

HALVED = {
    Integrator.REFERENCE: (0.1, 0.05, 0.025, 0.0125),
    Integrator.FAST: (0.1, 0.05, 0.025, 0.0125, 0.00625),
}
ORDERS = {Integrator.REFERENCE: 4, Integrator.FAST: 2}
FINEST_S = 0.003125
SECONDS = 10.0


@check("step-halving", "12a", "Step halving converges at the integrator's order")
def step_halving() -> Parts:
    """The otter's turn of 10 s in a current, from coarse to fine steps.

    Error of the last position against the reference integrator at 0.003125 s. The order is the
    slope between steps, the first pair left out: 4 for Runge-Kutta, 2 for the fast integrator.
    """
    true = _end(Integrator.REFERENCE, FINEST_S)
    measures: list[Measure] = []
    lines: list[Line] = []
    for colour, (integrator, steps) in enumerate(HALVED.items()):
        errors = [float(np.hypot(*(_end(integrator, h) - true))) for h in steps]
        order, kind = ORDERS[integrator], SPEED_KIND[integrator]
        found = [math.log2(a / b) for a, b in pairwise(errors)]
        for (h, _), slope in list(zip(pairwise(steps), found, strict=True))[1:]:
            label = f"{kind}: order from {h:g} to {h / 2:g} s"
            measures.append(near(label, slope, order, 0.4))
        x = np.array(steps)
        lines.append(Line(kind, x, np.array(errors), colour, points=True))
        lines.append(Line(f"order {order}", x, errors[-1] * (x / x[-1]) ** order, expected=True))
    panel = Panel(
        "Error after 10 s", "time step (s)", "position (m)", tuple(lines), log_x=True, log_y=True
    )
    return tuple(measures), (panel,)


def _end(integrator: Integrator, step_s: float) -> Float64Array:
    rows = scheduled(
        load_vessel("otter"), TURN, integrator, step_s,
        yaw=(0.3,), current=((0.2, 0.1),), seconds=SECONDS,
    )  # fmt: skip
    return np.asarray(rows[-1, 0, :2])


@check("fast-reference", "12b", "The fast integrator against the reference")
def fast_reference() -> Parts:
    """A minute of hard manoeuvring of the otter, ahead, turning and astern, at a step of 0.1 s.

    Position of both integrators against the reference one at 0.0125 s.
    """
    otter, fine = load_vessel("otter"), 0.0125
    true = scheduled(otter, HARD, Integrator.REFERENCE, fine)[:: round(STEP_S / fine), 0]
    measures, lines = [], []
    times = clock(len(true))
    for colour, integrator in enumerate(Integrator):
        rows = scheduled(otter, HARD, integrator)[:, 0]
        off = np.hypot(*(rows - true)[:, :2].T)
        label = f"{SPEED_KIND[integrator]}: largest distance"
        measures.append(at_most(label, float(off.max()), 0.02, "m"))
        lines.append(Line(SPEED_KIND[integrator], times, 1e3 * off, colour))
    track = (Line("track", true[:, 0], true[:, 1]),)
    return tuple(measures), (
        Panel("The manoeuvre", "x, east (m)", "y, north (m)", track, equal=True),
        Panel("Distance from the fine run", "time (s)", "mm", tuple(lines)),
    )
