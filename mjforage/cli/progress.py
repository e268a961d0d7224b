"""Progress of a command: a bar on a terminal, elsewhere a line every ten seconds."""

import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    Task,
    TextColumn,
)
from rich.text import Text

from mjforage.cli.console import errors

Report = Callable[[float, float], None]  # of how many are done, of how many
EVERY_S = 10.0
MINUTE_S, HOUR_S = 60.0, 3600.0
COMPILES = "compiling kernels, once for all runs of this kind"


class _EndColumn(ProgressColumn):
    max_refresh = 0.5  # [s]

    def render(self, task: Task) -> Text:
        return Text(_end(task))


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
    columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), _EndColumn()
    shown = errors.is_interactive
    progress = Progress(*columns, console=errors, transient=True)
    report, task = reporting(progress, unit)
    with progress if shown else _lines(lambda _: line(words, task)):
        yield report


def reporting(progress: Progress, unit: str) -> tuple[Report, Task]:
    """A new task, and a function that notes its progress; the first part gives no pace."""
    number = progress.add_task(unit, total=None)
    task = progress.tasks[-1]

    def report(done: float, total: float) -> None:
        if task.total is None:
            task.fields["first"] = done, progress.get_time()
        progress.update(number, completed=done, total=total)

    return report, task


@contextmanager
def working(words: str) -> Iterator[None]:
    """Show that something of unknown length is being done."""
    with (
        errors.status(words)
        if errors.is_interactive
        else _lines(lambda spent: f"{words}: {duration(spent)} so far")
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


def line(words: str, task: Task) -> str:
    """Progress of a task, in one line."""
    if not task.total:
        return f"{words}: {_end(task)}"
    digits = 0 if float(task.total).is_integer() else 1  # of a minute
    counted = f"{task.completed:,.{digits}f} of {task.total:,.{digits}f} {task.description}"
    return f"{words}: {counted}, {int(task.percentage)} %, {_end(task)}"


def _end(task: Task) -> str:
    """Time left, or time spent where that is unknown."""
    compiled = sys.modules.get("mjforage.base.compiled")  # numba is not loaded to find out
    spent = f"{duration(task.elapsed or 0.0)} so far"
    if compiled is not None and compiled.compiling():
        return f"{COMPILES}; {spent}"
    before, since = task.fields.get("first", (0.0, 0.0))
    if not task.total or not before < task.completed < task.total:
        return spent
    pace = (task.get_time() - since) / (task.completed - before)
    return f"about {duration(pace * (task.total - task.completed))} left"


def duration(seconds: float) -> str:
    """A time as one says it: to 10 s, then to minutes, then to tenths of hours."""
    if seconds < 1.5 * MINUTE_S:
        return f"{max(10, 10 * round(seconds / 10))} s"
    if seconds < 1.5 * HOUR_S:
        return f"{round(seconds / MINUTE_S)} min"
    return f"{seconds / HOUR_S:.1f} h"
