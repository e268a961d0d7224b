"""Folder lock: one process writes a folder at a time."""

import errno
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from filelock import FileLock, Timeout

from mjforage.base.errors import UserError
from mjforage.runs.foreign import check_files

_LOCK = ".lock"
_READ_ONLY = (errno.EACCES, errno.EPERM, errno.EROFS)


@contextmanager
def folder_lock(path: Path) -> Iterator[None]:
    """Keep other processes from writing a folder; the system lets go of it with the process.

    The lock is on the file `.lock` in the folder, which stays. A folder that this process may not
    write to is not locked: a finished run is read there as well, and where something must be
    written, the first file names the cause. Raises `UserError` if another process is writing it,
    the disk has no locks, or a link is in the folder, by which the lock could be a file elsewhere.
    """
    check_files(path / _LOCK)
    lock = FileLock(path / _LOCK)
    try:
        lock.acquire(timeout=0)
    except Timeout as error:
        raise UserError(
            f"{path}: another process is writing this run; wait for it, or choose another folder"
        ) from error
    except (OSError, NotImplementedError) as error:
        if getattr(error, "errno", None) not in _READ_ONLY:
            reason = getattr(error, "strerror", None) or str(error)
            raise UserError(
                f"{path / _LOCK}: cannot be locked ({reason}); choose a folder on a disk with locks"
            ) from error
    try:
        yield
    finally:
        lock.release()
