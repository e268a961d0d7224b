"""How far the chunks are that are being played just now, and whether kernels are compiled for them.

Whoever plays a chunk tells it in a small file of the run folder: workers may be other processes or
machines, which share that folder and nothing else. Nothing that is simulated hangs on it.
"""

import json
import shutil
import time
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any, NamedTuple

from numba.core import event

from mjforage.base.kernel_cache import AWAITED
from mjforage.mission.mission import Mission, Observer

EVERY_S = 1.0
_folders: list[Path] = []  # of the chunks that this process waits for


class UnderWay(NamedTuple):
    """What is being done now."""

    compiles: bool
    """Whether somebody compiles, or waits for somebody who does."""
    episodes: float
    """Episodes' worth of the steps made; those of finished chunks are no part of it."""


class Teller(Observer, event.Listener):
    """Tells how far a chunk is, as an observer of its mission and a listener of numba."""

    def __init__(self, file: Path, episodes: int, horizon: int) -> None:
        self._file, self._share = file, episodes / horizon
        self._steps, self._depth, self._told_at = -1, 0, 0.0

    def see(self, mission: Mission) -> None:
        """Count a step; the first look is at the state before any."""
        self._steps += 1
        if time.monotonic() - self._told_at > EVERY_S:
            self.tell()

    def on_start(self, event: event.Event) -> None:
        """Somebody begins to compile, or waits for it; a kernel compiles those that it calls."""
        self._depth += 1
        if self._depth == 1:
            self.tell()

    def on_end(self, event: event.Event) -> None:
        """The same is over."""
        self._depth -= 1
        if self._depth == 0:
            self.tell()

    def tell(self, episodes: float | None = None) -> None:
        """Write down how far it is; a disk that takes no more is told by what has to be on it."""
        self._told_at = time.monotonic()
        done = max(0, self._steps) * self._share if episodes is None else episodes
        with suppress(OSError):
            self._file.write_text(json.dumps([self._depth > 0, done]), "utf-8")


@contextmanager
def telling(file: Path, episodes: int, horizon: int) -> Iterator[Teller]:
    """Tell of a chunk while it is played, and in the end that it is; `forget` then drops it.

    Parameters
    ----------
    file : of the chunk, in a folder that is made if it is missing
    episodes, horizon : of the chunk
    """
    teller = Teller(file, episodes, horizon)
    with suppress(OSError):
        file.parent.mkdir(parents=True, exist_ok=True)
    listening: Any = event.install_listener
    with ExitStack() as stack:
        for kind in ("numba:compile", AWAITED):
            stack.enter_context(listening(kind, teller))
        yield teller
        teller.tell(episodes)


def forget(file: Path) -> None:
    """Drop what was told of a chunk, which is counted by now."""
    with suppress(OSError):
        file.unlink(missing_ok=True)


@contextmanager
def waiting(folders: Iterable[Path]) -> Iterator[None]:
    """Let `under_way` look into these folders, emptied of what killed processes left there."""
    added = list(folders)
    for folder in added:
        shutil.rmtree(folder, ignore_errors=True)
    _folders.extend(added)
    try:
        yield
    finally:
        for folder in added:
            _folders.remove(folder)


def under_way() -> UnderWay:
    """What is being done in all chunks that this process waits for."""
    told = [_read(file) for folder in _folders for file in folder.glob("*")]
    return UnderWay(any(one.compiles for one in told), sum(one.episodes for one in told))


def _read(file: Path) -> UnderWay:
    with suppress(OSError, ValueError, TypeError):
        compiles, episodes = json.loads(file.read_text("utf-8"))
        return UnderWay(bool(compiles), float(episodes))
    return UnderWay(False, 0.0)  # just being written, or gone
