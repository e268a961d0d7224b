"""At rest nothing moves; without thrust energy never rises."""

import numpy as np

from mjforage.physics.hydrodynamics import pack
from mjforage.physics.hydrodynamics.motion import kinetic_energy
from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Integrator, Simulation
from mjforage.physics.validation.finding import Float64Array, Line, Panel, at_most
from mjforage.physics.validation.known_checks import Parts, check
from mjforage.physics.validation.shared_runs import (
    INTEGRATORS,
    SPEED_KIND,
    STEP_S,
    VESSELS,
    body_axes,
    clock,
    row,
)
from mjforage.physics.vessels import Vessel, load_vessel

REST_S = 300.0
COAST_S = 15.0
HEADINGS = np.array([0.4, -2.5])
STARTS = np.array(  # (run, 3) surge, sway [m/s], yaw rate [rad/s]
    [
        [1.5, 0.0, 0.0],
        [1.0, 0.4, 0.0],
        [-1.0, -0.3, 0.5],
        [0.0, 0.8, -0.8],
        [0.0, 0.0, 1.2],
        [2.0, -0.5, 0.6],
    ]
)


@check("rest", "1", "At rest in a calm")
def rest() -> Parts:
    """Hulls in still water and still air, thrusters stopped, at two headings, stay for 300 s."""
    measures = []
    for name in VESSELS:
        far = max(_departure(load_vessel(name), integrator) for integrator in INTEGRATORS)
        measures.append(at_most(f"{name}: largest departure", far, 1e-9, "m or rad"))
    return tuple(measures), ()


def _departure(vessel: Vessel, integrator: Integrator) -> float:
    simulation = Simulation(build_scene([vessel]), HEADINGS.size, integrator=integrator, step_s=0.1)
    pose = np.zeros((HEADINGS.size, 1, 3))
    pose[:, 0, 2] = HEADINGS
    simulation.place_vessels(pose)
    far = 0.0
    for _ in range(30):
        simulation.step(round(REST_S / STEP_S / 30))
        far = max(far, float(np.abs(simulation.vessel_pose - pose).max()))
    return far


@check("energy", "2", "Without thrust, energy never rises")
def energy() -> Parts:
    """Kinetic energy of hull and added mass, from six starts with surge, sway and yaw each.

    The largest rise within one step, as a share of the energy at the start.
    """
    measures, lines = [], []
    for colour, name in enumerate(VESSELS):
        vessel = load_vessel(name)
        for integrator in INTEGRATORS:
            shares = _energies(vessel, integrator)
            rise = float(np.diff(shares, axis=0).max())
            measures.append(at_most(f"{name}, {SPEED_KIND[integrator]}: rise", rise, 1e-9))
        times = clock(len(shares))
        lines += [
            Line(name if start == 0 else "", times, shares[:, start], colour)
            for start in range(len(STARTS))
        ]
    panel = Panel(
        "Energy after six starts", "time (s)", "share of the start", tuple(lines), log_y=True
    )
    return tuple(measures), (panel,)


def _energies(vessel: Vessel, integrator: Integrator) -> Float64Array:
    """(row, start) kinetic energy over that at the start."""
    runs = len(STARTS)
    simulation = Simulation(build_scene([vessel]), runs, integrator=integrator, step_s=0.1)
    yaw = np.linspace(0.0, 3.0, runs)
    pose, velocity = np.zeros((runs, 1, 3)), np.zeros((runs, 1, 3))
    pose[:, 0, 2], velocity[:, 0, 2] = yaw, STARTS[:, 2]
    velocity[:, 0, 0] = np.cos(yaw) * STARTS[:, 0] - np.sin(yaw) * STARTS[:, 1]
    velocity[:, 0, 1] = np.sin(yaw) * STARTS[:, 0] + np.cos(yaw) * STARTS[:, 1]
    simulation.place_vessels(pose, velocity)
    rows = [row(simulation)]
    for _ in range(round(COAST_S / STEP_S)):
        simulation.step()
        rows.append(row(simulation))
    p = pack(vessel)
    motion = body_axes(np.array(rows))
    joules = np.array([[kinetic_energy(p, *run) for run in runs] for runs in motion.tolist()])
    return np.asarray(joules / joules[0])
