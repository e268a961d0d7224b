"""Vessels as objects: written to files, by which scenarios name them."""

import getpass
import hashlib
import tempfile
from dataclasses import is_dataclass
from pathlib import Path
from typing import Any, get_type_hints

import tomli_w

from mjforage.base.atomic_files import atomic_write, write_errors
from mjforage.base.errors import UserError
from mjforage.base.kernel_cache import kernel_folder
from mjforage.base.references import file_label
from mjforage.physics.vessels import Vessel, check_vessel
from mjforage.scenario.quantities import Quantity
from mjforage.scenario.schema import NotInFile, check


def vessel_folder() -> Path:
    """Folder of the files of vessels that are objects, in the user's folder for caches."""
    cache = kernel_folder() or Path(tempfile.gettempdir()) / f"mjforage-{getpass.getuser()}"
    return cache / "vessels"


def vessel_file(vessel: Vessel) -> Path:
    """File of a vessel that is an object; the same for equal vessels.

    Raises `UserError` if a parameter is no valid one, no body can have them, or the file cannot be
    written.
    """
    where = f"vessel {vessel.name}"
    if not isinstance(vessel.name, str) or file_label(vessel.name) != vessel.name:
        raise UserError(f"{where!r}: its name is that of a file; give letters, digits and dashes")
    tables = _tables(vessel)
    check_vessel(check(Vessel, tables, where, name=vessel.name), where)
    text = tomli_w.dumps(tables)
    digest = hashlib.sha256(text.encode()).hexdigest()[:16]
    path = vessel_folder() / digest / f"{vessel.name}.toml"
    with write_errors(path):
        path.parent.mkdir(parents=True, exist_ok=True)
    with atomic_write(path) as beside:
        beside.write_text(text, encoding="utf-8")
    return path


def _tables(record: Any) -> dict[str, Any]:
    """Keys of a file: numbers with their units, and tables; what is absent is left out."""
    found: dict[str, Any] = {}
    hints = get_type_hints(type(record), include_extras=True)
    for name, hint in hints.items():
        value = getattr(record, name)
        notes = getattr(hint, "__metadata__", ())
        units = [note.unit for note in notes if isinstance(note, Quantity)]
        if is_dataclass(value):
            found[name] = _tables(value)
        elif units:
            found[name] = {"value": value, "unit": units[0], "source": "given in Python"}
        elif value is not None and not any(isinstance(note, NotInFile) for note in notes):
            found[name] = value
    return found
