"""Progress of a command in lines where there is no terminal."""

import re
import subprocess
import sys

import pytest

from mjforage.base import compiled
from mjforage.cli.progress import COMPILES, spent


def test_while_kernels_are_compiled_that_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiled, "compiling", lambda: False)
    assert spent(20.2) == "0:00:20 so far"
    monkeypatch.setattr(compiled, "compiling", lambda: True)
    assert spent(4000) == f"{COMPILES}; 1:06:40 so far"


def test_without_a_terminal_they_are_plain_lines_on_stderr() -> None:
    program = (
        "import time; from mjforage.cli import progress\n"
        "progress._lines.__wrapped__.__defaults__ = (0.05,)\n"
        "with progress.bar('evaluate', 'episodes') as shown:\n"
        "    shown(1, 4); time.sleep(0.5)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout == ""
    lines = r"(evaluate: (1 of 4 episodes, )?0:00:0\d so far\n)+"
    assert re.fullmatch(lines, done.stderr) and "1 of 4" in done.stderr
