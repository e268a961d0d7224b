"""How far a command has come, where no terminal shows a bar: a line every ten seconds."""

import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

EVERY_S = 10.0
MINUTE_S, HOUR_S = 60.0, 3600.0

COMPILES = "compiles kernels, once for all runs of this kind"

Clock = Callable[[], float]  # seconds from anywhere
Say = Callable[[str], None]


def compiling() -> bool:
    """Whether kernels are being compiled in this process, without loading numba to find out."""
    loaded = sys.modules.get("mjforage.base.compiled")
    return loaded is not None and loaded.compiling()


class Lines:
    """Says how much is done and how long the rest will take, at the pace since the first report.

    What was done before that report, by a call that was stopped, does not count for the pace.
    """

    def __init__(
        self,
        words: str,
        unit: str,
        say: Say,
        clock: Clock = time.monotonic,
        compiles: Callable[[], bool] = compiling,
    ) -> None:
        """Prepare.

        Parameters
        ----------
        words : what works, for example "evaluate"
        unit : what is counted, for example "episodes"; empty: nothing is
        say : writes a line
        compiles : whether kernels are being compiled, which tells nothing of the pace
        """
        self._words, self._unit, self._say, self._clock = words, unit, say, clock
        self._began, self._compiles = clock(), compiles
        self._first: tuple[float, float] | None = None  # when it was reported, and how much
        self._last = (self._began, 0.0, 0.0)  # when, done, of how many

    def __call__(self, done: float, total: float) -> None:
        """Note that `done` of `total` are finished."""
        now = self._clock()
        self._first = self._first or (now, done)
        self._last = (now, done, total)

    def tell(self) -> None:
        """Say where it stands."""
        when, done, total = self._last
        spent = f"{duration(self._clock() - self._began)} so far"
        compiles = self._compiles()
        if compiles:
            spent = f"{COMPILES}; {spent}"
        if self._first is None or not total:
            self._say(f"{self._words}: {spent}")
            return
        digits = 0 if float(total).is_integer() else 1  # of a minute
        counted = f"{done:,.{digits}f} of {total:,.{digits}f} {self._unit}"
        counted += f", {min(100, int(100 * done / total))} %"  # rounds may end beyond the end
        left = None if compiles else self._left(*self._first, when, done, total)
        end = spent if left is None else f"about {duration(left)} left"
        self._say(f"{self._words}: {counted}, {end}")

    def _left(
        self, began: float, before: float, when: float, done: float, total: float
    ) -> float | None:
        """Seconds to the end; None while there is nothing to tell it from, all is finished, or it
        should long be over.
        """
        if done <= before or done >= total:
            return None
        pace = (when - began) / (done - before)
        left = pace * (total - done) - (self._clock() - when)
        return left if left > 0.0 else None


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
        while not over.wait(every_s):
            lines.tell()

    thread = threading.Thread(target=tell, daemon=True, name="progress")
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()
