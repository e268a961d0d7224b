"""Fleets of many episodes on a device: hulls in MuJoCo Warp, controllers and items in our kernels.

A tick goes from the hulls' poses to commands, and moves hulls and items on; nothing of it is on the
host. Items drift and meet quays, but no hulls and no other items. Nothing is sensed or collected.
"""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.device import Launch
from mjforage.controllers import Chart, Pilot
from mjforage.controllers.pilot import COMMAND
from mjforage.physics.device_hulls import DeviceHulls
from mjforage.physics.dynamics.ticks import CONTROL_S
from mjforage.physics.floating.drift import DRIFT, Afloat
from mjforage.physics.scene import Scene
from mjforage.physics.simulation.integrators import Integrator, half_step_s
from mjforage.physics.simulation.simulation import Simulation
from mjforage.physics.vessel_models import vessel_model

FloatArray = NDArray[np.float64]
Float32Array = NDArray[np.float32]


@kernel
def _read(
    q: Float32Array, v: Float32Array, shift_s: float, pose: FloatArray, velocity: FloatArray
) -> None:
    """Write poses and velocities (episode, vessel, 3), of those of Warp (episode, 3 x vessel)."""
    for e in range(pose.shape[0]):
        for i in range(pose.shape[1]):
            for axis in range(3):
                rate = float(v[e, 3 * i + axis])
                velocity[e, i, axis] = rate
                pose[e, i, axis] = q[e, 3 * i + axis] - shift_s * rate


@kernel
def _tell(commands: FloatArray, ctrl: Float32Array) -> None:
    """Write commands (episode, vessel, 2) for Warp (episode, 2 x vessel)."""
    for e in range(commands.shape[0]):
        for i in range(commands.shape[1]):
            ctrl[e, 2 * i], ctrl[e, 2 * i + 1] = commands[e, i, 0], commands[e, i, 1]


READ, TELL = Launch(_read), Launch(_tell)


class DeviceFleet:
    """A batch of fleets that follow their orders among quays and drifting items."""

    def __init__(
        self, scene: Scene, chart: Chart, episodes: int, items: int, device: str = "cuda"
    ) -> None:
        """Set up vessels at the origin and items that are not on the water.

        Raises `UserError` if there is no such device.

        `scene`: of `build_scene`, with no bodies for items; `items`: of an episode; `device`: as of
        `DeviceHulls`.
        """
        self.hulls = hulls = DeviceHulls(scene, episodes, step_s=CONTROL_S, device=device)
        models = [vessel_model(vessel) for vessel in scene.vessels]
        self.pilot = Pilot(models, chart, episodes, CONTROL_S)
        one = Simulation(scene, 1, integrator=Integrator.FAST, step_s=CONTROL_S, items=items)
        kinds, quays = one.item_kinds
        self.afloat = Afloat.of(len(kinds), episodes, items)
        self.afloat.kinds[:] = kinds
        self.active = np.ones(episodes, np.bool_)
        self.pose, self.velocity = np.zeros((2, episodes, len(models), 3))
        given = self.pilot.arguments(self.active, self.pose, self.velocity)
        shift_s, way = half_step_s(Integrator.FAST, CONTROL_S), (self.pose, self.velocity)
        self._tick = (
            hulls.bind(READ, hulls.places, hulls.velocities, shift_s, *way),
            hulls.bind(COMMAND, *given),
            hulls.bind(TELL, given[2], hulls.commands),
            hulls.step,
            hulls.bind(DRIFT, self.afloat, quays, CONTROL_S, True, self.active, 1),
        )
        self._state = given[0].state

    def place(self, pose: FloatArray) -> None:
        """Put the vessels (episode, vessel, 3) somewhere, at rest [m], [rad]."""
        self.hulls.hulls.place_vessels(pose)
        self.pose[:] = pose
        self.hulls.arrays.send(self.pose)

    def send(self) -> None:
        """Have the device know of orders to the pilot, and of changes to the items."""
        for array in (self._state, *self.afloat):
            self.hulls.arrays.send(array)

    def run(self, ticks: int) -> None:
        """Advance by so many ticks of 0.1 s."""
        self.hulls.run(self._tick * ticks)
        self.hulls.wait()

    def fetch(self) -> None:
        """Have the host know poses, velocities and items."""
        for array in (self.pose, self.velocity, self._state, *self.afloat):
            self.hulls.arrays.fetch(array)
