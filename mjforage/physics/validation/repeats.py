"""The same bits every time, and long runs without one warning."""

import hashlib
import logging
import subprocess
import sys
from collections.abc import Callable

import numpy as np

from mjforage.physics.simulation import InstabilityError, Integrator, Simulation
from mjforage.physics.validation.finding import Float64Array, Measure, at_most
from mjforage.physics.validation.known_checks import Parts, check
from mjforage.physics.validation.port_drive import drive, port_scene, port_simulation
from mjforage.physics.validation.shared_runs import INTEGRATORS, SPEED_KIND

logger = logging.getLogger(__name__)

SECONDS = 30.0
RUN_S, RUNS, BATCH = 900.0, 40, 10
_PROGRAM = """
from mjforage.physics.simulation import Integrator
from mjforage.physics.validation.repeats import digest, states
for integrator in Integrator:
    print(digest(states(integrator)))
"""


def states(
    integrator: Integrator, simulations: int = 3, threads: int = 1, seconds: float = SECONDS
) -> Float64Array:
    """(3, number) states of three busy simulations in the default port, among others or not."""
    scene = port_scene()
    model = port_simulation(scene, integrator, 3)
    simulation = Simulation(
        scene, simulations, integrator=integrator, threads=threads, items=model.items
    )
    simulation.restore(model.snapshot(), np.arange(3))
    others = np.arange(12.0).reshape(4, 3) * 3.0
    simulation.place_vessels(others, ids=np.arange(3, simulations))
    for k in range(round(seconds / 5.0)):
        simulation.commands[:] = 20.0 - 7.0 * (k % 4)
        simulation.step(50)
    return np.concatenate(
        [
            part[:3].reshape(3, -1)
            for part in (
                simulation.vessel_pose,
                simulation.vessel_velocity,
                simulation.item_xy,
                simulation.item_velocity,
            )
        ],
        axis=1,
    )


def digest(finals: Float64Array) -> str:
    """SHA-256 of `states`, for comparison between processes."""
    return hashlib.sha256(finals.tobytes()).hexdigest()


def elsewhere() -> list[str]:
    """`digest` of the states of each integrator, made by a process of its own.

    Raises
    ------
    RuntimeError
        If that process failed.
    """
    words = [sys.executable, "-c", _PROGRAM]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(done.stderr)
    return done.stdout.split()


@check("determinism", "13", "Bitwise determinism")
def determinism() -> Parts:
    """Three busy simulations of 30 s in the default port: 4 vessels, 75 items, contacts.

    Numbers of the final states that differ in any bit: on repeating, with 2 threads, in a batch of
    5 instead of 3, and in another process.
    """
    measures: list[Measure] = []
    for integrator, there in zip(INTEGRATORS, elsewhere(), strict=True):
        kind, once = SPEED_KIND[integrator], states(integrator)
        others = {
            "repeated": states(integrator),
            "2 threads": states(integrator, threads=2),
            "batch of 5": states(integrator, 5, threads=2),
        }
        for words, other in others.items():
            measures.append(at_most(f"{kind}, {words}", int((other != once).sum()), 0.0, "numbers"))
        differs = float(there != digest(once))
        measures.append(at_most(f"{kind}, another process", differs, 0.0, "digests"))
    return tuple(measures), ()


@check("endurance", "13b", "Long runs without a warning")
def endurance() -> Parts:
    """Runs of 900 s in the default port, each with its own places and commands.

    4 vessels, 75 items, wind, contacts with quays, hulls and items; fast integrator, 0.1 s. A
    MuJoCo warning or an unstable state counts. `mjforage validate --runs N` sets how many.
    """
    return long_runs(RUNS), ()


def long_runs(runs: int, tick: Callable[[], None] = lambda: None) -> tuple[Measure, ...]:
    """`runs` runs of 900 s in batches, `tick` called after each: how many had a warning."""
    scene, clean, escaped = port_scene(), 0, 0
    for first in range(0, runs, BATCH):
        size = min(BATCH, runs - first)
        simulation = port_simulation(scene, Integrator.FAST, size, seed=first)
        try:
            drive(simulation, RUN_S, seed=first)
        except InstabilityError as error:
            logger.warning("%s", error)
            continue
        finally:
            tick()
        clean += size
        outside = np.abs(simulation.vessel_pose[..., :2] - 100.0) > 200.0
        escaped += int(outside.any(axis=(1, 2)).sum())
    return (
        at_most(f"of {runs} runs of {RUN_S:g} s: with a warning", runs - clean, 0.0, "runs"),
        at_most(f"of {runs} runs of {RUN_S:g} s: a hull left the port", escaped, 0.0, "runs"),
    )
