"""Handling of Ctrl-C, and of messages of worker processes that are stopped or replaced."""

import logging
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing import resource_tracker

from joblib.externals.loky.backend import resource_tracker as worker_tracker

_REPLACED = "A worker stopped while some jobs were given to the executor"
_NO_WARNING = "ignore:resource_tracker:UserWarning"


@contextmanager
def interrupts_held() -> Iterator[None]:
    """Hold Ctrl-C back; processes that start meanwhile never get it (the parent ends them)."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    resource_tracker.ensure_running()  # to start it among the workers would undo the next line
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def stop_noted(words: str) -> Iterator[Callable[[], bool]]:
    """Context that notes the first Ctrl-C, or a scheduler's SIGTERM; the next stops at once.

    `words`: warning that is logged when it comes.

    Yields
    ------
    Whether it has come; in a thread beside the main one, which gets no signals, never.
    """
    noted: list[int] = []
    if threading.current_thread() is not threading.main_thread():
        yield lambda: False
        return

    def note(number: int, frame: object) -> None:
        if noted:
            raise KeyboardInterrupt
        noted.append(number)
        logging.getLogger(__name__).warning(words)

    before = {number: signal.signal(number, note) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield lambda: bool(noted)
    finally:
        for number, handler in before.items():
            signal.signal(number, handler or signal.SIG_DFL)


def start_quiet_tracker() -> None:
    """Start the process that cleans up after killed workers, without its warnings.

    It would say that a folder was gone already, depending on the order of removal.
    """
    sys.warnoptions.append(_NO_WARNING)  # which a new interpreter inherits
    try:
        worker_tracker.ensure_running()
    finally:
        sys.warnoptions.remove(_NO_WARNING)


def suppress_replaced_workers() -> None:
    """Drop the warning that a worker made way for a new one.

    loky takes a worker that has grown by 300 MB since its first task for a leaking one. Ours grow
    when a chunk of `belief` or of a network follows one of `greedy`; that loses no work, and a new
    worker takes seconds to start.
    """
    warnings.filterwarnings("ignore", _REPLACED, UserWarning)


@contextmanager
def suppress_stopping_errors() -> Iterator[None]:
    """Drop the error of the thread that hands out work, raised while its workers are killed.

    Its loop forgets all work on the way out, then looks up what was not yet handed out: a
    `KeyError` in loky 3.6, whose traceback would follow our line.
    """
    before = threading.excepthook

    def tell(error: threading.ExceptHookArgs) -> None:
        managing = error.thread is not None and error.thread.name == "ExecutorManagerThread"
        if not (managing and issubclass(error.exc_type, KeyError)):
            before(error)

    threading.excepthook = tell
    try:
        yield
    finally:
        threading.excepthook = before
