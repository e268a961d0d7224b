"""Errors of somebody's own part, wherever raised, are one line with its name."""

from collections.abc import Callable
from pathlib import Path

import pytest

from mjforage.base.errors import UserError
from mjforage.base.registry import blamed, built

PARTS = """
import sys
import numpy as np
class Policy:
    def reset(self, task, keys): ...
    def act(self, observation): ...
class Key(Policy):
    def __init__(self): raise KeyError("a")
class Ends(Policy):
    def __init__(self): sys.exit(0)
class EndsInReset(Policy):
    def reset(self, task, keys): sys.exit(0)
class EndsInAct(Policy):
    def act(self, observation): sys.exit(0)
class Option(Policy):
    def __init__(self): raise ValueError("give more")
"""


@pytest.fixture
def parts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("parts_of_mine.py").write_text(PARTS)
    Path("ends_of_mine.py").write_text("import sys; sys.exit(0)")
    Path("fails_of_mine.py").write_text("raise RuntimeError('no luck')")
    monkeypatch.syspath_prepend(str(tmp_path))


@pytest.mark.usefixtures("parts")
@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("parts_of_mine:Key", "cannot be made, it raised KeyError: 'a' (parts_of_mine.py, line 8)"),
        ("parts_of_mine:Ends", "cannot be made, it raised SystemExit: 0 (parts_of_mine.py, line"),
        ("parts_of_mine:EndsInReset", "raised SystemExit: 0 (parts_of_mine.py, line 12); mend"),
        ("parts_of_mine:EndsInAct", "raised SystemExit: 0 (parts_of_mine.py, line 14); mend"),
        ("parts_of_mine:Option", "give more"),
        ("ends_of_mine:X", "module ends_of_mine ends the process; let it only define"),
        ("fails_of_mine:X", "module fails_of_mine cannot be imported (RuntimeError: no luck)"),
    ],
)
def test_a_policy_that_raises_or_ends(
    name: str, words: str, refused: Callable[..., str], tmp_path: Path
) -> None:
    run = ("--episodes", 1, "--set", "horizon=2", "--out", tmp_path / "run")
    said = refused("evaluate", "comb-port", "--policy", name, *run)
    assert said.startswith(f"mjforage: policy {name}: {words}")


def test_a_fault_of_ours_is_nobody_elses() -> None:
    def fail() -> None:
        raise KeyError("ours")

    fail.__module__ = "mjforage.some"
    with pytest.raises(KeyError) as caught:
        built("policy x", fail)
    assert blamed(caught.value) == ""
    fail.__module__ = "theirs"
    with pytest.raises(UserError, match="policy x: cannot be made, it raised KeyError: 'ours'"):
        built("policy x", fail)
