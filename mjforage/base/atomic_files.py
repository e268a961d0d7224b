"""Atomic writes: files are written beside their place under a temporary name, then moved.

Two processes that write the same file never share a temporary name; the last one to finish stays.
"""

import errno
import json
import os
import re
import uuid
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from mjforage.base.errors import UserError, printable

_AGAIN = "run the same again: finished work is kept"
_PART = ".part"
_NUMBER = re.compile(r"\(os error (\d+)\)")
_REMEDIES = {
    **dict.fromkeys(
        (errno.ENOSPC, errno.EDQUOT, errno.EFBIG), f"free some space there, then {_AGAIN}"
    ),
    **dict.fromkeys((errno.EACCES, errno.EPERM, errno.EROFS), "give a place that you may write to"),
    **dict.fromkeys(
        (errno.EEXIST, errno.ENOTDIR, errno.EISDIR), "move what is there away or give another name"
    ),
    **dict.fromkeys(
        (errno.EMFILE, errno.ENFILE),
        f"give fewer jobs or let more files be open (ulimit -n), then {_AGAIN}",
    ),
    errno.EIO: f"see to that disk, then {_AGAIN}",
    errno.ENAMETOOLONG: "give a shorter name",
    errno.ENOENT: "give a place in a folder that exists",
}


def remedy(error: BaseException, otherwise: str = "") -> str:
    """Remedy for an error of the system, by its number.

    `otherwise`: against one that is nothing special.
    """
    found = _NUMBER.search(str(error))  # as polars has it
    number = getattr(error, "errno", None) or (int(found[1]) if found else 0)
    return _REMEDIES.get(number, otherwise or f"mend that or give another place, then {_AGAIN}")


@contextmanager
def write_errors(path: Path, *others: type[Exception]) -> Iterator[None]:
    """Turn a failure to write into one clear error that names the cause and its remedy.

    Raises `UserError` if the block fails for want of space or rights, or the path cannot be one.

    Parameters
    ----------
    path : file to write, for the message
    others : exceptions of the library that writes, beside `OSError`
    """
    failures: tuple[type[Exception], ...] = (OSError, *others)
    try:
        yield
    except failures as error:
        reason = getattr(error, "strerror", None) or str(error).partition("\n")[0]
        if isinstance(error, FileExistsError | NotADirectoryError):
            reason = "a file is there, or where a folder above it should be"
        raise UserError(f"{path}: cannot be written ({reason}); {remedy(error)}") from error
    except ValueError as error:
        if "\0" not in str(path):
            raise
        name = printable(str(path))
        raise UserError(f"{name}: no file can have this name; give another one") from error


@contextmanager
def atomic_write(path: Path, *others: type[Exception]) -> Iterator[Path]:
    """Give a temporary path in the same folder; it takes the place of `path` after the block.

    If the block fails, nothing is left of it and an older file stays. Raises `UserError` if the
    file cannot be written.

    `path`, `others`: as for `write_errors`.
    """
    with write_errors(path, *others):
        place = Path(os.path.realpath(path))  # a link stays one
        if place.exists() and not (place.is_file() or place.is_dir()):
            yield place  # a device or a pipe
            return
        beside = place.with_name(f"{_start(place)}{uuid.uuid4().hex}{_PART}")
        try:
            yield beside
            beside.replace(place)
        finally:
            with suppress(OSError):
                beside.unlink(missing_ok=True)


def _start(path: Path) -> str:
    """Prefix of a file's temporary names; short, so that a long name still has one."""
    return f".{path.name[:60]}."


def remove_parts(path: Path) -> None:
    """Remove partial files of killed processes; no other process may be writing now."""
    for left in path.parent.iterdir():
        if left.name.startswith(_start(path)) and left.suffix == _PART:
            left.unlink(missing_ok=True)


def write_bytes(path: Path, content: bytes) -> None:
    """Write a file whole, in a folder that is made if it is missing.

    Raises `UserError` if it cannot be written.
    """
    with write_errors(path):
        path.parent.mkdir(parents=True, exist_ok=True)
    with atomic_write(path) as beside:
        beside.write_bytes(content)


def write_json(path: Path, value: object) -> None:
    """Write JSON whole; a file that holds the same bytes is left alone.

    Raises `UserError` if it cannot be written.
    """
    content = (json.dumps(value, indent=1, allow_nan=False) + "\n").encode()
    with write_errors(path):
        if path.is_file() and path.read_bytes() == content:
            return
    with atomic_write(path) as beside:
        beside.write_bytes(content)
