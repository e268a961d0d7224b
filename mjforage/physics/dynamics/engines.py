"""Engines for the hulls of a mission: MuJoCo on this processor, or MuJoCo Warp on a device."""

from typing import Any

from mjforage.base.errors import UserError
from mjforage.base.extras import require
from mjforage.physics.scene import Scene
from mjforage.physics.simulation import Integrator, Simulation
from mjforage.physics.simulation.simulated_fleet import SimulatedFleet
from mjforage.scenario.scenario import Physics

_WARP_NAMES = {"warp-cpu": "cpu", "cuda": "cuda"}


def check_device(choice: Physics) -> None:
    """Refuse a device that cannot be used.

    Raises `UserError` if the extra or the device is missing, or it shall step as the reference
    integrator does.
    """
    if choice.device == "cpu":
        return
    what = f"device {choice.device}"
    require(what, "mujoco_warp", "warp")
    if choice.integrator != "fast":
        raise UserError(
            f"{what}: has the fast integrator only; give physics.integrator = fast, or no device"
        )
    from mjforage.physics.warp_hulls import check_found  # Warp where it is wanted

    check_found(_WARP_NAMES[choice.device])


def create_simulation(
    choice: Physics, scene: Scene, simulations: int, *, step_s: float, **options: Any
) -> SimulatedFleet:
    """A batch of simulations of a scene on the device of a scenario.

    Raises `UserError` as that of the engine.

    `step_s`: of the physics [s]; `options`: seeds and items, as of `Simulation`.
    """
    if choice.device == "cpu":
        integrator = Integrator(choice.integrator)
        return Simulation(scene, simulations, integrator=integrator, step_s=step_s, **options)
    from mjforage.physics.warp_simulation import WarpSimulation

    device = _WARP_NAMES[choice.device]
    return WarpSimulation(scene, simulations, device=device, step_s=step_s, **options)
