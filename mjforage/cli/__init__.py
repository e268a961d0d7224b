"""The command line: one function per command, thin over the library."""

import logging
import sys
from collections.abc import Sequence

import cyclopts
from rich.logging import RichHandler

from mjforage.cli import (  # they add their commands
    boarding,
    drawing,
    hulls,
    lists,
    run_folders,
    schemas,
    speeds,
    studying,
    train,
    validating,
)
from mjforage.cli.console import app, errors
from mjforage.core.errors import UserError, printable

__all__ = [
    "boarding",
    "drawing",
    "hulls",
    "lists",
    "main",
    "run_folders",
    "schemas",
    "speeds",
    "studying",
    "train",
    "validating",
]

BAD_INPUT = 2  # exit code of every error that a user can mend, an interruption included


def main(arguments: Sequence[str] | None = None) -> None:
    """Entry point: one clear line and exit code 2 for everything that a user can mend."""
    logging.basicConfig(
        level=logging.WARNING,
        format="%(message)s",
        handlers=[RichHandler(console=errors, show_time=False, show_path=False)],
    )
    arguments = sys.argv[1:] if arguments is None else arguments
    try:
        for word in arguments:
            if any("\ud800" <= letter <= "\udfff" for letter in word):
                raise UserError(f"{word}: is not UTF-8; give names in UTF-8, of files as well")
        app(arguments, exit_on_error=False, print_error=False)
    except (UserError, cyclopts.CycloptsError) as error:
        _say(str(error))
        sys.exit(BAD_INPUT)
    except MemoryError as error:
        _say(f"not enough memory ({error}); give smaller options, or fewer episodes at once")
        sys.exit(BAD_INPUT)
    except OSError as error:  # of a file that is nobody's in particular, such as a compiler's cache
        where, reason = error.filename or "a file", error.strerror or str(error)
        _say(
            f"{where}: {reason}; free some space or mend its permissions, then run the same "
            "command again"
        )
        sys.exit(BAD_INPUT)
    except KeyboardInterrupt:
        _say("interrupted; finished work is kept, run the same command again to resume")
        sys.exit(BAD_INPUT)


def _say(words: str) -> None:
    """One line on standard error."""
    line = printable(" ".join(words.split()))
    errors.print(f"mjforage: {line}", style="red", markup=False)
