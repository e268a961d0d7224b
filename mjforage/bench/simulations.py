"""How fast the physics runs here, in CPU seconds of one core; for `mjforage bench`.

Driven as `mjforage.physics.port_drive` says.
"""

import contextlib
import dataclasses
import math
import statistics
import time
from collections.abc import Iterator

import mujoco

from mjforage.bench.rates import Rate, rate
from mjforage.physics.callback import Route, calling
from mjforage.physics.port_drive import STEP_S, drive, port_scene, port_simulation
from mjforage.physics.scene import Scene
from mjforage.physics.simulation.integrators import Integrator

REPEATS = 15


def physics_speeds(seconds: float = 120.0, simulations: int = 4) -> dict[str, float | Rate]:
    """Measure.

    Parameters
    ----------
    seconds : simulated time of each slice and simulation [s]

    Returns
    -------
    dict
        ``physics_sim_s_per_core_s``, the same with ``_reference`` and ``_no_contacts``: simulated
        seconds per CPU second; ``physics_steps_per_core_s``: time steps of the fast integrator;
        ``physics_callback_overhead``: extra cost of all forces over stepping without them from the
        same states, as a share, without contacts (with them, what the forces are decides how long
        the solver takes); ``physics_contacts``: mean number of contacts in MuJoCo.
    """
    scene = port_scene()
    free = dataclasses.replace(scene, model=_without_contacts(scene.model))
    fast = _speed(scene, Integrator.FAST, seconds, simulations)
    return {
        "physics_sim_s_per_core_s": fast,
        "physics_steps_per_core_s": fast.times(1.0 / STEP_S),
        "physics_sim_s_per_core_s_no_contacts": _speed(free, Integrator.FAST, seconds, simulations),
        "physics_sim_s_per_core_s_reference": _speed(
            scene, Integrator.REFERENCE, seconds, simulations
        ),
        "physics_callback_overhead": callback_overhead(free),
        "physics_contacts": mean_contacts(scene),
    }


def callback_overhead(scene: Scene, simulations: int = 32) -> float:
    """Extra cost of the native callback per step of MuJoCo, as a share.

    Both steppings start from the same saved states, in turn, one step each. Not a number where
    the native callback does not work.
    """
    simulation = port_simulation(scene, Integrator.FAST, simulations)
    if simulation.route is not Route.NATIVE:
        return math.nan
    drive(simulation, 100.0)
    saved = simulation.snapshot()
    costs: dict[bool, list[float]] = {True: [], False: []}
    for _ in range(REPEATS):
        for forces in (True, False):
            simulation.restore(saved)
            with calling() if forces else _forceless():
                started = time.process_time()
                simulation.engine.step(nstep=1)
                costs[forces].append(time.process_time() - started)
    return statistics.median(costs[True]) / statistics.median(costs[False]) - 1.0


def mean_contacts(scene: Scene, simulations: int = 32) -> float:
    """Mean number of contacts after 100 s."""
    simulation = port_simulation(scene, Integrator.FAST, simulations)
    drive(simulation, 100.0)
    contacts = simulation.engine.bind("ncon")
    simulation.step()
    return float(contacts.mean())


@contextlib.contextmanager
def _forceless() -> Iterator[None]:
    """Within it, MuJoCo steps without our callback."""
    mujoco.set_mjcb_passive(None)
    try:
        yield
    finally:
        with calling():  # puts it back
            pass


def _speed(scene: Scene, integrator: Integrator, seconds: float, simulations: int) -> Rate:
    """Simulated seconds per CPU second, all slices from where a first run brought contacts."""
    simulation = port_simulation(scene, integrator, simulations)
    drive(simulation, 60.0)
    saved = simulation.snapshot()

    def work() -> float:
        drive(simulation, seconds, seed=1)
        return simulations * seconds

    return rate(work, lambda: simulation.restore(saved))


def _without_contacts(model: mujoco.MjModel) -> mujoco.MjModel:
    copy: mujoco.MjModel = model.__copy__()
    copy.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    return copy
