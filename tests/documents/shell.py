"""Shell blocks, statement by statement, and what tests put for numbers that only cost time."""

import re
import shlex
from collections.abc import Iterator
from itertools import pairwise

MOST = {"--episodes": 2, "--jobs": 1, "--duration": 2}
"""Tests run a command with no more than this. Episodes and jobs change no command's meaning, and
numbers are the same whoever computes; a film of 2 s has all that a longer one has."""

SETTING_UP = ("pip ", "python3 -m venv", "make ")
"""A statement that begins so is about an environment, which tests have."""

_HERE = re.compile(r"<<'?(?P<end>\w+)'?$")
_OF_A_SHELL = re.compile(r"[|&;<>$`]")


def statements(text: str) -> Iterator[str]:
    """Yield the statements of a block, with continued lines and here-documents in one piece."""
    lines = iter(text.replace("\\\n", " ").splitlines())
    for line in lines:
        end = _HERE.search(line)
        if end is None:
            if line.strip() and not line.lstrip().startswith("#"):
                yield line.strip()
            continue
        held = [line]
        for inner in lines:
            held.append(inner)
            if inner == end["end"]:
                break
        yield "\n".join(held) + "\n"


def words(statement: str) -> list[str] | None:
    """Return the words of a statement that needs no shell, None of others.

    Comments at the end are left out.
    """
    found = shlex.split(statement, comments=True)
    plain = re.sub(r"'[^']*'|\"[^\"$`]*\"", "", statement).partition(" #")[0]
    return None if _OF_A_SHELL.search(plain) or "=" in found[0] else found


def smaller(command: list[str]) -> list[str]:
    """Return a command with its numbers cut to `MOST`."""
    cut = list(command)
    for at, (option, value) in enumerate(pairwise(command), start=1):
        if option in MOST and value.isdecimal():
            cut[at] = str(min(int(value), MOST[option]))
    return cut
