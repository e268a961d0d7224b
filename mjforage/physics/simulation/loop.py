"""A plain loop with the part of `mujoco.batch.Batch` that we use, for Python callbacks.

`Batch` refuses those. Slower, and equal to the bit.
"""

import mujoco
import numpy as np
from numpy.typing import NDArray

_SPEC = mujoco.mjtState
_FIELDS = {
    "time": _SPEC.mjSTATE_TIME,
    "qpos": _SPEC.mjSTATE_QPOS,
    "qvel": _SPEC.mjSTATE_QVEL,
    "act": _SPEC.mjSTATE_ACT,
    "qacc_warmstart": _SPEC.mjSTATE_WARMSTART,
    "ctrl": _SPEC.mjSTATE_CTRL,
    "userdata": _SPEC.mjSTATE_USERDATA,
}


class Loop:
    """Simulations of one model, one after the other.

    Attributes
    ----------
    state : (simulation, number) integration states
    warning : (simulation, kind, 2) last information and count of each warning
    """

    def __init__(self, model: mujoco.MjModel, simulations: int) -> None:
        self.model, self._data = model, mujoco.MjData(model)
        size = mujoco.mj_stateSize(model, int(_SPEC.mjSTATE_INTEGRATION))
        self.state = np.zeros((simulations, size))
        self.warning = np.zeros((simulations, len(self._data.warning), 2), np.int32)
        self._contact_force = np.zeros((simulations, model.nv))
        self.reset(np.arange(simulations))

    def bind(self, name: str) -> NDArray[np.float64]:
        """Live (simulation, ...) view of a state field, or of the last contact forces."""
        if name == "qfrc_constraint":
            return self._contact_force
        start = 0
        spec = int(_FIELDS[name])
        for bit in range(spec.bit_length() - 1):
            if int(_SPEC.mjSTATE_INTEGRATION) & (1 << bit):
                start += mujoco.mj_stateSize(self.model, 1 << bit)
        view = self.state[:, start : start + mujoco.mj_stateSize(self.model, spec)]
        return view[:, 0] if name == "time" else view

    def reset(self, ids: NDArray[np.intp]) -> None:
        """Put simulations back to the model's defaults."""
        mujoco.mj_resetData(self.model, self._data)
        for sim in ids:
            mujoco.mj_getState(
                self.model, self._data, self.state[sim], int(_SPEC.mjSTATE_INTEGRATION)
            )
        self.warning[ids] = 0

    def step(self, ids: NDArray[np.intp] | None = None, nstep: int = 1) -> None:
        """Advance simulations, by default all."""
        spec, data = int(_SPEC.mjSTATE_INTEGRATION), self._data
        for sim in range(len(self.state)) if ids is None else ids:
            mujoco.mj_setState(self.model, data, self.state[sim], spec)
            before = data.warning.number.copy()
            for _ in range(nstep):
                mujoco.mj_step(self.model, data)
            mujoco.mj_getState(self.model, data, self.state[sim], spec)
            self._contact_force[sim] = data.qfrc_constraint
            risen = data.warning.number - before
            self.warning[sim, :, 1] += risen
            self.warning[sim, risen > 0, 0] = data.warning.lastinfo[risen > 0]
