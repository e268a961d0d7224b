"""Runs that several checks share: scheduled commands on open water, read at every step."""

from collections.abc import Sequence
from functools import cache, partial

import numpy as np

from mjforage.physics.hydrodynamics.conditions import Conditions, to_body
from mjforage.physics.manoeuvre import Trajectory, run_test
from mjforage.physics.manoeuvre.standard import shares
from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Integrator, Simulation
from mjforage.physics.validation.finding import Float64Array
from mjforage.physics.validation.independent import IndependentOtter
from mjforage.physics.validation.momentum import MomentumHull
from mjforage.physics.vessels import Vessel, load_vessel

Schedule = tuple[tuple[float, float, float], ...]  # from t [s] on: port, starboard [rad/s or N]
VESSELS = ("forager", "ideal", "otter", "scout")
INTEGRATORS = tuple(Integrator)
STEP_S = 0.1
SPEED_KIND = {Integrator.FAST: "fast", Integrator.REFERENCE: "reference"}

TURN: Schedule = ((0.0, 0.33, 0.15),)  # shares of the largest thrust
HARD: Schedule = ((0.0, 0.33, 0.33), (10.0, 0.33, 0.08), (25.0, -0.15, 0.23), (40.0, 0.6, -0.1))
FULL = 100.0  # items that fill a forager
CASES = (("forager", 0.0), ("forager", FULL), ("ideal", 0.0), ("otter", 0.0), ("scout", 0.0))
"""All hulls that ship, and laden the one that takes a load."""


def case_name(name: str, load: float) -> str:
    """A case in words."""
    return f"{name}, {load:g} items" if load else name


def ordered(vessel: Vessel, schedule: Schedule) -> Schedule:
    """A schedule of commands from one of shares of the vessel's largest thrust."""
    return tuple((t, *shares(vessel, port, starboard)) for t, port, starboard in schedule)


def command_at(schedule: Schedule, t: float) -> tuple[float, float]:
    """Commands that hold from `t` on."""
    row = [row for row in schedule if row[0] <= t + 1e-9][-1]
    return row[1], row[2]


def scheduled(
    vessel: Vessel,
    schedule: Schedule,
    integrator: Integrator,
    step_s: float = STEP_S,
    *,
    yaw: Sequence[float] = (0.0,),
    current: Sequence[tuple[float, float]] = ((0.0, 0.0),),
    wind: Sequence[tuple[float, float]] = ((0.0, 0.0),),
    load: float = 0.0,
    seconds: float = 60.0,
) -> Float64Array:
    """One hull per heading, current and wind, starting with its current.

    Parameters
    ----------
    yaw, current, wind : a run for each [rad], over ground [m/s]; those of length 1 are for all
    load : items aboard

    Returns
    -------
    (row, run, 6) x, y [m], yaw [rad], velocity over ground in world axes [m/s], yaw rate [rad/s]
    """
    runs = max(len(yaw), len(current), len(wind))
    simulation = Simulation(build_scene([vessel]), runs, integrator=integrator, step_s=step_s)
    pose, velocity = np.zeros((runs, 1, 3)), np.zeros((runs, 1, 3))
    pose[:, 0, 2], velocity[:, 0, :2] = yaw, current
    simulation.place_vessels(pose, velocity)
    simulation.vessel_water[:, 0], simulation.vessel_wind[:, 0] = current, wind
    simulation.load[:] = load
    rows = [row(simulation)]
    for k in range(round(seconds / step_s)):
        simulation.commands[:] = command_at(schedule, k * step_s)
        simulation.step()
        rows.append(row(simulation))
    return np.array(rows)


def clock(rows: int, step_s: float = STEP_S) -> Float64Array:
    """(rows,) times [s]."""
    return step_s * np.arange(rows, dtype=np.float64)


def row(simulation: Simulation) -> Float64Array:
    """(simulation, 6) pose and velocity of the first hull."""
    return np.hstack((simulation.vessel_pose[:, 0], simulation.vessel_velocity[:, 0]))


def body_axes(rows: Float64Array) -> Float64Array:
    """(..., 3) surge, sway [m/s] and yaw rate [rad/s] of rows of `row`."""
    c, s = np.cos(rows[..., 2]), np.sin(rows[..., 2])
    surge, sway = c * rows[..., 3] + s * rows[..., 4], c * rows[..., 4] - s * rows[..., 3]
    return np.stack((surge, sway, rows[..., 5]), axis=-1)


@cache
def independent_run(test: str) -> Trajectory:
    """A standard test of the independent Otter."""
    return run_test(load_vessel("otter"), test, simulate=IndependentOtter)


def momentum_rows(
    vessel: Vessel,
    schedule: Schedule,
    *,
    conditions: Conditions | None = None,
    load: float = 0.0,
    seconds: float = 60.0,
) -> Float64Array:
    """(row, 6) what `scheduled` gives, of the independent hull `MomentumHull`."""
    hull = MomentumHull(vessel, conditions or Conditions(), load)
    rows = [hull.state()]
    for k in range(round(seconds / STEP_S)):
        hull.step(*command_at(schedule, k * STEP_S), STEP_S)
        rows.append(hull.state())
    return np.array([(x, y, yaw, *to_body((u, v), -yaw), r) for x, y, yaw, u, v, r in rows])


@cache
def momentum_run(test: str, name: str, load: float, seconds: float) -> Trajectory:
    """A standard test of the independent hull `MomentumHull`."""
    hull = partial(MomentumHull, load=load)
    return run_test(load_vessel(name), test, duration_s=seconds, simulate=hull)


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
    """Of m u' = T - d u - k u^2 in still air: m [kg], d [N s/m], k with air [N s2/m2]."""
    air = 0.5 * 1.224 * vessel.windage.area_front_m2 * vessel.windage.cdl_bow
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
