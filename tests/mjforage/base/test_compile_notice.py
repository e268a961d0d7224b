"""What a user is told before kernels are compiled, in processes of their own."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = """
from mjforage.base.compiled import kernel
@kernel
def one(x):
    return x + 1
@kernel
def two(x):
    return one(x) + 1
print(two(1), one(1.5), flush=True)
"""
LINE = "mjforage compiles its kernels for this processor"
LISTENING = {
    "nobody": ("", True),
    "as a library": ("import mjforage\n", True),
    "warnings only": ("import logging; logging.basicConfig()\n", True),
    "a level alone": ("import logging, mjforage; logging.getLogger().setLevel('INFO')\n", True),
    "a handler of warnings": (
        "import logging; handler = logging.StreamHandler(); handler.setLevel('WARNING')\n"
        "logging.basicConfig(level='INFO', handlers=[handler])\n",
        True,
    ),
    "all": ("import logging; logging.basicConfig(level='INFO')\n", False),
    "a handler of ours": (
        "import logging, mjforage\n"
        "logger = logging.getLogger('mjforage')\n"
        "logger.setLevel('INFO'); logger.addHandler(logging.StreamHandler())\n",
        False,
    ),
}


def said(before: str, cache: Path, **more: str) -> list[str]:
    """Lines on standard error of a process that uses kernels."""
    done = subprocess.run(
        [sys.executable, "-c", before + PROGRAM],
        env=os.environ | {"NUMBA_CACHE_DIR": str(cache), "MJFORAGE_COMPILING_SAID": "", **more},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.split() == ["3", "2.5"]
    return [line for line in done.stderr.splitlines() if LINE in line]


@pytest.mark.parametrize("who", LISTENING)
def test_it_is_said_once_with_the_folder_and_only_where_something_is_compiled(
    who: str, tmp_path: Path
) -> None:
    before, warned = LISTENING[who]
    (line,) = said(before, tmp_path)
    assert ("UserWarning" in line) == warned
    assert f"kept in {tmp_path / 'mjforage'}" in line
    assert "`mjforage compile` does it beforehand" in line
    assert said(before, tmp_path) == [], "the disk has them"


def test_processes_of_one_that_has_said_it_are_silent(tmp_path: Path) -> None:
    assert said("", tmp_path, MJFORAGE_COMPILING_SAID="1") == []
