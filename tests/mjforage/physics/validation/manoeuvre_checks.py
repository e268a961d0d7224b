"""Manoeuvres against independent vessels and balances of force, in currents and at all headings."""

import math
from functools import partial
from itertools import pairwise

import numpy as np
from scipy.optimize import fsolve

from mjforage.physics.hydrodynamics.conditions import Conditions, to_body
from mjforage.physics.manoeuvre import Trajectory, key_figures, run_test
from mjforage.physics.simulation import Integrator
from mjforage.physics.simulation.mujoco_vessel import MujocoVessel
from mjforage.physics.vessel_checks import (
    HARD,
    STEP_S,
    Float64Array,
    in_commands,
    run_schedule,
)
from mjforage.physics.vessels import load_vessel
from tests.mjforage.physics.validation import independent as otter
from tests.mjforage.physics.validation.measures import Measures, at_most, check, near, near_share
from tests.mjforage.physics.validation.runs import (
    CASES,
    TURN,
    case_name,
    cases,
    independent_run,
    momentum_rows,
    momentum_run,
)

SIDES = {"port": "turning-circle", "starboard": "turning-circle-starboard"}
CURRENT, WIND, YAW = (0.15, 0.1), (2.5, -3.0), 0.3  # [m/s], [rad], of the hard manoeuvre
BREEZE = (3.0, -3.0)  # [m/s]
HEADINGS = np.array([0.0, 0.5, 2.0, -2.5, 3.1])
CURRENTS = np.array([(0.3 * math.cos(a), 0.3 * math.sin(a)) for a in (0.0, 1.0, 2.5, -2.0)])
HALVED = {
    Integrator.REFERENCE: (4, (0.1, 0.05, 0.025, 0.0125)),
    Integrator.FAST: (2, (0.05, 0.025, 0.0125, 0.00625)),
}
FINEST_S = 0.003125


def steady_turn(inner_share: float = 0.2, outer_share: float = 0.6) -> tuple[float, float, float]:
    """Surge, sway [m/s] and yaw rate [rad/s] at which the Otter's forces balance, port positive.

    The three steady equations, written out from the published numbers and solved by root finding.

    Parameters
    ----------
    inner_share, outer_share : of the largest moored thrust of the port and starboard propeller
    """
    most = otter.K_AHEAD * otter.N_MAX**2
    inner, outer = (math.sqrt(share * most / otter.K_AHEAD) for share in (inner_share, outer_share))
    a11, a22 = otter.ADDED[0, 0], otter.ADDED[1, 1]
    d11, d22, d66 = otter.DAMPING[[0, 1, 5]]
    m, x = otter.MASS_KG, otter.COG_X_M

    def balance(motion: Float64Array) -> tuple[float, float, float]:
        u, v, r = motion
        flow = v + otter.STRIP_X_M * r
        drag = -otter.STRIP_FACTOR * np.abs(flow) * flow
        left = otter.thrust(inner, u - otter.LEVER_M * r)
        right = otter.thrust(outer, u + otter.LEVER_M * r)
        surge = left + right - d11 * u + (m + a22) * v * r + m * x * r * r
        sway = drag.sum() - d22 * v - (m + a11) * u * r
        yaw = otter.LEVER_M * (right - left) + otter.STRIP_X_M @ drag
        yaw -= d66 * (1.0 + otter.YAW_GROWTH_S * abs(r)) * r + m * x * u * r + (a22 - a11) * u * v
        return float(surge), float(sway), float(yaw)

    u, v, r = fsolve(balance, [1.2, -0.1, 0.2])
    return float(u), float(v), float(r)


def figures(run: Trajectory) -> dict[str, float]:
    """Key figures of a run."""
    return {name: figure.value for name, figure in key_figures(run).items()}


@check("turning-circle", "4")
def turning_circle() -> Measures:
    """The otter with 0.2 of the largest thrust on one side and 0.6 on the other, for 180 s.

    Against a root of the three steady equations. In a current of 0.26 m/s the circle's centre moves
    with it. Every vessel for 90 s against the momentum of vessel and water.
    """
    vessel, (u, v, r) = load_vessel("otter"), steady_turn()
    speed, found = math.hypot(u, v), []
    for side, test in SIDES.items():
        run, sign = run_test(vessel, test, simulate=MujocoVessel), 1.0 if side == "port" else -1.0
        key, angle = figures(run), sign * math.degrees(math.atan2(v, u))
        rate = float(run.states[-1, 5])
        found += [
            near_share(f"{side}: speed", key["turning_speed"], speed, 1e-3, "m/s"),
            near_share(f"{side}: yaw rate", rate, sign * r, 1e-3, "rad/s"),
            near_share(f"{side}: diameter", key["turning_diameter"], 2.0 * speed / r, 2e-3, "m"),
            near(f"{side}: drift angle", key["drift_angle"], angle, 0.05, "deg"),
        ]
    here = Conditions(current_mps=(0.24, -0.1))
    carried = figures(run_test(vessel, SIDES["port"], here, simulate=MujocoVessel))
    found.append(near_share("centre's drift in the current", carried["centre_drift"], 0.26, 0.02))
    units = {"turning_speed": "m/s", "turning_diameter": "m", "drift_angle": "deg"}
    for name, load in CASES:
        found += _against_momentum("turning-circle", name, load, 90.0, 2e-3, units)
    return found


def _against_momentum(
    test: str, name: str, load: float, seconds: float | None, share: float, units: dict[str, str]
) -> Measures:
    """Key figures of a vessel against those of `MomentumVessel`."""
    hull = partial(MujocoVessel, load=load)
    ours = run_test(load_vessel(name), test, duration_s=seconds, simulate=hull)
    theirs = momentum_run(test, name, load, float(ours.times_s[-1]))
    return _compared(case_name(name, load), ours, theirs, share, units)


def _compared(
    label: str, ours: Trajectory, theirs: Trajectory, share: float, units: dict[str, str]
) -> Measures:
    found, expected = figures(ours), figures(theirs)
    return [
        near_share(
            f"{label}: {key.replace('_', ' ')}",
            found.get(key, math.nan),
            expected[key],
            share,
            unit,
        )
        for key, unit in units.items()
    ]


@check("zigzag", "5")
def zigzag() -> Measures:
    """Overshoots and period at 0.2 +- 0.1 of the largest moored thrust per side.

    The otter against its independent model with six degrees of freedom; every vessel in a 20/20
    zigzag of a minute against the momentum of vessel and water.
    """
    found: Measures = []
    for kind, test in (("10/10", "zigzag"), ("20/20", "zigzag-20")):
        ours = run_test(load_vessel("otter"), test, simulate=MujocoVessel)
        found += _overshoots(f"otter {kind}", ours, independent_run(test), 0.05)
    for name, load in CASES:
        hull = partial(MujocoVessel, load=load)
        ours = run_test(load_vessel(name), "zigzag-20", duration_s=60.0, simulate=hull)
        theirs = momentum_run("zigzag-20", name, load, 60.0)
        found += _overshoots(f"{case_name(name, load)} 20/20", ours, theirs, 0.02)
    return found


def _overshoots(kind: str, ours: Trajectory, theirs: Trajectory, slack_deg: float) -> Measures:
    found, expected = figures(ours), figures(theirs)
    swings = [key for key in expected if key.startswith("overshoot")]
    off = [
        near(f"{kind}: {key.replace('_', ' ')}", found.get(key, math.nan), value, slack_deg, "deg")
        for key, value in expected.items()
        if key in swings
    ]
    return [*off, *_compared(kind, ours, theirs, 0.005, {"period": "s"})]


@check("crash-stop", "6")
def crash_stop() -> Measures:
    """Every vessel flat out for 20 s, then full astern: speed, time and track until it stops.

    The otter against its independent model with six degrees of freedom, all against the momentum
    of vessel and water.
    """
    units = {"top_speed": "m/s", "stopping_time": "s", "stopping_distance": "m"}
    run = run_test(load_vessel("otter"), "stop", simulate=MujocoVessel)
    label = "otter, six degrees of freedom"
    found = _compared(label, run, independent_run("stop"), 0.01, units)
    for name, load in CASES:
        found += _against_momentum("stop", name, load, None, 1e-3, units)
    return found


@check("galilean", "8")
def galilean() -> Measures:
    """A turning circle of 60 s in four currents of 0.3 m/s, begun moving with them.

    In a wind that blows at 4.2 m/s over the water: largest difference in position and heading from
    the circle in still water and the current's way together.
    """
    found: Measures = []
    for label, vessel, load, integrator in cases():
        turn = in_commands(vessel, TURN)
        still = run_schedule(vessel, turn, integrator, wind=(BREEZE,), load=load)[..., :3]
        currents, winds = CURRENTS.tolist(), (CURRENTS + BREEZE).tolist()
        moved = run_schedule(vessel, turn, integrator, current=currents, wind=winds, load=load)
        off = moved[..., :3] - still
        off[..., :2] -= STEP_S * np.arange(len(off))[:, None, None] * CURRENTS
        found.append(at_most(f"{label}: departure", np.abs(off).max(), 1e-6, "m, rad"))
    return found


@check("heading", "9")
def heading() -> Measures:
    """The same circle from five headings, turned back, in a wind that is turned with it."""
    found: Measures = []
    c, s = np.cos(HEADINGS), np.sin(HEADINGS)
    winds = np.stack((c * BREEZE[0] - s * BREEZE[1], s * BREEZE[0] + c * BREEZE[1]), -1).tolist()
    for label, vessel, load, integrator in cases():
        turn = in_commands(vessel, TURN)
        rows = run_schedule(vessel, turn, integrator, yaw=HEADINGS.tolist(), wind=winds, load=load)
        x, y, yaw = np.moveaxis(rows[..., :3], -1, 0)
        back = np.stack((c * x + s * y, c * y - s * x, yaw - HEADINGS))
        off = np.abs(back - back[..., :1]).max()
        found.append(at_most(f"{label}: departure", off, 1e-6, "m, rad"))
    return found


@check("step-halving", "12a")
def step_halving() -> Measures:
    """The otter's turn of 10 s in a current, from coarse to fine steps.

    Error of the last position against the reference integrator at 0.003125 s. The order is the
    slope between steps, the first pair left out: 4 for Runge-Kutta, 2 for the fast integrator.
    """
    found: Measures = []
    true = _end(Integrator.REFERENCE, FINEST_S)
    for integrator, (order, steps) in HALVED.items():
        errors = [float(np.hypot(*(_end(integrator, h) - true))) for h in steps]
        for h, (a, b) in list(zip(steps, pairwise(errors), strict=False))[1:]:
            label = f"{integrator.value}: order from {h:g} to {h / 2:g} s"
            found.append(near(label, math.log2(a / b), order, 0.4))
    return found


def _end(integrator: Integrator, step_s: float) -> Float64Array:
    vessel = load_vessel("otter")
    rows = run_schedule(
        vessel, in_commands(vessel, TURN), integrator, step_s,
        yaw=(0.3,), current=((0.2, 0.1),), seconds=10.0,
    )  # fmt: skip
    return np.asarray(rows[-1, 0, :2])


@check("fast-reference", "12b")
def fast_reference() -> Measures:
    """A minute of hard manoeuvring in a current of 0.18 m/s and a wind of 3.9 m/s.

    Each integrator at its default step. Position against the momentum of vessel and water; the
    reference has to be the more exact one.
    """
    found: Measures = []
    here = Conditions(CURRENT, WIND, YAW, to_body(CURRENT, YAW))
    for name, load in CASES:
        vessel, most = load_vessel(name), {}
        schedule = in_commands(vessel, HARD)
        true = momentum_rows(vessel, schedule, conditions=here, load=load)
        for integrator in Integrator:
            step_s = integrator.step_s
            rows = run_schedule(
                vessel, schedule, integrator, step_s,
                yaw=(YAW,), current=(CURRENT,), wind=(WIND,), load=load,
            )  # fmt: skip
            off = (rows[:: round(STEP_S / step_s), 0] - true)[:, :2]
            most[integrator.value] = float(np.hypot(*off.T).max())
        case, fast, fine = case_name(name, load), most["fast"], most["reference"]
        found += [
            at_most(f"{case}, fast: largest distance", fast, 6e-3, "m"),
            at_most(f"{case}, reference: largest distance", fine, 2e-3, "m"),
            at_most(f"{case}: reference over fast", fine / fast, 1.0),
        ]
    return found
