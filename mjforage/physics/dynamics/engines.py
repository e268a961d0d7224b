"""Engines for the hulls of a mission: MuJoCo on this processor, or MuJoCo Warp on a device."""

from typing import Any

from mjforage.base.device import SIMULATED
from mjforage.base.errors import UserError
from mjforage.base.extras import require
from mjforage.physics.positioning import Positioning
from mjforage.physics.scene import Scene
from mjforage.physics.simulation import Integrator, Simulation
from mjforage.physics.simulation.simulated_fleet import SimulatedFleet
from mjforage.scenario.scenario import Physics


def check_device(choice: Physics, positioning: str, model: Positioning) -> None:
    """Refuse a device that cannot be used.

    Raises `UserError` if the extra or the device is missing, it shall step as the reference
    integrator does, or the positioning model has no kernel.

    `positioning`: the name of the model.
    """
    if choice.device == "cpu":
        return
    what = f"device {choice.device}"
    require(what, "mujoco_warp", "warp")
    if choice.integrator != "fast":
        raise UserError(
            f"{what}: has the fast integrator only; give physics.integrator = fast, or no device"
        )
    if not hasattr(model, "on_device"):
        raise UserError(
            f"{what}: positioning {positioning} has no kernel for it (`on_device`); give no device"
        )
    from mjforage.physics.warp_hulls import check_found  # Warp where it is wanted

    if not SIMULATED:
        check_found("cuda" if choice.device == "cuda" else "cpu")
    if choice.device == "cuda":
        require(what, "numba_cuda")


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

    return WarpSimulation(scene, simulations, device=choice.device, step_s=step_s, **options)
