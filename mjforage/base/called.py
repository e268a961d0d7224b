"""Name of the call: a command, or a function of `import mjforage`. Run folders say it."""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

_CALLED: ContextVar[str] = ContextVar("called", default="")


def what_was_called() -> str:
    """The outermost call that is noted: a command, or words on Python."""
    return _CALLED.get() or "made in Python"


@contextmanager
def called(words: str) -> Iterator[None]:
    """Note a call for its duration, unless a noted one has made it."""
    token = _CALLED.set(_CALLED.get() or words)
    try:
        yield
    finally:
        _CALLED.reset(token)
