"""Checks of a folder of unknown origin, before anything in it is read or written."""

import os
import re
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path

from mjforage.base.errors import UserError
from mjforage.scenario.schema import shown

_NAME = re.compile(r"\w[\w.@+-]{0,99}")
_LARGEST = 200_000_000  # bytes of a JSON file: more than the summary of any run takes


def check_files(file: Path) -> None:
    """Refuse a folder of a run, study or training that leads out of itself.

    Raises `UserError` if a link, a pipe or a device is in the folder, at any depth.

    `file`: in the folder, that says what it holds; without it the folder is none of ours, and free.
    """
    places = [str(file.parent)] if os.path.lexists(file) else []
    while places:
        with suppress(OSError), os.scandir(places.pop()) as entries:
            for entry in entries:
                if entry.is_dir(follow_symlinks=False):
                    places.append(entry.path)
                elif not entry.is_file(follow_symlinks=False):
                    raise UserError(
                        f"{entry.path}: is a link or a device, by which a folder can lead "
                        "anywhere; remove it, or put the file itself there"
                    )


def check_names(where: str, names: Mapping[str, Iterable[object]]) -> None:
    """Refuse names of a file that are to become names of files and could be paths.

    Raises `UserError` if one holds anything but letters, digits and `_.@+-`, or begins with a sign.

    `where`: the file, for the message; `names`: key of the file -> names.
    """
    for key, found in names.items():
        for name in found:
            if not isinstance(name, str) or not _NAME.fullmatch(name):
                raise UserError(
                    f"{where}: {key}: {shown(name)} can be no part of a file's name; the folder is "
                    "damaged or not of mjforage: make it again"
                )


def check_length(path: Path, remedy: str) -> None:
    """Refuse a JSON file that is too large to be ours; raises `UserError`, ending in the remedy."""
    with suppress(OSError):
        if (size := path.stat().st_size) > _LARGEST:
            raise UserError(f"{path}: {size / 1e6:.0f} MB are more than any run writes; {remedy}")
