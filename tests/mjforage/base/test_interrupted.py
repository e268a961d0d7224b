"""Ctrl-C at any time is one line and exit code 130."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from mjforage.base.interrupted import WORDS

LINE = f"mjforage: {WORDS}\n"
pytestmark = pytest.mark.skipif(os.name != "posix", reason="needs signals")

# Sends Ctrl-C when a module is looked for, as somebody would who is tired of waiting.
WHEN_IMPORTING = """
import os, runpy, signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
class Tired:
    def find_spec(self, name, path=None, target=None):
        if name == {module!r}:
            os.kill(os.getpid(), signal.SIGINT)
        return None
sys.meta_path.insert(0, Tired())
{swallow}
sys.argv[0] = "mjforage"
from mjforage.cli import main
main({words!r})
"""
SWALLOW = """
import importlib
really = importlib.import_module
def swallowing(*arguments, **named):
    try:
        return really(*arguments, **named)
    except BaseException as error:
        raise ImportError("cannot be imported") from None
importlib.import_module = swallowing
"""


@pytest.mark.parametrize("swallow", ["", SWALLOW])
@pytest.mark.parametrize("module", ["gymnasium", "cyclopts", "polars", "numba", "mujoco"])
def test_while_modules_are_imported(module: str, swallow: str, tmp_path: Path) -> None:
    words = ["evaluate", "--policy", "greedy", "--episodes", "1", "--out", str(tmp_path / "run")]
    words += ["--world", "physics"]
    program = WHEN_IMPORTING.format(module=module, words=words, swallow=swallow)
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (130, LINE)
    assert not (tmp_path / "run").exists()


MADE = {
    "raised": "raise KeyboardInterrupt",
    "made of it": "os.kill(os.getpid(), signal.SIGINT)",
    "ignored": "Ignoring()",
}
PROGRAM = """
import os, signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
class Ignoring:
    def __del__(self):
        os.kill(os.getpid(), signal.SIGINT)
        for _ in range(100): pass
from mjforage.scenario import scenario_file
def stop():
    try:
        {how}
        for _ in range(100): pass
    except KeyboardInterrupt:
        {then}
    return []
scenario_file.preset_names = stop
from mjforage.cli import main
main(["scenarios"])
"""


@pytest.mark.parametrize(
    ("how", "then"),
    [
        ("raised", "raise"),
        ("made of it", "raise"),
        ("made of it", "raise RuntimeError('a library failed') from None"),
        ("made of it", "sys.exit(0)"),
        ("ignored", "raise"),
    ],
)
def test_whatever_a_library_makes_of_it(how: str, then: str) -> None:
    program = PROGRAM.format(how=MADE[how], then=then)
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout) == (130, "")
    assert done.stderr == LINE


def test_a_handler_of_the_caller_stays(monkeypatch: pytest.MonkeyPatch) -> None:
    from mjforage.cli import main

    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        main(["vessels"])
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
        signal.signal(signal.SIGINT, signal.default_int_handler)
        main(["vessels"])
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, before)
