"""Running a command, and its errors: one line, and an exit code."""

import logging
import os
import shlex
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import cyclopts
from rich.logging import RichHandler

from mjforage.base.called import called
from mjforage.base.compile_notice import leave_unsaid
from mjforage.base.errors import UserError, printable
from mjforage.base.interrupted import CODE as INTERRUPTED
from mjforage.base.interrupted import WORDS
from mjforage.cli.commands import app
from mjforage.cli.console import errors

BAD_INPUT = 2  # exit code of every error that a user can mend


def run(arguments: Sequence[str] | None, interrupted: Callable[[], bool]) -> None:
    """Run the command line.

    Parameters
    ----------
    arguments : by default those of the process
    interrupted : True if Ctrl-C has come, whatever was made of it
    """
    _prepare_streams()
    leave_unsaid()  # `progress` shows it
    logging.basicConfig(
        level=logging.WARNING,
        format="%(message)s",
        handlers=[RichHandler(console=errors, show_time=False, show_path=False)],
    )
    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # it warns of its cache
    try:
        _carry_out(sys.argv[1:] if arguments is None else arguments)
    except KeyboardInterrupt:
        _end(WORDS, INTERRUPTED)
    except BaseException as error:
        if interrupted():
            _end(WORDS, INTERRUPTED)
        if isinstance(error, BrokenPipeError) or isinstance(error.__context__, BrokenPipeError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # Python flushes it
            sys.exit(1)
        words = _words(error, sys.argv[1:] if arguments is None else arguments)
        if not words:
            raise
        _end(words, BAD_INPUT)


def _prepare_streams() -> None:
    """Write nowhere where a stream is closed, and `?` for letters that its encoding lacks."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, Path(os.devnull).open("w", encoding="utf-8"))  # noqa: SIM115
        elif hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")


def _carry_out(arguments: Sequence[str]) -> None:
    for word in arguments:
        if any("\ud800" <= letter <= "\udfff" for letter in word):
            raise UserError(f"{word}: is not UTF-8; give names in UTF-8, of files as well")
    how: Any = {"exit_on_error": False, "print_error": False, "result_action": "return_value"}
    with called(shlex.join(["mjforage", *arguments])):
        app(arguments, **how)
    sys.stdout.flush()


def _words(error: BaseException, arguments: Sequence[str]) -> str:
    """Message of an error; "" of one that only a developer can mend."""
    if isinstance(error, UserError | cyclopts.CycloptsError):
        return str(error)
    if words := _of_an_extra(error, arguments) or _of_a_part(error):
        return words
    if isinstance(error, MemoryError):
        return f"not enough memory ({error}); give smaller options, or fewer episodes at once"
    if cause := _of_the_system(error):
        from mjforage.base.atomic_files import remedy

        where, reason = cause.filename or "a file", cause.strerror or str(cause)
        return f"{where}: {reason}; {remedy(cause)}"
    return ""


def _of_the_system(error: BaseException) -> OSError | None:
    """An error of a file that no command names, such as a cache, or the one behind an error."""
    if isinstance(error, OSError):
        return error
    before = error.__cause__ or error.__context__
    return _of_the_system(before) if before is not None else None


def _of_an_extra(error: BaseException, arguments: Sequence[str]) -> str:
    """Message about a package that only an extra installs."""
    if not isinstance(error, ModuleNotFoundError):
        return ""
    from mjforage.base.extras import extra_with, how_to_install

    name, command = error.name or "", "".join(arguments[:1])
    return f"{command}: needs {name}; {how_to_install(name)}" if extra_with(name) else ""


def _of_a_part(error: BaseException) -> str:
    """Message about an error in code that the user has brought, such as a policy."""
    extensions = sys.modules.get("mjforage.base.registry")
    return extensions.blamed(error) if extensions is not None else ""


def _end(words: str, code: int) -> None:
    """Print one line on standard error, and end."""
    line = printable(" ".join(words.split()))
    errors.print(f"mjforage: {line}", style="red", markup=False)
    sys.exit(code)
