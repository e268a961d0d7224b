"""Straight ahead: acceleration and coast-down against m u' = T - X(u), and top speeds."""

import math

import numpy as np
from scipy.integrate import solve_ivp

from mjforage.physics.hydrodynamics import command_for, pack
from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Integrator, Simulation
from mjforage.physics.validation.finding import (
    Float64Array,
    Line,
    Measure,
    Panel,
    at_most,
    dashed,
    near,
    within,
)
from mjforage.physics.validation.known_checks import Parts, check
from mjforage.physics.validation.momentum import thrust
from mjforage.physics.validation.shared_runs import (
    CASES,
    INTEGRATORS,
    SPEED_KIND,
    STEP_S,
    body_axes,
    case_name,
    clock,
    coasting,
    row,
    scheduled,
    straight_drag,
)
from mjforage.physics.vessels import Vessel, load_vessel

AHEAD_S = 15.0
SHARE = 0.6  # of the highest command
FORAGER_NEWTON = 77.55 + 30.0  # hull's linear and empty collector's quadratic drag at 1 m/s


@check("straight", "3", "Acceleration and coast-down")
def straight() -> Parts:
    """From rest at 0.6 of the highest command, and coasting from 1.5 m/s with stopped thrusters.

    Every hull, the forager with 100 items too. Acceleration against m u' = T - X(u) solved to ten
    digits with the thruster's lag; coast-down against the closed form of Bernoulli's equation, an
    exponential for the linear otter and a hyperbola for the quadratic scout. The largest difference
    in speed over the run.
    """
    measures: list[Measure] = []
    rising: list[Line] = []
    falling: list[Line] = []
    for colour, (name, load) in enumerate(CASES):
        vessel, case = load_vessel(name), case_name(name, load)
        command = SHARE * vessel.thruster.command_range[1]
        times = clock(round(AHEAD_S / STEP_S) + 1)
        risen = _rising(vessel, command, times, load)
        fallen = coasting(vessel, 1.5, times, load)
        for integrator in INTEGRATORS:
            schedule = ((0.0, command, command),)
            step_s = integrator.step_s
            run = scheduled(vessel, schedule, integrator, step_s, seconds=AHEAD_S, load=load)
            ahead = body_axes(run)[:: round(STEP_S / step_s), 0, 0]
            coast = _coast(vessel, integrator, load)
            kind = f"{case}, {SPEED_KIND[integrator]}"
            off = float(np.abs(ahead - risen).max())
            measures.append(at_most(f"{kind}: accelerating", off, 2e-3, "m/s"))
            off = float(np.abs(coast - fallen).max())
            measures.append(at_most(f"{kind}: coasting", off, 1e-4, "m/s"))
        rising += [Line(case, times, ahead, colour), Line("", times, risen, expected=True)]
        falling += [Line(case, times, coast, colour), Line("", times, fallen, expected=True)]
    law, form = dashed("m u' = T − X(u)"), dashed("closed form")
    return tuple(measures), (
        Panel("From rest, 0.6 of the top command", "time (s)", "surge (m/s)", (*rising, law)),
        Panel("Coasting from 1.5 m/s", "time (s)", "surge (m/s)", (*falling, form)),
    )


def _coast(vessel: Vessel, integrator: Integrator, load: float) -> Float64Array:
    """(row,) surge from 1.5 m/s with stopped thrusters."""
    simulation = Simulation(build_scene([vessel]), integrator=integrator, step_s=0.1)
    simulation.place_vessels(np.zeros(3), np.array([1.5, 0.0, 0.0]))
    simulation.load[:] = load
    rows = [row(simulation)]
    for _ in range(round(AHEAD_S / STEP_S)):
        simulation.step()
        rows.append(row(simulation))
    return np.asarray(body_axes(np.array(rows))[:, 0, 0])


def _rising(vessel: Vessel, command: float, times: Float64Array, load: float) -> Float64Array:
    """Solve m u' = T - X(u) from rest; the lag acts on the command, the curve on the lagged one."""
    mass, d, k = straight_drag(vessel, load)

    def slope(t: float, u: Float64Array) -> Float64Array:
        force = 2.0 * thrust(vessel, command * -math.expm1(-t / vessel.lag_s))
        return np.asarray((force - (d + k * abs(u)) * u) / mass)

    solved = solve_ivp(
        slope, (0.0, times[-1]), [0.0], t_eval=times, max_step=0.02, rtol=1e-10, atol=1e-12
    )
    return np.asarray(solved.y[0])


@check("speeds", "3b", "Top speeds and effort")
def speeds() -> Parts:
    """Speed after 40 s straight ahead: flat out, and the forager at the thrust of 1 m/s.

    The otter's is T/d = 2 x 119.7 N / 77.55 N s/m; the scout's data sheet says 1.7 m/s; the forager
    needs about 80 N and its empty collector's 30 N for 1 m/s.
    """
    top = {name: _flat_out(load_vessel(name)) for name in ("otter", "scout")}
    forager = load_vessel("forager")
    effort = float(command_for(pack(forager), 0.5 * FORAGER_NEWTON))
    slow = _speed(forager, effort)
    return (
        within("scout, flat out", top["scout"], 1.6, 2.0, "m/s"),
        near("otter, flat out", top["otter"], 2.0 * 119.7 / 77.55, 0.003, "m/s"),
        near(f"forager at {FORAGER_NEWTON:.1f} N", slow, 1.0, 0.01, "m/s"),
    ), ()


def _flat_out(vessel: Vessel) -> float:
    return _speed(vessel, vessel.thruster.command_range[1])


def _speed(vessel: Vessel, command: float) -> float:
    rows = scheduled(vessel, ((0.0, command, command),), Integrator.REFERENCE, seconds=40.0)
    return float(body_axes(rows)[-1, 0, 0])
