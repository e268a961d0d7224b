"""The same bits every time, and long runs without one warning."""

import hashlib
import subprocess
import sys

import numpy as np

from mjforage.physics.port_drive import drive, port_scene, port_simulation
from mjforage.physics.simulation import InstabilityError, Integrator, Simulation
from tests.mjforage.physics.validation.measures import Measures, at_most, check

RUN_S, RUNS = 900.0, 2
_PROGRAM = """
from mjforage.physics.simulation import Integrator
from tests.mjforage.physics.validation.repeat_checks import digest
print(*(digest(integrator) for integrator in Integrator))
"""


def digest(integrator: Integrator, simulations: int = 3, threads: int = 1) -> str:
    """SHA-256 of the states of three busy simulations of 30 s in the default port."""
    scene = port_scene()
    model = port_simulation(scene, integrator, 3)
    simulation = Simulation(
        scene, simulations, integrator=integrator, threads=threads, items=model.items
    )
    simulation.restore(model.snapshot(), np.arange(3))
    others = np.arange(12.0).reshape(4, 3) * 3.0
    simulation.place_vessels(others, ids=np.arange(3, simulations))
    for k in range(6):
        simulation.commands[:] = 20.0 - 7.0 * (k % 4)
        simulation.step(50)
    parts = (
        *(simulation.vessel_pose, simulation.vessel_velocity),
        *(simulation.item_xy, simulation.item_velocity),
    )
    return hashlib.sha256(b"".join(part[:3].tobytes() for part in parts)).hexdigest()


@check("determinism", "13")
def determinism() -> Measures:
    """Three busy simulations of 30 s in the default port: 4 vessels, 75 items, contacts.

    Digests of the final states that differ: on repeating, with 2 threads, in a batch of 5 instead
    of 3, and in another process.
    """
    found: Measures = []
    words = [sys.executable, "-c", _PROGRAM]
    elsewhere = subprocess.run(words, capture_output=True, text=True, check=True).stdout.split()
    for integrator, there in zip(Integrator, elsewhere, strict=True):
        once = digest(integrator)
        others = {
            "repeated": digest(integrator),
            "2 threads": digest(integrator, threads=2),
            "batch of 5": digest(integrator, 5, threads=2),
            "another process": there,
        }
        for label, other in others.items():
            found.append(at_most(f"{integrator.value}, {label}", other != once, 0.0, "digests"))
    return found


@check("endurance", "13b")
def endurance() -> Measures:
    """Runs of 900 s in the default port, each with its own places and commands.

    4 vessels, 75 items, wind, contacts with quays, vessels and items; fast integrator, 0.1 s. A
    MuJoCo warning or an unstable state counts.
    """
    simulation = port_simulation(port_scene(), Integrator.FAST, RUNS)
    warned = 0
    try:
        drive(simulation, RUN_S)
    except InstabilityError:
        warned = RUNS
    outside = np.abs(simulation.vessel_pose[..., :2] - 100.0) > 200.0
    escaped = outside.any(axis=(1, 2)).sum()
    return [
        at_most(f"of {RUNS} runs of {RUN_S:g} s: with a warning", warned, 0.0, "runs"),
        at_most(f"of {RUNS} runs of {RUN_S:g} s: a vessel left the port", escaped, 0.0, "runs"),
    ]
