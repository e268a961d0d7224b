"""Added mass is in the mass matrix: acceleration from rest, at every heading."""

import numpy as np

from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Integrator, Simulation
from mjforage.physics.validation.finding import (
    Float64Array,
    Line,
    Measure,
    Panel,
    at_most,
    dashed,
    near_share,
)
from mjforage.physics.validation.known_checks import Parts, check
from mjforage.physics.validation.momentum import thrust
from mjforage.physics.validation.shared_runs import (
    CASES,
    INTEGRATORS,
    SPEED_KIND,
    body_axes,
    case_name,
    inertia_matrix,
    row,
)
from mjforage.physics.vessels import Vessel, load_vessel

HEADINGS = np.linspace(0.0, 2.0 * np.pi, 25)[:-1] + 0.1
STEP_S = 1e-4
SHARES = (0.6, 0.3)  # of the highest command: port, starboard


@check("added-mass", "14c", "Acceleration from rest at every heading")
def added_mass() -> Parts:
    """A hull at rest with running thrusters, port at 0.6 of the highest command, starboard at 0.3.

    Every hull, the forager with 100 items too. Acceleration over the first 0.1 ms in body axes: the
    same at 24 headings, and that of the inertia with added mass, T = (m + X_a) u' in surge, two by
    two in sway and yaw.
    """
    measures: list[Measure] = []
    lines: list[Line] = []
    for colour, (name, load) in enumerate(CASES):
        vessel, case = load_vessel(name), case_name(name, load)
        expected = _expected(vessel, load)
        for integrator in INTEGRATORS:
            found, kind = _found(vessel, integrator, load), f"{case}, {SPEED_KIND[integrator]}"
            spread = float(np.ptp(found, axis=0).max())
            measures.append(at_most(f"{kind}: spread over headings", spread, 1e-9, "m/s²"))
            measures.append(
                near_share(f"{kind}: surge", found[:, 0].mean(), expected[0], 1e-3, "m/s²")
            )
            measures.append(
                near_share(f"{kind}: yaw", found[:, 2].mean(), expected[2], 1e-3, "rad/s²")
            )
        degrees = np.degrees(HEADINGS)
        lines.append(Line(case, degrees, found[:, 0], colour))
        lines.append(Line("", degrees, np.full(degrees.size, expected[0]), expected=True))
    lines.append(dashed("T / (m + X_a)"))
    panel = Panel("Surge from rest", "heading (deg)", "m/s²", tuple(lines))
    return tuple(measures), (panel,)


def _commands(vessel: Vessel) -> tuple[float, float]:
    high = vessel.thruster.command_range[1]
    return SHARES[0] * high, SHARES[1] * high


def _found(vessel: Vessel, integrator: Integrator, load: float) -> Float64Array:
    """(heading, 3) mean acceleration of the first step, in body axes."""
    simulation = Simulation(
        build_scene([vessel]), HEADINGS.size, integrator=integrator, step_s=STEP_S
    )
    pose = np.zeros((HEADINGS.size, 1, 3))
    pose[:, 0, 2] = HEADINGS
    simulation.place_vessels(pose)
    simulation.load[:] = load
    simulation.commands[:] = simulation.thruster_state[:] = _commands(vessel)
    simulation.step()
    return body_axes(row(simulation)) / STEP_S


def _expected(vessel: Vessel, load: float) -> Float64Array:
    """(3,) from thrust and inertia."""
    left, right = (thrust(vessel, command) for command in _commands(vessel))
    push = [left + right, 0.0, vessel.lever_m * (right - left)]
    return np.asarray(np.linalg.solve(inertia_matrix(vessel, load), push), np.float64)
