"""Wind on hulls: its load from every side, and how hulls go adrift."""

import math

import numpy as np

from mjforage.physics.hydrodynamics.conditions import Conditions
from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Integrator, Simulation
from mjforage.physics.validation.finding import (
    Float64Array,
    Line,
    Measure,
    Panel,
    at_most,
    near_share,
)
from mjforage.physics.validation.known_checks import Parts, check
from mjforage.physics.validation.momentum import wind_load
from mjforage.physics.validation.shared_runs import (
    CASES,
    INTEGRATORS,
    SPEED_KIND,
    body_axes,
    case_name,
    clock,
    inertia_matrix,
    momentum_rows,
    row,
    scheduled,
)
from mjforage.physics.vessels import Vessel, load_vessel

SHORT_S = 1e-4
AROUND = np.linspace(0.0, 2.0 * math.pi, 25)[:-1] + 0.05  # where the wind blows to
WIND_MPS = 8.0
WINDS_MPS = (2.0, 5.0, 10.0)
YAW = 0.6
TURN_S, LONG_S = 30.0, 600.0
STOPPED = ((0.0, 0.0, 0.0),)
EXPOSED = tuple(case for case in CASES if case[0] in ("forager", "scout"))  # the others have none


@check("wind-load", "10c", "Wind load from every side")
def wind_force() -> Parts:
    """Hulls at rest in a wind of 8 m/s from 24 sides, the forager with 100 items too.

    Acceleration over the first 0.1 ms in body axes, times the inertia with added mass: the load
    that Blendermann (1994) has for the angle that the wind comes from.
    """
    measures: list[Measure] = []
    lines: list[Line] = []
    flow = WIND_MPS * np.stack((np.cos(AROUND), np.sin(AROUND)), axis=-1)
    for colour, (name, load) in enumerate(EXPOSED):
        vessel, case = load_vessel(name), case_name(name, load)
        expected = np.array([_load(vessel, *air) for air in flow.tolist()])
        for integrator in INTEGRATORS:
            found = _found(vessel, load, flow, integrator)
            off = np.abs(found - expected).max(axis=0) / np.abs(expected).max(axis=0)
            for axis, share in zip(("surge", "sway", "yaw"), off.tolist(), strict=True):
                label = f"{case}, {SPEED_KIND[integrator]}: {axis}, largest share off"
                measures.append(at_most(label, share, 1e-3))
        degrees = np.degrees(AROUND)
        lines.append(Line(case, degrees, found[:, 2], colour))
        lines.append(Line("", degrees, expected[:, 2], expected=True))
    panel = Panel("Yaw moment of the wind", "blows to (deg from the bow)", "N m", tuple(lines))
    return tuple(measures), (panel,)


def _load(vessel: Vessel, ahead: float, port: float) -> tuple[float, float, float]:
    """Surge, sway [N] and yaw [N m], to port and counter-clockwise."""
    x, y, n = wind_load(vessel, ahead, -port)
    return x, -y, -n


def _found(vessel: Vessel, load: float, wind: Float64Array, integrator: Integrator) -> Float64Array:
    """(wind, 3) load that explains the first step from rest."""
    scene = build_scene([vessel])
    simulation = Simulation(scene, len(wind), integrator=integrator, step_s=SHORT_S)
    simulation.load[:], simulation.vessel_wind[:, 0] = load, wind
    simulation.step()
    return np.asarray(body_axes(row(simulation)) / SHORT_S @ inertia_matrix(vessel, load))


@check("drift", "10d", "Hulls adrift in the wind")
def drift() -> Parts:
    """Thrusters stopped, winds of 2, 5 and 10 m/s, bow 34 degrees off where the wind blows to.

    Place and heading over the first 30 s against the momentum of hull and water; speed after 600 s,
    beam to the wind, as a share of it, against the balance of Blendermann's load and sway drag.
    """
    measures: list[Measure] = []
    lines: list[Line] = []
    for colour, (name, load) in enumerate(EXPOSED):
        vessel, case = load_vessel(name), case_name(name, load)
        true = np.stack([_true(vessel, load, wind) for wind in WINDS_MPS], axis=1)
        for integrator in INTEGRATORS:
            kind = f"{case}, {SPEED_KIND[integrator]}"
            rows = _adrift(vessel, load, integrator)
            off = float(np.abs(true - rows[: len(true)])[..., :3].max())
            measures.append(at_most(f"{kind}: first 30 s", off, 2e-3, "m, rad"))
            for wind, motion in zip(WINDS_MPS, rows[-1], strict=True):
                share, law = float(np.hypot(*motion[3:5])) / wind, leeway(vessel, wind)
                label = f"{kind}: drift in {wind:g} m/s"
                measures.append(near_share(label, 100.0 * share, 100.0 * law, 5e-3, "%"))
        times = clock(len(true))
        lines.append(Line(case, times, np.degrees(rows[: len(true), -1, 2]), colour))
        lines.append(Line("", times, np.degrees(true[:, -1, 2]), expected=True))
    panel = Panel("Heading in 10 m/s", "time (s)", "off the wind (deg)", tuple(lines))
    return tuple(measures), (panel,)


def _adrift(vessel: Vessel, load: float, integrator: Integrator) -> Float64Array:
    """(row, wind, 6) of `scheduled`."""
    winds = [(wind, 0.0) for wind in WINDS_MPS]
    return scheduled(vessel, STOPPED, integrator, yaw=(YAW,), wind=winds, load=load, seconds=LONG_S)


def _true(vessel: Vessel, load: float, wind_mps: float) -> Float64Array:
    here = Conditions(wind_mps=(wind_mps, 0.0), heading_rad=YAW)
    return momentum_rows(vessel, STOPPED, conditions=here, load=load, seconds=TURN_S)


def leeway(vessel: Vessel, wind_mps: float) -> float:
    """Share of the wind at which a hull beam to it drifts: a (W - v)^2 = d v + k v^2."""
    flow, windage = vessel.crossflow, vessel.windage
    a = 0.5 * 1.224 * windage.area_side_m2 * windage.cdt
    k = vessel.quadratic_sway
    if flow is not None:
        k += 0.5 * flow.water_density_kgpm3 * flow.coefficient * flow.draft_m * flow.length_m
    b = vessel.linear_sway + 2.0 * a * wind_mps
    root = math.sqrt(b * b + 4.0 * (k - a) * a * wind_mps**2)
    return (root - b) / (2.0 * (k - a)) / wind_mps
