"""Time steps: convergence at the integrator's order, and the fast against the reference one."""

import math
from itertools import pairwise

import numpy as np

from mjforage.physics.hydrodynamics.conditions import Conditions, to_body
from mjforage.physics.simulation import Integrator
from mjforage.physics.validation.finding import Float64Array, Line, Measure, Panel, at_most, near
from mjforage.physics.validation.known_checks import Parts, check
from mjforage.physics.validation.shared_runs import (
    CASES,
    HARD,
    SPEED_KIND,
    STEP_S,
    TURN,
    case_name,
    clock,
    momentum_rows,
    ordered,
    scheduled,
)
from mjforage.physics.vessels import load_vessel

HALVED = {
    Integrator.REFERENCE: (0.1, 0.05, 0.025, 0.0125),
    Integrator.FAST: (0.1, 0.05, 0.025, 0.0125, 0.00625),
}
ORDERS = {Integrator.REFERENCE: 4, Integrator.FAST: 2}
FINEST_S = 0.003125
SECONDS = 10.0
OTTER = load_vessel("otter")
CURRENT, WIND, YAW = (0.15, 0.1), (2.5, -3.0), 0.3  # [m/s], [rad], of the hard manoeuvre


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
        slope_line = errors[-1] * (x / x[-1]) ** order
        lines.append(Line(f"order {order}", x, slope_line, colour, expected=True))
    panel = Panel(
        "Error after 10 s", "time step (s)", "position (m)", tuple(lines), log_x=True, log_y=True
    )
    return tuple(measures), (panel,)


def _end(integrator: Integrator, step_s: float) -> Float64Array:
    rows = scheduled(
        OTTER, ordered(OTTER, TURN), integrator, step_s,
        yaw=(0.3,), current=((0.2, 0.1),), seconds=SECONDS,
    )  # fmt: skip
    return np.asarray(rows[-1, 0, :2])


@check("fast-reference", "12b", "Both integrators against the independent hull")
def fast_reference() -> Parts:
    """A minute of hard manoeuvring of every hull, laden too: ahead, turning, spinning and astern.

    In a current of 0.18 m/s and a wind of 3.9 m/s, each integrator at its default step. Position
    against the momentum of hull and water; the reference has to be the more exact one.
    """
    measures: list[Measure] = []
    lines: list[Line] = []
    tracks: list[Line] = []
    for colour, (name, load) in enumerate(CASES):
        true, case = _true(name, load), case_name(name, load)
        off = {kind: _off(name, load, kind, true) for kind in Integrator}
        most = {kind: float(distance.max()) for kind, distance in off.items()}
        fast, fine = most[Integrator.FAST], most[Integrator.REFERENCE]
        measures += [
            at_most(f"{case}, fast: largest distance", fast, 6e-3, "m"),
            at_most(f"{case}, reference: largest distance", fine, 2e-3, "m"),
            at_most(f"{case}: reference over fast", fine / fast, 1.0),
        ]
        lines.append(Line(case, clock(len(true)), 1e3 * off[Integrator.FAST], colour))
        tracks.append(Line(case, true[:, 0], true[:, 1], colour))
    return tuple(measures), (
        Panel("The manoeuvre", "x, east (m)", "y, north (m)", tuple(tracks), equal=True),
        Panel("Distance of the fast integrator", "time (s)", "mm", tuple(lines)),
    )


def _true(name: str, load: float) -> Float64Array:
    vessel, start = load_vessel(name), to_body(CURRENT, YAW)
    here = Conditions(current_mps=CURRENT, wind_mps=WIND, heading_rad=YAW, velocity_mps=start)
    return momentum_rows(vessel, ordered(vessel, HARD), conditions=here, load=load)


def _off(name: str, load: float, integrator: Integrator, true: Float64Array) -> Float64Array:
    """(row,) distance from the independent run [m]."""
    vessel, step_s = load_vessel(name), integrator.step_s
    rows = scheduled(
        vessel, ordered(vessel, HARD), integrator, step_s,
        yaw=(YAW,), current=(CURRENT,), wind=(WIND,), load=load,
    )  # fmt: skip
    seen = rows[:: round(STEP_S / step_s), 0]
    return np.asarray(np.hypot(*(seen - true)[:, :2].T))
