"""One hull on open water in MuJoCo, for manoeuvres: the same interface as the plain equations."""

import mujoco
import numpy as np

from mjforage.callback import calling
from mjforage.callback.layout import WATER, WIND
from mjforage.hydrodynamics.conditions import Conditions, State, to_body
from mjforage.scene import build_scene
from mjforage.simulation.errors import check_warnings
from mjforage.simulation.integrators import Integrator, prepared
from mjforage.simulation.quiet import silent
from mjforage.vessels import Vessel


class MujocoHull:
    """A `Hull` moved by MuJoCo's Runge-Kutta integrator and the force callback."""

    def __init__(self, vessel: Vessel, conditions: Conditions) -> None:
        self._model = prepared(build_scene([vessel]).model, Integrator.REFERENCE, 0.05)
        self._data = data = mujoco.MjData(self._model)
        data.userdata[WIND : WIND + 2] = conditions.wind_mps
        data.userdata[WATER : WATER + 2] = conditions.current_mps
        x, y, yaw, u, v, r = conditions.start
        data.qpos[:] = x, y, yaw
        data.qvel[:] = *to_body((u, v), -yaw), r

    def step(self, port: float, starboard: float, step_s: float) -> None:
        """Advance by one Runge-Kutta step under constant commands [rad/s or N].

        Raises
        ------
        InstabilityError
            If the hull's motion became unstable.
        """
        data, before = self._data, np.array([self._data.time])
        self._model.opt.timestep = step_s
        data.ctrl[:] = port, starboard
        with calling(), silent():
            mujoco.mj_step(self._model, data)
        warning = np.stack((data.warning.lastinfo, data.warning.number), axis=1)[None]
        only = np.zeros(1, np.intp)
        check_warnings(self._model, warning, only, (0,), before)

    def state(self) -> State:
        """Position, yaw, velocity over ground in body axes, yaw rate."""
        x, y, yaw = (float(value) for value in self._data.qpos)
        vx, vy, r = (float(value) for value in self._data.qvel)
        return x, y, yaw, *to_body((vx, vy), yaw), r
