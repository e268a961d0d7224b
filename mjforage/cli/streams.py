"""Standard output and error of a command: a reader that stops reading them stops no run."""

import codecs
import errno
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, TextIO, cast

from mjforage.base.errors import UserError

_ASCII = "+- - - - ... x . deg ^2 ^3 u >= <= -> - |"
_PLAIN = dict(zip("±−–—…×·°²³µ≥≤→─│", _ASCII.split(), strict=True))
"""Letters of ours that an encoding may lack, in ASCII."""


def _spelt(error: UnicodeError) -> tuple[str, int]:
    """ASCII spelling of letters that an encoding lacks: an error handler of `codecs`."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    letters = error.object[error.start : error.end]
    words = (_PLAIN.get(c) or c.encode("ascii", "backslashreplace").decode() for c in letters)
    return "".join(words), error.end


codecs.register_error("mjforage", _spelt)


class _Stream:
    """A stream that is silent once its reader is gone, and says why it cannot be written."""

    def __init__(self, stream: TextIO, name: str) -> None:
        self._stream, self._name = stream, name

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        try:
            return self._stream.write(text)
        except OSError as error:
            self._lost(error)
        return len(text)

    def flush(self) -> None:
        try:
            self._stream.flush()
        except OSError as error:
            self._lost(error)

    def _lost(self, error: OSError) -> None:
        """Let go of what cannot be written, which Python would try once more at its end."""
        with suppress(OSError, ValueError):
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, self._stream.fileno())
            os.close(nowhere)
        windows_pipe = os.name == "nt" and error.errno == errno.EINVAL
        if self._name == "stderr" or isinstance(error, BrokenPipeError) or windows_pipe:
            return
        raise UserError(
            f"standard output: cannot be written ({error.strerror}); send it elsewhere"
        ) from error


@contextmanager
def forgiving_streams() -> Iterator[None]:
    """Write to streams that lack letters, readers or space within the block.

    A letter that the encoding lacks is spelt in ASCII; a reader that went, such as `head -1`, or a
    closed stream loses the words and nothing else.

    Raises
    ------
    UserError
        If standard output cannot be written for another reason.
    """
    before = sys.stdout, sys.stderr
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name) or Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="mjforage")
        setattr(sys, name, cast(TextIO, _Stream(stream, name)))
    try:
        yield
        sys.stdout.flush()
    finally:
        sys.stderr.flush()
        sys.stdout, sys.stderr = before
