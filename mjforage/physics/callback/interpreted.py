"""The slow route: the same forces called back through Python, where the native route fails.

`mujoco.batch.Batch` refuses Python callbacks; a plain loop then steps (`physics.simulation`).
"""

import mujoco

from mjforage.physics.callback.forces import State, apply
from mjforage.physics.callback.model_layout import HEADER, MAGIC


def python_callback(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """Passive callback for `mujoco.set_mjcb_passive`; leaves models that are not ours alone."""
    if model.numeric_data.size < HEADER or model.numeric_data[0] != MAGIC:
        return
    apply(
        State(
            model.numeric_data,
            model.M_rowadr,
            data.qpos,
            data.qvel,
            data.act,
            data.ctrl,
            data.userdata,
            data.qfrc_passive,
            data.M,
            model.opt.timestep,
        )
    )
    mujoco.mj_factorM(model, data)
