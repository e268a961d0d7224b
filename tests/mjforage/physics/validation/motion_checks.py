"""Vessels alone on open water: rest, energy, straight runs, wind, current, acceleration."""

import math

import numpy as np
from scipy.integrate import solve_ivp

from mjforage.physics.hydrodynamics.conditions import Conditions
from mjforage.physics.hydrodynamics.parameters import pack
from mjforage.physics.hydrodynamics.thruster import command_for
from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Integrator, Simulation
from mjforage.physics.vessel_checks import (
    STEP_S,
    STOPPED,
    Float64Array,
    body_axes,
    coasting_error,
    energy_rise,
    first_vessel,
    inertia_matrix,
    run_schedule,
    straight_drag,
)
from mjforage.physics.vessels import Vessel, load_vessel
from tests.mjforage.physics.validation.measures import (
    Measure,
    Measures,
    at_most,
    check,
    near,
    near_share,
)
from tests.mjforage.physics.validation.momentum import thrust, wind_load
from tests.mjforage.physics.validation.runs import VESSELS, cases, momentum_rows

SHORT_S, AHEAD_S = 1e-4, 15.0
AROUND = np.linspace(0.0, 2.0 * math.pi, 25)[:-1] + 0.05  # headings, and where the wind blows to
WINDS_MPS = (2.0, 5.0, 10.0)
YAW, TURN_S, LONG_S = 0.6, 30.0, 600.0  # adrift
FORAGER_NEWTON = 31.9 + 25.6  # its linear drag and its empty collector's quadratic one at 1 m/s


@check("rest", "1")
def rest() -> Measures:
    """In still water and still air, thrusters stopped, at two headings, for 300 s."""
    found = []
    for name in VESSELS:
        for integrator in Integrator:
            rows = run_schedule(
                load_vessel(name), STOPPED, integrator, yaw=(0.4, -2.5), seconds=300.0
            )
            off = np.abs(rows - rows[0]).max()
            found.append(at_most(f"{name}: largest departure", off, 1e-9, "m or rad"))
    return found


@check("energy", "2")
def energy() -> Measures:
    """Kinetic energy of vessel and added mass, from six starts with surge, sway and yaw each."""
    return [
        at_most(f"{label}: rise", energy_rise(vessel, integrator), 1e-9)
        for label, vessel, load, integrator in cases()
        if not load
    ]


@check("straight", "3")
def straight() -> Measures:
    """From rest at 0.6 of the highest command, and coasting from 1.5 m/s.

    Against m u' = T - X(u) solved to ten digits with the thruster's lag, and against the closed
    form of Bernoulli's equation: the largest difference in speed.
    """
    found: Measures = []
    for label, vessel, load, integrator in cases():
        command = 0.6 * vessel.thruster.command_range[1]
        schedule, step_s = ((0.0, command, command),), integrator.step_s
        rows = run_schedule(vessel, schedule, integrator, step_s, seconds=AHEAD_S, load=load)
        ahead = body_axes(rows)[:: round(STEP_S / step_s), 0, 0]
        off = np.abs(ahead - _rising(vessel, command, load)).max()
        coast = coasting_error(vessel, integrator, load)
        found.append(at_most(f"{label}: accelerating", off, 2e-3, "m/s"))
        found.append(at_most(f"{label}: coasting", coast, 1e-4, "m/s"))
    return found


def _rising(vessel: Vessel, command: float, load: float) -> Float64Array:
    """Solve m u' = T - X(u) from rest; the lag acts on the command, the curve on the lagged one."""
    (mass, d, k), times = straight_drag(vessel, load), STEP_S * np.arange(AHEAD_S / STEP_S + 1)

    def slope(t: float, u: Float64Array) -> Float64Array:
        force = 2.0 * thrust(vessel, command * -math.expm1(-t / vessel.lag_s), float(u[0]))
        return np.asarray((force - (d + k * abs(u)) * u) / mass)

    solved = solve_ivp(
        slope, (0.0, times[-1]), [0.0], t_eval=times, max_step=0.02, rtol=1e-10, atol=1e-12
    )
    return np.asarray(solved.y[0])


@check("speeds", "3b")
def speeds() -> Measures:
    """After 40 s straight ahead: flat out, and the forager at the thrust of 1 m/s.

    The otter's is 6 knots (MSS); the scout's data sheet says 1.7 m/s; the forager needs the 57.5 N
    of its hull and empty collector for 1 m/s, and so much more moored that momentum theory leaves
    them.
    """
    otter, scout, forager = (load_vessel(name) for name in ("otter", "scout", "forager"))
    disc, side = 2.0 * 1025.0 * math.pi / 4.0 * 0.2**2, 0.5 * FORAGER_NEWTON
    power = 0.5 * side * (1.0 + math.sqrt(1.0 + 4.0 * side / disc))
    effort = float(command_for(pack(forager), (power * math.sqrt(disc)) ** (2.0 / 3.0)))
    top = [_speed(each, each.thruster.command_range[1]) for each in (scout, otter)]
    return [
        Measure("scout, flat out", top[0], 1.6, 2.0, "m/s"),
        near("otter, flat out", top[1], 6.0 * 0.5144, 0.003, "m/s"),
        near(f"forager at {FORAGER_NEWTON:.1f} N", _speed(forager, effort), 1.0, 0.01, "m/s"),
    ]


def _speed(vessel: Vessel, command: float) -> float:
    rows = run_schedule(vessel, ((0.0, command, command),), Integrator.REFERENCE, seconds=40.0)
    return float(body_axes(rows)[-1, 0, 0])


@check("wind-load", "10c")
def wind_force() -> Measures:
    """At rest in a wind of 8 m/s from 24 sides: first acceleration times the inertia.

    Against the load that Blendermann (1994) has for the angle that the wind comes from.
    """
    found: Measures = []
    flow = 8.0 * np.stack((np.cos(AROUND), np.sin(AROUND)), axis=-1)
    for label, vessel, load, integrator in cases("forager", "scout"):
        mirrored = np.array([wind_load(vessel, ahead, -port) for ahead, port in flow.tolist()])
        expected = mirrored * (1.0, -1.0, -1.0)
        scene = build_scene([vessel])
        simulation = Simulation(scene, len(flow), integrator=integrator, step_s=SHORT_S)
        simulation.load[:], simulation.vessel_wind[:, 0] = load, flow
        simulation.step()
        loads = body_axes(first_vessel(simulation)) / SHORT_S @ inertia_matrix(vessel, load)
        off = np.abs(loads - expected).max(axis=0) / np.abs(expected).max(axis=0)
        for axis, share in zip(("surge", "sway", "yaw"), off.tolist(), strict=True):
            found.append(at_most(f"{label}: {axis}, largest share off", share, 1e-3))
    return found


@check("drift", "10d")
def drift() -> Measures:
    """Thrusters stopped, winds of 2, 5 and 10 m/s, bow 34 degrees off where the wind blows to.

    Place and heading over 30 s against the momentum of vessel and water; speed after 600 s, beam to
    the wind, against the balance of Blendermann's load and sway drag.
    """
    found: Measures = []
    winds = [(wind, 0.0) for wind in WINDS_MPS]
    for label, vessel, load, integrator in cases("forager", "scout"):
        here = [Conditions(wind_mps=wind, heading_rad=YAW) for wind in winds]
        true = np.stack(
            [
                momentum_rows(vessel, STOPPED, conditions=one, load=load, seconds=TURN_S)
                for one in here
            ],
            axis=1,
        )
        rows = run_schedule(
            vessel, STOPPED, integrator, yaw=(YAW,), wind=winds, load=load, seconds=LONG_S
        )
        off = np.abs(true - rows[: len(true)])[..., :3].max()
        found.append(at_most(f"{label}: first 30 s", off, 2e-3, "m, rad"))
        for wind, motion in zip(WINDS_MPS, rows[-1], strict=True):
            share, law = 100.0 * math.hypot(*motion[3:5]) / wind, 100.0 * leeway(vessel, wind)
            found.append(near_share(f"{label}: drift in {wind:g} m/s", share, law, 5e-3, "%"))
    return found


def leeway(vessel: Vessel, wind_mps: float) -> float:
    """Share of the wind at which a vessel beam to it drifts: a (W - v)^2 = d v + k v^2."""
    flow, windage = vessel.crossflow, vessel.windage
    a = 0.5 * 1.224 * windage.area_side_m2 * windage.cdt
    k = vessel.quadratic_sway
    if flow is not None:
        k += 0.5 * flow.water_density_kgpm3 * flow.coefficient * flow.draft_m * flow.length_m
    b = vessel.linear_sway + 2.0 * a * wind_mps
    root = math.sqrt(b * b + 4.0 * (k - a) * a * wind_mps**2)
    return (root - b) / (2.0 * (k - a)) / wind_mps


@check("added-mass", "14c")
def added_mass() -> Measures:
    """At rest with running thrusters, port at 0.6 of the highest command, starboard at 0.3.

    First acceleration in body axes: the same at 24 headings, and that of the inertia with added
    mass, T = (m + X_a) u' in surge, two by two in sway and yaw.
    """
    found: Measures = []
    for label, vessel, load, integrator in cases():
        high = vessel.thruster.command_range[1]
        left, right = thrust(vessel, 0.6 * high, 0.0), thrust(vessel, 0.3 * high, 0.0)
        push = [left + right, 0.0, vessel.lever_m * (right - left)]
        expected = np.linalg.solve(inertia_matrix(vessel, load), push)
        scene = build_scene([vessel])
        simulation = Simulation(scene, AROUND.size, integrator=integrator, step_s=SHORT_S)
        pose = np.zeros((AROUND.size, 1, 3))
        pose[:, 0, 2] = AROUND
        simulation.place_vessels(pose)
        simulation.load[:] = load
        simulation.commands[:] = simulation.thruster_state[:] = 0.6 * high, 0.3 * high
        simulation.step()
        gained = body_axes(first_vessel(simulation)) / SHORT_S
        spread = np.ptp(gained, axis=0).max()
        surge, _, yaw = gained.mean(axis=0)
        found += [
            at_most(f"{label}: spread over headings", spread, 1e-9, "m/s²"),
            near_share(f"{label}: surge", surge, expected[0], 1e-3, "m/s²"),
            near_share(f"{label}: yaw", yaw, expected[2], 1e-3, "rad/s²"),
        ]
    return found
