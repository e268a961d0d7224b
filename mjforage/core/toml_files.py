"""TOML files that a person writes, read in one way."""

import tomllib
from pathlib import Path
from typing import Any

from mjforage.core.errors import UserError


def read_toml(path: Path, where: str) -> dict[str, Any]:
    """The tables of a file.

    Parameters
    ----------
    where : what errors name first

    Raises
    ------
    UserError
        If the file cannot be read, is not UTF-8 or not TOML, or is nested too deeply.
    """
    if path.exists() and not path.is_file():
        raise UserError(f"{where}: is no file; give a TOML file")
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise UserError(f"{where}: not readable as TOML ({error})") from error
