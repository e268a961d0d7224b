"""Reading MJCF parts, those that ship and a user's, with errors that name the file."""

from pathlib import Path

import mujoco

from mjforage.base.errors import UserError
from mjforage.scenario.assets import models_folder


def read_part(path: Path) -> mujoco.MjSpec:
    """Parse an MJCF file.

    Raises
    ------
    UserError
        If it is missing or not valid MJCF.
    """
    if not path.is_file():
        raise UserError(f"model {path}: no such file; give an MJCF file")
    try:
        return mujoco.MjSpec.from_file(str(path))
    except (ValueError, UnicodeDecodeError) as error:
        reason = " ".join(str(error).split())
        raise UserError(f"model {path.name}: malformed MJCF ({reason})") from error


def shipped_part(name: str) -> mujoco.MjSpec:
    """Parse `models/NAME.xml`."""
    return read_part(models_folder() / f"{name}.xml")


def compiled(spec: mujoco.MjSpec, what: str) -> mujoco.MjModel:
    """Compile a spec.

    Raises
    ------
    UserError
        If MuJoCo refuses it, naming `what` was built.
    """
    try:
        return spec.compile()
    except ValueError as error:
        reason = " ".join(str(error).split())
        raise UserError(f"{what}: MuJoCo cannot build it ({reason})") from error
