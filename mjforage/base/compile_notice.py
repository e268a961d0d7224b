"""Notice of the first minute: one line before the first kernel of a process is compiled."""

import logging
import os
import warnings
from pathlib import Path

SAID = "MJFORAGE_COMPILING_SAID"
"""Environment variable that is set once it was said, so that processes started later are silent."""
_log = logging.getLogger(__name__)


def leave_unsaid() -> None:
    """Say nothing in this process, which shows it itself, and in those that it starts."""
    os.environ[SAID] = "1"


def say_compiling(folder: Path | None) -> None:
    """Say once that kernels are compiled: a line of the log, or a warning where nobody reads it.

    `folder`: where they are kept, if anywhere.
    """
    if os.environ.get(SAID):
        return
    os.environ[SAID] = "1"
    kept = f"they are kept in {folder}" if folder is not None else "they are not kept"
    line = (
        "mjforage compiles its kernels for this processor, which takes up to two minutes the "
        f"first time; {kept}; `mjforage compile` does it beforehand"
    )
    if _is_read(logging.INFO):
        _log.info("%s", line)
    else:
        warnings.warn_explicit(line, UserWarning, __name__, 1)  # no line of numba's


def _is_read(level: int) -> bool:
    """True if a handler takes lines of our log of that level."""
    logger: logging.Logger | None = _log
    if not _log.isEnabledFor(level):
        return False
    while logger is not None:
        for handler in logger.handlers:
            if handler.level <= level and not isinstance(handler, logging.NullHandler):
                return True
        logger = logger.parent if logger.propagate else None
    return False
