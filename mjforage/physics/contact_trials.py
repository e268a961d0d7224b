"""Trials of contacts: hulls that run into a quay or into each other at their top speed.

Depths are those of hull into quay or hull into hull; a run starts in each of several phases of the
time step, since depth depends on where in the step the hulls meet.
"""

import math
from typing import NamedTuple

import numpy as np

from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Integrator, Simulation
from mjforage.physics.vessels import Vessel

PHASES = 8
AHEAD_M = 1.0  # least distance at the start
SECONDS, AT_REST_S = 6.0, 1.0
PITCH_M, CELLS = 4.0, (3, 9)
MIDDLE_M = 16.0
SPEED_S = 60.0  # within which a hull reaches its top speed


class Impact(NamedTuple):
    """Figures of the worst phase of a trial."""

    speed_mps: float  # at which they close in
    depth_m: float  # deepest
    force_n: float  # largest, of a step
    rebound: float  # fastest way back, over `speed_mps`
    rest_m: float  # depth at the end, under full thrust
    restless_mps: float  # fastest motion of the last second


def full_ahead(vessel: Vessel, load: float) -> float:
    """Speed that a vessel reaches with full thrust ahead and `load` items aboard [m/s]."""
    simulation = Simulation(build_scene([vessel]))
    simulation.load[:], simulation.commands[:] = load, vessel.thruster.command_range[1]
    simulation.step(round(SPEED_S / simulation.step_s))
    return float(simulation.vessel_velocity[0, 0, 0])


def into_quay(vessel: Vessel, integrator: Integrator, load: float = 0.0) -> Impact:
    """A vessel runs bow first into a quay, and goes on with full thrust."""
    return _trial([vessel], integrator, [load])


def head_on(
    one: Vessel, other: Vessel, integrator: Integrator, loads: tuple[float, float] = (0.0, 0.0)
) -> Impact:
    """Two vessels run into each other bow to bow, and go on with full thrust."""
    return _trial([one, other], integrator, list(loads))


def _trial(fleet: list[Vessel], integrator: Integrator, loads: list[float]) -> Impact:
    """The first vessel heads east, for the quay or for the other vessel."""
    scene = build_scene(fleet, navigable=np.ones(CELLS, np.bool_), pitch_m=PITCH_M)
    simulation = Simulation(scene, PHASES, integrator=integrator)
    speeds = [full_ahead(v, load) for v, load in zip(fleet, loads, strict=True)]
    closing = sum(speeds)
    if len(fleet) == 1:
        face_m = (CELLS[1] - 0.5) * PITCH_M - 0.5 * fleet[0].length_m
    else:
        face_m = MIDDLE_M
    pose, velocity = np.zeros((2, PHASES, len(fleet), 3))
    ahead = AHEAD_M + closing * simulation.step_s * np.arange(PHASES) / PHASES
    pose[..., 1], pose[:, 0, 0], velocity[:, 0, 0] = PITCH_M, face_m - ahead, speeds[0]
    reach_m = 0.5 * sum(v.length_m for v in fleet) if len(fleet) > 1 else 0.0
    if len(fleet) > 1:
        pose[:, 1, 0], pose[:, 1, 2], velocity[:, 1, 0] = face_m + reach_m, math.pi, -speeds[1]
    simulation.place_vessels(pose, velocity)
    simulation.load[:] = loads
    full = [[v.thruster.command_range[1]] * 2 for v in fleet]
    simulation.commands[:] = simulation.thruster_state[:] = full
    depths, ways, forces, motions = [], [], [], []
    for _ in range(round(SECONDS / simulation.step_s)):
        simulation.step()
        x, v = simulation.vessel_pose[..., 0], simulation.vessel_velocity[..., 0]
        depths.append(x[:, 0] + reach_m - (x[:, 1] if len(fleet) > 1 else face_m))
        ways.append(v[:, 0] - (v[:, 1] if len(fleet) > 1 else 0.0))
        forces.append(np.abs(simulation.engine.bind("qfrc_constraint")[:, 0]).max())
        motions.append(np.abs(simulation.vessel_velocity).max())
    last = round(AT_REST_S / simulation.step_s)
    return Impact(
        closing,
        float(np.max(depths)),
        float(np.max(forces)),
        float(-np.min(ways) / closing),
        float(np.max(depths[-1])),
        float(np.max(motions[-last:])),
    )
