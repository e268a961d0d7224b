"""TOML files that a person writes, read in one way."""

import tomllib
from pathlib import Path
from typing import Any

from mjforage.base.errors import UserError

LARGEST = 10_000_000  # bytes: some hundred times what anybody writes by hand


def read_toml(path: Path, where: str) -> dict[str, Any]:
    """The tables of a file.

    Raises `UserError` if the file cannot be read, is too large, not UTF-8 or not TOML, or is nested
    too deeply.

    `where`: start of error messages.
    """
    if path.exists() and not path.is_file():
        raise UserError(f"{where}: is no file; give a TOML file")
    if path.is_file() and (size := path.stat().st_size) > LARGEST:
        raise UserError(f"{where}: {size:,} bytes are more than such a file has; give a TOML file")
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise UserError(f"{where}: not readable as TOML ({error})") from error
