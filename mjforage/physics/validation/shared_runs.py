"""Runs that several checks share: scheduled commands on open water, read at every step."""

from collections.abc import Sequence
from functools import cache

import numpy as np

from mjforage.physics.manoeuvre import Trajectory, run_test
from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Integrator, Simulation
from mjforage.physics.validation.finding import Float64Array
from mjforage.physics.validation.independent import IndependentOtter
from mjforage.physics.vessels import Vessel, load_vessel

Schedule = tuple[tuple[float, float, float], ...]  # from t [s] on: port, starboard [rad/s or N]
VESSELS = ("forager", "otter", "scout")  # hulls of real boats
INTEGRATORS = tuple(Integrator)
STEP_S = 0.1
SPEED_KIND = {Integrator.FAST: "fast", Integrator.REFERENCE: "reference"}

TURN: Schedule = ((0.0, 60.0, 40.0),)
HARD: Schedule = ((0.0, 60.0, 60.0), (10.0, 60.0, 30.0), (25.0, -40.0, 50.0), (40.0, 80.0, -20.0))


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
    wind: tuple[float, float] = (0.0, 0.0),
    seconds: float = 60.0,
) -> Float64Array:
    """One hull per heading and current, starting with its current.

    Parameters
    ----------
    yaw, current : a run for each; one of them may be of length 1
    wind : over ground, felt by all [m/s]

    Returns
    -------
    (row, run, 6) x, y [m], yaw [rad], velocity over ground in world axes [m/s], yaw rate [rad/s]
    """
    runs = max(len(yaw), len(current))
    simulation = Simulation(build_scene([vessel]), runs, integrator=integrator, step_s=step_s)
    pose, velocity = np.zeros((runs, 1, 3)), np.zeros((runs, 1, 3))
    pose[:, 0, 2], velocity[:, 0, :2] = yaw, current
    simulation.place_vessels(pose, velocity)
    simulation.vessel_water[:, 0], simulation.vessel_wind[:] = current, wind
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


def straight_drag(vessel: Vessel) -> tuple[float, float, float]:
    """Of m u' = T - d u - k u^2 in still air: m [kg], d [N s/m], k with air [N s2/m2]."""
    air = 0.5 * 1.224 * vessel.windage.area_front_m2 * vessel.windage.cdl_bow
    mass = vessel.mass_kg + vessel.added_mass_surge_kg
    return mass, vessel.linear_surge, vessel.quadratic_surge + air


def coasting(vessel: Vessel, start_mps: float, t_s: Float64Array) -> Float64Array:
    """Closed form of m u' = -d u - k u^2 from `start_mps`: Bernoulli's equation."""
    mass, d, k = straight_drag(vessel)
    if d == 0.0:
        return start_mps / (1.0 + start_mps * k / mass * t_s)
    decay = np.exp(-d / mass * t_s)
    return np.asarray(d * start_mps * decay / (d + k * start_mps * (1.0 - decay)))
