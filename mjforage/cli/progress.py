"""How far a command has come, where no terminal shows a bar: a line every ten seconds."""

import itertools
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

EVERY_S, LOOK_S = 10.0, 1.0
WINDOW_S, SOON_S = 60.0, 10.0
MINUTE_S, HOUR_S = 60.0, 3600.0

COMPILES, KEPT = "compiling kernels", ", once for all runs of this kind"

Clock = Callable[[], float]  # seconds from anywhere
Say = Callable[[str], None]


def under_way() -> tuple[bool, float]:
    """Whether kernels are compiled for this process, by itself or by its workers, and how much of
    what is counted lies in work that is not finished; without loading numba to find out.
    """
    here, workers = (
        sys.modules.get(f"mjforage.{name}") for name in ("base.compiled", "runs.under_way")
    )
    compiles, counted = workers.under_way() if workers else (False, 0.0)
    return compiles or bool(here and here.compiling()), counted


class Pace:
    """Foretells the end of work from what was done of it in the last minute, or since the last
    progress if that is longer ago; what came before kernels were compiled tells nothing.
    """

    def __init__(self) -> None:
        self._seen: list[tuple[float, float]] = []  # time and how much was done
        self._soon: float | None = None  # since when the end is near

    def look(self, now: float, done: float, compiles: bool = False) -> None:
        """Note how much is done at a time."""
        if compiles:
            self._seen.clear()
        elif not self._seen or done != self._seen[-1][1]:
            self._seen.append((now, done))
        while len(self._seen) > 2 and self._seen[1][0] <= now - WINDOW_S:
            self._seen.pop(0)

    def left(self, now: float, total: float) -> float | None:
        """Seconds to the end; None while there is nothing to tell it from, when all is done, and
        once it was near for longer than foretold.
        """
        (began, before), (_, done) = (self._seen[0], self._seen[-1]) if self._seen else 2 * [(0, 0)]
        if not before < done < total:
            self._soon = None
            return None
        left = (now - began) / (done - before) * (total - done)
        self._soon = (self._soon or now) if left <= SOON_S else None
        return None if self._soon is not None and now - self._soon > SOON_S else left


class Lines:
    """Says how much is done and how long the rest will take, at the pace of late.

    What an earlier call did, which was stopped, does not count for the pace.
    """

    def __init__(
        self,
        words: str,
        unit: str,
        say: Say,
        clock: Clock = time.monotonic,
        under_way: Callable[[], tuple[bool, float]] = under_way,
    ) -> None:
        """Prepare.

        Parameters
        ----------
        words : what works, for example "evaluate"
        unit : what is counted, for example "episodes"; empty: nothing is
        say : writes a line
        under_way : whether kernels are being compiled, which tells nothing of the pace, and how
            much is being done beside what is finished
        """
        self._words, self._unit, self._say, self._clock = words, unit, say, clock
        self._began, self._under_way, self._compiles = clock(), under_way, False
        self._pace, self._done, self._total = Pace(), 0.0, 0.0
        self._alone = threading.RLock()  # work reports in one thread, another one tells

    def __call__(self, done: float, total: float) -> None:
        """Note that `done` of `total` are finished."""
        self._done, self._total = done, total
        self.look()

    def look(self) -> None:
        """Note what is being done now."""
        with self._alone:
            self._compiles, counted = self._under_way()
            if self._total:
                self._pace.look(self._clock(), self._done + counted, self._compiles)

    def tell(self) -> None:
        """Say where it stands."""
        end = self.end()
        if not self._total:
            self._say(f"{self._words}: {end}")
            return
        done, total = self._done, self._total
        digits = 0 if float(total).is_integer() else 1  # of a minute
        counted = f"{done:,.{digits}f} of {total:,.{digits}f} {self._unit}"
        share = min(100, int(100 * done / total))  # rounds may end beyond the end
        self._say(f"{self._words}: {counted}, {share} %, {end}")

    def end(self) -> str:
        """How long it will take; how long it has taken where that cannot be told."""
        with self._alone:
            self.look()
            now = self._clock()
            left = self._pace.left(now, self._total)
        spent = f"{duration(now - self._began)} so far"
        if self._compiles:
            return f"{COMPILES}{KEPT if _are_kept() else ''}; {spent}"
        return spent if left is None else f"about {duration(left)} left"


def _are_kept() -> bool:
    """Whether what is compiled lasts; the library that compiles is not loaded to find out."""
    cache = sys.modules.get("mjforage.base.kernel_cache")
    return cache is None or cache.kernels_are_kept()


def duration(seconds: float) -> str:
    """A time as one says it: to 10 s, then to minutes, then to tenths of hours."""
    if seconds < 1.5 * MINUTE_S:
        return f"{max(10, 10 * round(seconds / 10))} s"
    if seconds < 1.5 * HOUR_S:
        return f"{round(seconds / MINUTE_S)} min"
    return f"{seconds / HOUR_S:.1f} h"


@contextmanager
def told(lines: Lines, every_s: float = EVERY_S) -> Iterator[None]:
    """Let a thread say where the block stands, every so many seconds."""
    over = threading.Event()

    def tell() -> None:
        if hasattr(signal, "pthread_sigmask"):  # Ctrl-C is for the main thread, which may hold it
            signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        for look in itertools.count(1):
            if over.wait(min(LOOK_S, every_s)):
                return
            lines.look()
            if look % max(1, round(every_s / LOOK_S)) == 0:
                lines.tell()

    thread = threading.Thread(target=tell, daemon=True, name="progress")
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()
