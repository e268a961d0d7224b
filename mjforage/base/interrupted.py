"""Ctrl-C for the command line: one line and exit code 130, also where Python would lose it.

While modules are imported, an interruption is swallowed by some libraries and made an `ImportError`
by others; there, and where Python itself would ignore it, the process ends at once. No file of ours
is ever half written in its place, and workers end with the process that asked.
"""

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import Any

CODE = 130  # of a shell: 128 and the number of the signal
WORDS = "interrupted; a run, study or training goes on when the same command is given again"

_IMPORTS = "<frozen importlib._bootstrap>"


@contextmanager
def ctrl_c_kept() -> Iterator[Callable[[], bool]]:
    """Keep every Ctrl-C within the block.

    Nothing changes in a thread beside the main one, or where the caller has a handler of its own.

    Yields
    ------
    Whether it has come, for an exception that something made of it.
    """
    came: list[int] = []
    if not _is_ours_to_handle():
        yield lambda: bool(came)
        return

    def stop(number: int, frame: FrameType | None) -> None:
        came.append(number)
        if _importing(frame):
            end_now(number, frame)
        raise KeyboardInterrupt

    def ignored(args: "sys.UnraisableHookArgs") -> None:
        if issubclass(args.exc_type, KeyboardInterrupt):
            end_now()
        before_hook(args)

    before_hook, before = sys.unraisablehook, signal.signal(signal.SIGINT, stop)
    sys.unraisablehook = ignored
    try:
        yield lambda: bool(came)
    finally:
        sys.unraisablehook = before_hook
        signal.signal(signal.SIGINT, before)


def end_on_ctrl_c() -> None:
    """End this process by Ctrl-C from now on, while there is nothing yet to tidy up."""
    if _is_ours_to_handle():
        signal.signal(signal.SIGINT, end_now)


def _is_ours_to_handle() -> bool:
    """True if Ctrl-C comes here and acts as in any Python."""
    main = threading.current_thread() is threading.main_thread()
    return main and signal.getsignal(signal.SIGINT) in (signal.default_int_handler, end_now)


def end_now(*_: Any) -> None:
    """End this process as interrupted, without a further word of Python's."""
    with suppress(OSError, ValueError):
        os.write(2, f"mjforage: {WORDS}\n".encode())
    os._exit(CODE)


def _importing(frame: FrameType | None) -> bool:
    """True if a module is being imported at this moment."""
    while frame is not None:
        if frame.f_code.co_filename == _IMPORTS:
            return True
        frame = frame.f_back
    return False
