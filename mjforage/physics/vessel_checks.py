"""Checks of one vessel: its motion against closed forms, energy and finer time steps.

They judge a vessel file, for `mjforage validate VESSEL`; the tests check the physics itself.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from mjforage.physics.contact_trials import head_on, into_quay
from mjforage.physics.manoeuvre.standard import shares
from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Integrator, Simulation
from mjforage.physics.vessels import Vessel
from mjforage.scenario.debris import AIR_DENSITY_KGPM3

Float64Array: TypeAlias = NDArray[np.float64]
Schedule: TypeAlias = tuple[tuple[float, float, float], ...]
"""Commands from t [s] on: port, starboard [rad/s or N], or shares of the largest thrust."""

STEP_S = 0.1
STOPPED: Schedule = ((0.0, 0.0, 0.0),)
HARD: Schedule = ((0.0, 0.33, 0.33), (10.0, 0.33, 0.08), (25.0, -0.15, 0.23), (40.0, 0.6, -0.1))
"""Ahead, turning, spinning and astern, in shares of the largest thrust."""
STARTS = (  # surge, sway [m/s], yaw rate [rad/s]
    *((1.5, 0.0, 0.0), (1.0, 0.4, 0.0), (-1.0, -0.3, 0.5)),
    *((0.0, 0.8, -0.8), (0.0, 0.0, 1.2), (2.0, -0.5, 0.6)),
)
COAST_MPS, COAST_S = 1.5, 15.0
QUAY_M, HEAD_ON_M = 0.05, 0.1  # depth of a contact at top speed
REBOUND = 0.05  # share of the speed
FINEST_S = 0.0025  # time step of the run that others are compared with
SLACK = {Integrator.FAST: 0.02, Integrator.REFERENCE: 0.01}  # lengths, after a minute


class Measure(NamedTuple):
    """A number and the closed range that it must lie in; infinite where there is no limit."""

    what: str
    value: float
    low: float
    high: float
    unit: str = ""

    @property
    def passed(self) -> bool:
        """True for a number in its range; False for nan."""
        return bool(self.low <= self.value <= self.high)

    @property
    def limit(self) -> str:
        """The range in words, without the unit."""
        if self.low == self.high:
            return formatted(self.low)
        if math.isinf(self.low) and math.isinf(self.high):
            return "none"
        if math.isinf(self.low):
            return f"at most {formatted(self.high)}"
        if math.isinf(self.high):
            return f"at least {formatted(self.low)}"
        return f"{formatted(self.low)} to {formatted(self.high)}"


def at_most(what: str, value: float, limit: float, unit: str = "") -> Measure:
    """A number with an upper limit."""
    return Measure(what, float(value), -math.inf, float(limit), unit)


def formatted(value: float) -> str:
    """A number with four digits, as tables show it."""
    if value == 0.0 or not math.isfinite(value):
        return f"{value:g}"
    return f"{value:.4g}" if 1e-3 <= abs(value) < 1e5 else f"{value:.1e}"


def in_commands(vessel: Vessel, schedule: Schedule) -> Schedule:
    """A schedule in commands from one in shares of the vessel's largest thrust."""
    return tuple((t, *shares(vessel, port, starboard)) for t, port, starboard in schedule)


def command_at(schedule: Schedule, t: float) -> tuple[float, float]:
    """Commands that hold from `t` on."""
    row = [row for row in schedule if row[0] <= t + 1e-9][-1]
    return row[1], row[2]


def run_schedule(
    vessel: Vessel,
    schedule: Schedule,
    integrator: Integrator,
    step_s: float = STEP_S,
    *,
    start: Sequence[tuple[float, float, float]] = ((0.0, 0.0, 0.0),),
    yaw: Sequence[float] = (0.0,),
    current: Sequence[tuple[float, float]] = ((0.0, 0.0),),
    wind: Sequence[tuple[float, float]] = ((0.0, 0.0),),
    load: float = 0.0,
    seconds: float = 60.0,
) -> Float64Array:
    """Scheduled commands on open water, a run for each start, heading, current and wind.

    Parameters
    ----------
    schedule : in commands
    start : surge, sway [m/s] through the water, yaw rate [rad/s]
    yaw, current, wind : [rad], over ground [m/s]; those of length 1 are for all runs
    load : items aboard

    Returns
    -------
    (row, run, 6) x, y [m], yaw [rad], velocity over ground in world axes [m/s], yaw rate [rad/s]
    """
    runs = max(len(start), len(yaw), len(current), len(wind))
    simulation = Simulation(build_scene([vessel]), runs, integrator=integrator, step_s=step_s)
    pose, velocity = np.zeros((runs, 1, 3)), np.zeros((runs, 1, 3))
    pose[:, 0, 2] = yaw
    (u, v, rate), c, s = np.transpose(start), np.cos(yaw), np.sin(yaw)
    velocity[:, 0, :2] = current
    velocity[:, 0, 0] += c * u - s * v
    velocity[:, 0, 1] += s * u + c * v
    velocity[:, 0, 2] = rate
    simulation.place_vessels(pose, velocity)
    simulation.vessel_water[:, 0], simulation.vessel_wind[:, 0] = current, wind
    simulation.load[:] = load
    rows = [first_vessel(simulation)]
    for k in range(round(seconds / step_s)):
        simulation.commands[:] = command_at(schedule, k * step_s)
        simulation.step()
        rows.append(first_vessel(simulation))
    return np.array(rows)


def first_vessel(simulation: Simulation) -> Float64Array:
    """(simulation, 6) pose and velocity of the first vessel, as `run_schedule` has them."""
    return np.hstack((simulation.vessel_pose[:, 0], simulation.vessel_velocity[:, 0]))


def body_axes(rows: Float64Array) -> Float64Array:
    """(..., 3) surge, sway [m/s] and yaw rate [rad/s] of rows of `run_schedule`."""
    c, s = np.cos(rows[..., 2]), np.sin(rows[..., 2])
    surge, sway = c * rows[..., 3] + s * rows[..., 4], c * rows[..., 4] - s * rows[..., 3]
    return np.stack((surge, sway, rows[..., 5]), axis=-1)


def inertia_matrix(vessel: Vessel, load: float = 0.0) -> Float64Array:
    """(3, 3) with added mass, in body axes; the centre of gravity couples sway and yaw."""
    m = vessel.mass_kg + load * vessel.load.mass_per_item_kg
    moment = vessel.mass_kg * vessel.cog_x_m  # items lie at midships
    return np.array(
        [
            [m + vessel.added_mass_surge_kg, 0.0, 0.0],
            [0.0, m + vessel.added_mass_sway_kg, moment],
            [0.0, moment, vessel.inertia_z_kgm2 + vessel.added_mass_yaw_kgm2],
        ]
    )


def straight_drag(vessel: Vessel, load: float = 0.0) -> tuple[float, float, float]:
    """Drag in m u' = T - d u - k u^2 in still air: m [kg], d [N s/m], k with air [N s2/m2]."""
    air = 0.5 * AIR_DENSITY_KGPM3 * vessel.windage.area_front_m2 * vessel.windage.cdl_bow
    mass = vessel.mass_kg + load * vessel.load.mass_per_item_kg + vessel.added_mass_surge_kg
    k = vessel.quadratic_surge + load * vessel.load.drag_per_item + air
    return mass, vessel.linear_surge, k


def coasting(
    vessel: Vessel, start_mps: float, t_s: Float64Array, load: float = 0.0
) -> Float64Array:
    """Closed form of m u' = -d u - k u^2 from `start_mps`: Bernoulli's equation."""
    mass, d, k = straight_drag(vessel, load)
    if d == 0.0:
        return start_mps / (1.0 + start_mps * k / mass * t_s)
    decay = np.exp(-d / mass * t_s)
    return np.asarray(d * start_mps * decay / (d + k * start_mps * (1.0 - decay)))


def energy_rise(vessel: Vessel, integrator: Integrator) -> float:
    """Largest rise of kinetic energy within a step, over that at the start, from `STARTS`."""
    yaw = np.linspace(0.0, 3.0, len(STARTS)).tolist()
    rows = run_schedule(vessel, STOPPED, integrator, start=STARTS, yaw=yaw, seconds=COAST_S)
    motion = body_axes(rows)
    energy = np.einsum("tri,ij,trj->tr", motion, 0.5 * inertia_matrix(vessel), motion)
    return float((np.diff(energy, axis=0) / energy[0]).max())


def coasting_error(vessel: Vessel, integrator: Integrator, load: float = 0.0) -> float:
    """Largest difference from the closed form while coasting from 1.5 m/s [m/s]."""
    start = ((COAST_MPS, 0.0, 0.0),)
    rows = run_schedule(vessel, STOPPED, integrator, start=start, load=load, seconds=COAST_S)
    times = STEP_S * np.arange(len(rows), dtype=np.float64)
    surge = body_axes(rows)[:, 0, 0]
    return float(np.abs(surge - coasting(vessel, COAST_MPS, times, load)).max())


def measures_of(vessel: Vessel) -> list[Measure]:
    """Measures of a vessel's motion, with the limits of a sound one.

    At rest it stays; coasting it loses energy and follows the closed form; hard manoeuvres agree
    with those in time steps of 0.0025 s; at top speed a quay and the bow of its like stop it.
    Raises `UserError` if the simulation becomes unstable, or the thrusters' lag is too short for
    its step.
    """
    hard, found = in_commands(vessel, HARD), []
    true = run_schedule(vessel, hard, Integrator.REFERENCE, FINEST_S)
    for integrator in Integrator:
        rest = run_schedule(vessel, STOPPED, integrator)
        step_s, name = integrator.step_s, integrator.value
        rows = run_schedule(vessel, hard, integrator, step_s)
        off = np.hypot(*(rows - true[:: round(step_s / FINEST_S)])[:, 0, :2].T).max()
        slack = SLACK[integrator] * vessel.length_m
        error, rise = coasting_error(vessel, integrator), energy_rise(vessel, integrator)
        found += [
            at_most(f"{name}: departure from rest", np.abs(rest).max(), 1e-9, "m or rad"),
            at_most(f"{name}: energy that rises without thrust", rise, 1e-9),
            at_most(f"{name}: coasting, off the closed form", error, 0.01, "m/s"),
            at_most(f"{name}: hard manoeuvres, off fine steps", off, slack, "m"),
            *_of_contacts(vessel, integrator),
        ]
    return found


def _of_contacts(vessel: Vessel, integrator: Integrator) -> list[Measure]:
    name = f"{integrator.value}: top speed"
    quay, met = into_quay(vessel, integrator), head_on(vessel, vessel, integrator)
    return [
        at_most(f"{name} into a quay, depth", quay.depth_m, QUAY_M, "m"),
        at_most(f"{name} into a quay, speed given back", quay.rebound, REBOUND),
        at_most(f"{name} into a quay, largest force", quay.force_n, math.inf, "N"),
        at_most(f"{name} into its like, depth", met.depth_m, HEAD_ON_M, "m"),
    ]
