"""Progress of a command: a bar on a terminal, elsewhere a line every ten seconds."""

import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import timedelta

from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    Task,
    TextColumn,
    TimeRemainingColumn,
)
from rich.text import Text

from mjforage.cli.console import errors

Report = Callable[[float, float], None]  # of how many are done, of how many
EVERY_S = 10.0
COMPILES = "compiling kernels, once for all runs of this kind"


class _SpentColumn(ProgressColumn):
    max_refresh = 0.5  # [s]

    def render(self, task: Task) -> Text:
        return Text(spent(task.elapsed or 0.0))


@contextmanager
def bar(words: str, unit: str) -> Iterator[Report]:
    """Show the share that is done.

    Parameters
    ----------
    words : name of the work, for example "evaluate"
    unit : counted unit, for example "episodes"

    Yields
    ------
    what is called with (done, total)
    """
    columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), _SpentColumn()
    progress = Progress(*columns, TimeRemainingColumn(), console=errors, transient=True)
    number = progress.add_task(unit, total=None)
    counted = ""

    def report(done: float, total: float) -> None:
        nonlocal counted
        counted = f"{done:,.0f} of {total:,.0f} {unit}, "
        progress.update(number, completed=done, total=total)

    with (
        progress
        if errors.is_interactive
        else _lines(lambda seconds: f"{words}: {counted}{spent(seconds)}")
    ):
        yield report


@contextmanager
def working(words: str) -> Iterator[None]:
    """Show that something of unknown length is being done."""
    with (
        errors.status(words)
        if errors.is_interactive
        else _lines(lambda seconds: f"{words}: {spent(seconds)}")
    ):
        yield


@contextmanager
def _lines(text: Callable[[float], str], every_s: float = EVERY_S) -> Iterator[None]:
    """Let a thread print a line every so many seconds, of how long the block has taken."""
    over, began = threading.Event(), time.monotonic()

    def tell() -> None:
        if hasattr(signal, "pthread_sigmask"):  # Ctrl-C is for the main thread, which may hold it
            signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        while not over.wait(every_s):
            errors.print(text(time.monotonic() - began), markup=False)

    thread = threading.Thread(target=tell, daemon=True, name="progress")
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()


def spent(seconds: float) -> str:
    """Time that the work has taken, and the reason if compilation delays it."""
    compiled = sys.modules.get("mjforage.base.compiled")  # numba is not loaded to find out
    compiles = f"{COMPILES}; " if compiled is not None and compiled.compiling() else ""
    return f"{compiles}{timedelta(seconds=round(seconds))} so far"
