"""A call that makes a run: its name for the folder, its warnings for the object."""

import logging
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from mjforage.base.called import called


class _Lines(logging.Handler):
    """Keeps the warnings of one thread."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.lines: list[str] = []
        self._thread = threading.get_ident()

    def emit(self, record: logging.LogRecord) -> None:
        if record.thread == self._thread and record.getMessage() not in self.lines:
            self.lines.append(record.getMessage())


@contextmanager
def call(name: str) -> Iterator[list[str]]:
    """Note a call of `mjforage.NAME`; yields the list of its warnings, which grows."""
    kept, logger = _Lines(), logging.getLogger("mjforage")
    logger.addHandler(kept)
    try:
        with called(f"made in Python (mjforage.{name})"):
            yield kept.lines
    finally:
        logger.removeHandler(kept)
