"""One vessel on open water in MuJoCo, for manoeuvres."""

import math

import mujoco
import numpy as np

from mjforage.base.errors import UserError
from mjforage.physics.callback import install
from mjforage.physics.callback.model_layout import LOAD, WATER, WIND
from mjforage.physics.hydrodynamics.conditions import Conditions, State, to_body
from mjforage.physics.scene import build_scene
from mjforage.physics.simulation.instability import check_warnings, warnings_suppressed
from mjforage.physics.simulation.integrators import Integrator, prepared
from mjforage.physics.vessels import Vessel

LONGEST_S = 0.05  # of one Runge-Kutta step
SHORTEST_LAG_S = 1e-3  # below it, a minute would take 60,000 steps
ROUNDING = 1e-6  # share by which a step may be longer: differences of times are not exact


class MujocoVessel:
    """A `SimulatedVessel` moved by MuJoCo's Runge-Kutta integrator and the force callback."""

    def __init__(self, vessel: Vessel, conditions: Conditions, load: float = 0.0) -> None:
        """Put the vessel at its start.

        Raises `UserError` if the thrusters' lag is too short for steps that follow it.

        `load`: items aboard.
        """
        if vessel.lag_s < SHORTEST_LAG_S:
            raise UserError(
                f"vessel {vessel.name}: lag_s = {vessel.lag_s:g} s is too short to step in MuJoCo; "
                f"give {SHORTEST_LAG_S:g} s or more"
            )
        self._longest_s = min(LONGEST_S, vessel.lag_s)
        self._model = prepared(build_scene([vessel]), Integrator.REFERENCE, self._longest_s)
        self._data = data = mujoco.MjData(self._model)
        data.userdata[WIND : WIND + 2] = conditions.wind_mps
        data.userdata[WATER : WATER + 2] = conditions.current_mps
        data.userdata[LOAD] = load
        x, y, yaw, u, v, r = conditions.start
        data.qpos[:] = x, y, yaw
        data.qvel[:] = *to_body((u, v), -yaw), r

    def step(self, port: float, starboard: float, step_s: float) -> None:
        """Advance under constant commands [rad/s or N], by equal Runge-Kutta steps.

        None is longer than 0.05 s or than the thrusters' lag: from 2.785 lags on, Runge-Kutta of
        order 4 lets the lag oscillate between the thrusters' limits, and no warning would tell.
        Raises `InstabilityError` if the vessel's motion became unstable.
        """
        data, before = self._data, np.array([self._data.time])
        parts = max(1, math.ceil(step_s / self._longest_s - ROUNDING))
        self._model.opt.timestep = step_s / parts
        data.ctrl[:] = port, starboard
        install()
        with warnings_suppressed():
            for _ in range(parts):
                mujoco.mj_step(self._model, data)
        warning = np.stack((data.warning.lastinfo, data.warning.number), axis=1)[None]
        only = np.zeros(1, np.intp)
        check_warnings(self._model, warning, only, (0,), before)

    def state(self) -> State:
        """Position, yaw, velocity over ground in body axes, yaw rate."""
        x, y, yaw = (float(value) for value in self._data.qpos)
        vx, vy, r = (float(value) for value in self._data.qvel)
        return x, y, yaw, *to_body((vx, vy), yaw), r
