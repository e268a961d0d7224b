"""Compiled kernels on disk, one file for each kernel and types of arguments, named by its content.

All checkouts and installations of a user share one folder: the environment variable
`NUMBA_CACHE_DIR` if it is set, else the user's folder for caches. Of processes that want the same
kernel one compiles it, and the others wait for its file. A folder that cannot be written is read
all the same; what it lacks is compiled in every process, and that is said once.
"""

import hashlib
import logging
import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any, cast

import numba
from filelock import FileLock, Timeout
from numba.core import compiler, config, event
from numba.core.caching import IndexDataCacheFile

from mjforage.base.compile_notice import say_compiling
from mjforage.base.kernel_content import content, type_content

KEPT_DAYS = 60
"""Kernels that no process has read for so long are deleted when another one is written."""
AWAITED = "mjforage:awaited"
"""Kind of numba's events: begins and ends with waiting for a process that compiles."""
PATIENCE_S = 300.0
"""A kernel that another process has not compiled for so long is compiled here as well."""
_DAY_S = 86_400.0
_held: set[str] = set()  # kernels that this process compiles just now
_log = logging.getLogger(__name__)


def kernel_folder() -> Path | None:
    """The folder of compiled kernels; None where the user has no folder for caches."""
    if chosen := os.environ.get("NUMBA_CACHE_DIR"):
        return Path(chosen) / "mjforage"
    try:
        home = Path.home()
    except RuntimeError:  # a user without a home
        return None
    if sys.platform == "darwin":
        return home / "Library" / "Caches" / "mjforage"
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or home / "AppData" / "Local") / "mjforage"
    return Path(os.environ.get("XDG_CACHE_HOME") or home / ".cache") / "mjforage"


class KernelCache:
    """numba's interface of a cache, for one dispatcher."""

    def __init__(self, dispatcher: Any) -> None:
        self._dispatcher = dispatcher
        self.cache_path = str(kernel_folder() or "")

    def once(self, compile_it: Callable[[Any], Any]) -> Callable[[Any], Any]:
        """The dispatcher's way of compiling, of which one process at a time goes for a kernel."""

        def compiled(signature: Any) -> Any:
            with self._alone(signature):
                return compile_it(signature)

        return compiled

    @contextmanager
    def _alone(self, signature: Any) -> Iterator[None]:
        """Keep other processes from compiling the same; the system lets go with the process.

        Nothing is kept from them where the disk has the kernel, or has no locks.
        """
        folder, path = kernel_folder(), None
        new = signature not in self._dispatcher.overloads
        if folder is not None and new:
            path = folder / self._name(signature, self._dispatcher.targetctx.codegen())
        if new and (path is None or not path.is_file()):
            say_compiling(folder)
        if path is None or path.name in _held or path.is_file():
            yield
            return
        lock = FileLock(f"{path}.lock", timeout=PATIENCE_S)
        with suppress(OSError, NotImplementedError, Timeout), _waiting():
            lock.acquire()
        _held.add(path.name)
        try:
            yield
        finally:
            _held.discard(path.name)
            if lock.is_locked:
                with suppress(OSError):
                    Path(lock.lock_file).unlink()
            lock.release()

    def load_overload(self, signature: Any, context: Any) -> Any:
        """The compiled kernel for the types of its arguments; None if the disk has none."""
        context.refresh()
        folder = kernel_folder()
        if folder is None:
            return None
        name = self._name(signature, context.codegen())
        try:
            made = _files(folder)._load_data(name)
        except (OSError, EOFError):
            return None
        note_use(folder / name)
        return cast(Any, compiler).CompileResult._rebuild(context, *made)

    def save_overload(self, signature: Any, made: Any) -> None:
        """Store a compiled kernel, unless it holds addresses of this process."""
        if made.library.has_dynamic_globals or any(not one.can_cache for one in made.lifted):
            return
        folder = kernel_folder()
        try:
            if folder is None:
                raise OSError("this user has no home")
            folder.mkdir(parents=True, exist_ok=True)
            delete_unused(folder, "*.nbc*")
            name = self._name(signature, made.codegen)
            _files(folder)._save_data(name, made._reduce())
        except OSError as error:
            _say_once(str(folder or "~/.cache/mjforage"), error.strerror or str(error))

    def flush(self) -> None:
        """Other contents have other names: nothing is ever out of date."""

    def _name(self, signature: Any, codegen: Any) -> str:
        """Name of the file: the kernel's, and the hash of its content."""
        function = self._dispatcher.py_func
        settings = cast(Any, config)
        arguments = signature if isinstance(signature, tuple) else signature.args
        depends = (
            sys.version_info[:2],
            numba.__version__,
            (settings.OPT, settings.BOUNDSCHECK, settings.DEBUGINFO_DEFAULT),
            codegen.magic_tuple(),  # the processor
            *map(type_content, arguments),
            content(self._dispatcher),
        )
        digest = hashlib.sha256(repr(depends).encode()).hexdigest()[:32]
        return f"{function.__module__}.{function.__name__}-{digest}.nbc"


def _waiting() -> Any:
    return cast(Any, event).trigger_event(AWAITED)


def _files(folder: Path) -> Any:
    """Numba's reading and writing of files, whole or not at all."""
    return cast(Any, IndexDataCacheFile)(str(folder), "", None)


def note_use(path: Path) -> None:
    """Note on a file that it is still read, at most once a day."""
    with suppress(OSError):
        if time.time() - path.stat().st_mtime > _DAY_S:
            path.touch()


@cache
def delete_unused(folder: Path, pattern: str) -> None:
    """Delete, once in a process, files that have not been read for a long time."""
    for path in folder.glob(pattern):
        with suppress(OSError):
            if time.time() - path.stat().st_mtime > KEPT_DAYS * _DAY_S:
                path.unlink()


@cache
def _say_once(folder: str, why: str) -> None:
    _log.warning(
        "compiled kernels cannot be kept in %s (%s), so every process compiles them; "
        "set NUMBA_CACHE_DIR to a folder that you can write to",
        folder,
        why,
    )
