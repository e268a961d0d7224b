"""Hulls of many worlds in MuJoCo Warp: the fast integrator on a GPU, or slowly on a CPU.

Loads and inertia are those of `callback.vessel_motion`, contacts those of `callback.contact_rows`,
from the same source, in float32. Items, control and sensing are not here.
"""

from typing import Any

import mujoco
import mujoco_warp
import numpy as np
import warp as wp
from mujoco_warp import DisableBit
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.warped import struct_of, warped
from mjforage.physics.callback import vessel_motion
from mjforage.physics.callback.model_layout import VESSEL_DOFS
from mjforage.physics.hydrodynamics.parameters import VesselParameters, pack
from mjforage.physics.scene import Scene
from mjforage.physics.simulation.integrators import Integrator, half_step_s, prepared
from mjforage.physics.warp_contacts import ContactRows, check_room

Parameters = struct_of(VesselParameters)
Surroundings = struct_of(vessel_motion.Surroundings)
wp.config.log_level = wp.LOG_ERROR  # else it prints on standard output
FIELDS = vessel_motion.Surroundings._fields
CALM = 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0
"""No wind, no current, no load, and a vessel as its file has it."""
CONTACTS = 16  # room for each vessel of a world: four corners at as many quays
_PLAIN = DisableBit.NATIVECCD | DisableBit.WARMSTART
"""Boxes meet as on the CPU, and a step hangs on nothing but the state that it begins with."""
_inertia, _averaged_load = warped(vessel_motion.inertia), warped(vessel_motion.averaged_load)


@wp.kernel(module="unique")  # type: ignore[untyped-decorator]
def _add_loads(
    parameters: wp.array(dtype=Parameters),  # type: ignore[valid-type]
    row: wp.array(dtype=int),  # type: ignore[valid-type]
    around: wp.array3d(dtype=float),  # type: ignore[valid-type]
    step_s: float,
    qpos: wp.array2d(dtype=float),  # type: ignore[valid-type]
    qvel: wp.array2d(dtype=float),  # type: ignore[valid-type]
    act: wp.array2d(dtype=float),  # type: ignore[valid-type]
    ctrl: wp.array2d(dtype=float),  # type: ignore[valid-type]
    force: wp.array2d(dtype=float),  # type: ignore[valid-type]
    mass: wp.array2d(dtype=float),  # type: ignore[valid-type]
) -> None:
    """Force and rows of M of vessel v of world w, as `callback.forces` has them."""
    w, v = wp.tid()  # type: ignore[misc]
    i, p, x = 3 * v, parameters[v], around[w, v]
    about = Surroundings(x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7], x[8])
    body = _inertia(p, about.load, about.mass)
    command = wp.vec2(ctrl[w, 2 * v], ctrl[w, 2 * v + 1])
    lagged = wp.vec2(act[w, 2 * v], act[w, 2 * v + 1])
    yaw, vx, vy, r = qpos[w, i + 2], qvel[w, i], qvel[w, i + 1], qvel[w, i + 2]
    surge, sway, turn, m_surge, m_sway, m_yaw = _averaged_load(
        p, body, yaw, vx, vy, r, command, lagged, about, step_s
    )
    c, s = wp.cos(yaw), wp.sin(yaw)
    force[w, i] = force[w, i] + c * surge - s * sway
    force[w, i + 1] = force[w, i + 1] + s * surge + c * sway
    force[w, i + 2] = force[w, i + 2] + turn
    first, second, third = row[i], row[i + 1], row[i + 2]
    mass[w, first] = c * c * m_surge + s * s * m_sway
    mass[w, second] = c * s * (m_surge - m_sway)
    mass[w, second + 1] = s * s * m_surge + c * c * m_sway
    mass[w, third] = -s * body.moment
    mass[w, third + 1] = c * body.moment
    mass[w, third + 2] = m_yaw


def check_found(device: str) -> None:
    """Refuse a device, as Warp names it, that is not there; raises `UserError`."""
    if device != "cpu" and not wp.is_cuda_available():
        raise UserError(f"device {device}: there is none here; give warp-cpu, or no device")


class WarpHulls:
    """The vessels of a scene without items, in many worlds.

    Inputs count from the next step. At first all vessels lie at the origin, without wind, current
    and load.
    """

    def __init__(
        self,
        scene: Scene,
        worlds: int = 1,
        *,
        step_s: float = 0.1,
        device: str = "cpu",
        contacts: int = 0,
    ) -> None:
        """Set up worlds.

        Raises `UserError` if the scene has items, or there is no such device.

        Parameters
        ----------
        scene : of `build_scene`, with no bodies for items
        step_s : time step [s]
        device : "cpu" or "cuda", as Warp names it
        contacts : of a world, at most; by default `CONTACTS` for each vessel
        """
        if scene.items:
            raise UserError(f"warp: a scene with {scene.items} items; give one with none")
        check_found(device)
        self._shift_s, self._vessels = half_step_s(Integrator.FAST, step_s), len(scene.vessels)
        self._room = contacts or CONTACTS * self._vessels
        model = prepared(scene, Integrator.FAST, step_s)
        apart = mujoco.MjData(model)
        apart.qpos[::VESSEL_DOFS] = 1e3 * np.arange(self._vessels)  # no contacts to begin with
        with wp.ScopedDevice(device):
            self._model = mujoco_warp.put_model(model)
            self._model.opt.warn_overflow = 0  # `check_room` tells
            self._model.opt.disableflags |= _PLAIN
            rooms = {"nworld": worlds, "nconmax": self._room, "njmax": 3 * self._room}
            self._data = mujoco_warp.put_data(model, apart, **rooms)
            given = [_given(pack(vessel)) for vessel in scene.vessels]
            self._parameters: Any = wp.array(given, dtype=Parameters)
            self._row: Any = wp.array(model.M_rowadr, dtype=int)
            calm = np.tile(np.array(CALM, np.float32), (worlds, self._vessels, 1))
            self._around: Any = wp.array(calm, dtype=float)
        self._step_s, self._device = step_s, device
        self._rows = ContactRows(model)
        self._model.callback.passive = self._load
        self.place_vessels(np.zeros((worlds, self._vessels, VESSEL_DOFS)))

    def _load(self, model: Any, data: Any) -> None:
        """The callback of MuJoCo Warp."""
        inputs = [self._parameters, self._row, self._around, self._step_s]
        inputs += [data.qpos, data.qvel, data.act, data.ctrl, data.qfrc_passive, data.M]
        wp.launch(_add_loads, self._around.shape[:2], inputs, device=self._device)
        self._rows.prepare(data)

    def place_vessels(self, pose: NDArray[np.float64]) -> None:
        """Put vessels (world, vessel, 3) somewhere, at rest: x, y [m], yaw [rad] of midships."""
        self._data.qpos.assign(pose.reshape(len(pose), -1).astype(np.float32))
        self._data.qvel.zero_()
        self._data.act.zero_()

    def command(self, commands: NDArray[np.float64]) -> None:
        """Set the commands (world, vessel, 2), port and starboard, [rad/s] or [N]."""
        self._data.ctrl.assign(commands.reshape(len(commands), -1).astype(np.float32))

    @property
    def live(self) -> tuple[Any, Any, Any, Any, Any]:
        """Warp's own arrays of float32: places and velocities (world, 3 x vessel), lagged commands
        and commands (world, 2 x vessel), surroundings (world, vessel, 9).
        """
        data = self._data
        return data.qpos, data.qvel, data.act, data.ctrl, self._around

    @property
    def memory_bytes(self) -> int:
        """Memory of all worlds on the device, without the model and Warp's own scratch."""
        return _bytes_of(self._data) + int(self._around.capacity)

    def surround(self, **inputs: NDArray[np.float64] | float) -> None:
        """Set fields of `vessel_motion.Surroundings`, (world, vessel) each or what broadcasts."""
        around = self._around.numpy()
        for name, values in inputs.items():
            around[..., FIELDS.index(name)] = values
        self._around.assign(around)

    def step(self, steps: int = 1) -> None:
        """Advance all worlds; raises `UserError` if there is no room for all contacts."""
        for _ in range(steps):
            self.advance()
        self.check()

    def advance(self) -> None:
        """Advance all worlds by a step; whether there was room for all contacts, `check` tells."""
        with wp.ScopedDevice(self._device):
            mujoco_warp.step(self._model, self._data)

    def check(self) -> None:
        """Raise `UserError` if there was no room for all contacts since the start."""
        check_room(self._data, self._room)

    @property
    def force(self) -> NDArray[np.float32]:
        """(world, dof) of contacts in the last step, world axes [N], [N m]; a copy."""
        force: NDArray[np.float32] = self._data.qfrc_constraint.numpy()
        return force.copy()

    @property
    def vessel_velocity(self) -> NDArray[np.float32]:
        """(world, vessel, 3) over ground, world axes [m/s], yaw rate [rad/s]; a copy."""
        flat: NDArray[np.float32] = self._data.qvel.numpy().copy()
        return flat.reshape(len(flat), self._vessels, VESSEL_DOFS)

    @property
    def vessel_pose(self) -> NDArray[np.float32]:
        """(world, vessel, 3) x, y [m], yaw [rad] of midships; a copy."""
        ahead = self._data.qpos.numpy().reshape(self.vessel_velocity.shape)
        pose: NDArray[np.float32] = ahead - np.float32(self._shift_s) * self.vessel_velocity
        return pose


def _bytes_of(part: Any) -> int:
    """Memory of all of Warp's arrays in something."""
    if isinstance(part, wp.array):
        return int(part.capacity)
    return sum(map(_bytes_of, vars(part).values())) if hasattr(part, "__dict__") else 0


def _given(record: Any) -> Any:
    """A vessel's numbers as Warp's struct."""
    struct = Parameters()
    for field in record.dtype.names:
        setattr(struct, field, float(record[field]))
    return struct
