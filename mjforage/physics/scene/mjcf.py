"""Shipped MJCF parts, and compiling what is made of them."""

import mujoco

from mjforage.base.errors import UserError
from mjforage.scenario.assets import models_folder


def shipped_part(name: str) -> mujoco.MjSpec:
    """Parse `models/NAME.xml`."""
    return mujoco.MjSpec.from_file(str(models_folder() / f"{name}.xml"))


def compiled(spec: mujoco.MjSpec, what: str) -> mujoco.MjModel:
    """Compile a spec; raises `UserError` if MuJoCo refuses it, naming `what` was built."""
    try:
        return spec.compile()
    except ValueError as error:
        reason = " ".join(str(error).split())
        raise UserError(f"{what}: MuJoCo cannot build it ({reason})") from error
