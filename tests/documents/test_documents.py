"""Every block of README.md and docs/ runs outside of the checkout, with fewer episodes."""

import importlib
import importlib.util
import re
import runpy
import shlex
import subprocess
import sys
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from mjforage.cli.commands import app
from tests.documents.__main__ import environment
from tests.documents.blocks import LANGUAGES, SHELL, Block, blocks, pages

ALL = [block for page in pages() for block in blocks(page)]
COMMANDS = [block for block in ALL if block.language == SHELL]
LIBRARIES = {
    "my_ppo": "stable_baselines3",
    "my_torchrl": "tensordict",
    **{name: name for name in ("sb3_contrib", "stable_baselines3", "torchrl")},
}
"""What a block names -> what it needs and an installation may lack."""
MOST = {"--episodes": 2, "--jobs": 1, "--duration": 2}
"""No command is run with more than this. Episodes and jobs change no command's meaning, and
numbers are the same whoever computes; a film of 2 s has all that a longer one has."""
FEWER = {"DECISIONS": 1024, "EPISODES": 1, "duration_s": 2, "n_steps": 128}
"""Constants and arguments of Python blocks, `DECISIONS = 200_000`: no block trains, plays or films
more."""
SETTING_UP = ("pip ", "python3 -m venv", "make ")
"""A statement that begins so is about an environment, which tests have."""

_NUMBER = re.compile(rf"(^(?:{'|'.join(FEWER)}) = |\b(?:duration_s|n_steps)=)([\d_]+)", re.M)
_OF_A_SHELL = re.compile(r"[|&;<>$`]")


def statements(text: str) -> Iterator[str]:
    """Yield the statements of a block, with continued lines and here-documents in one piece."""
    lines = iter(text.replace("\\\n", " ").splitlines())
    for line in lines:
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        if here := re.search(r"<<'(\w+)'$", line):
            line = "\n".join([line, *iter(lines.__next__, here[1]), here[1], ""])
        yield line


def words(statement: str) -> list[str]:
    """Return the words of a statement that needs no shell, none of others; no comment."""
    plain = re.sub(r"'[^']*'|\"[^\"$`]*\"", "", statement).partition(" #")[0]
    if _OF_A_SHELL.search(plain) or "=" in plain.split()[0]:
        return []
    return shlex.split(statement, comments=True)


def smaller(command: list[str]) -> list[str]:
    """Return a command with its numbers cut to `MOST`."""
    cut = list(command)
    for at, (option, value) in enumerate(pairwise(command), start=1):
        if option in MOST and value.isdecimal():
            cut[at] = str(min(int(value), MOST[option]))
    return cut


def shorter(script: str) -> str:
    """Return a script with its constants cut to `FEWER`."""
    return _NUMBER.sub(lambda at: f"{at[1]}{min(int(at[2]), FEWER[at[1].strip(' =')])}", script)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """An empty folder to work in, whose modules are forgotten afterwards.

    No figure is drawn, which takes seconds: tests of reports do.
    """
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("mjforage.view.report.draw_figures", lambda logs: [])
    monkeypatch.setattr("sys.path", list(sys.path))
    known = set(sys.modules)
    yield tmp_path
    for name in set(sys.modules) - known:
        origin = getattr(sys.modules[name], "__file__", None)
        if origin and Path(origin).is_relative_to(tmp_path):
            del sys.modules[name]


def missing(text: str) -> bool:
    """True if a block needs a library that is not here."""
    needed = [library for module, library in LIBRARIES.items() if module in text]
    return any(importlib.util.find_spec(library) is None for library in needed)


def run_statement(statement: str, env: dict[str, str], command: Callable[..., Any]) -> None:
    """Run a statement, ours and Python's in this process."""
    match words(statement):
        case ["mjforage", *rest]:
            done = command(*smaller(rest))
            assert done.code == 0, (statement, done)
        case ["python", file] if file.endswith(".py"):
            runpy.run_path(file, run_name="__main__")
        case _:
            subprocess.run(["bash", "-euo", "pipefail", "-c", statement], env=env, check=True)


def run_python(block: Block, folder: Path, names: dict[str, Any]) -> None:
    """Import a block that is a module, with its tests; run any other, by the names so far."""
    if block.file is None:
        script = folder / f"block_{block.line}.py"
        script.write_text(shorter(block.text))
        found = runpy.run_path(str(script), init_globals=names, run_name="__main__")
        names |= {name: value for name, value in found.items() if not name.startswith("__")}
        return
    sys.path.append(str(folder))
    module = importlib.import_module(block.file.removesuffix(".py"))
    sys.path.remove(str(folder))
    for test in [value for name, value in vars(module).items() if name.startswith("test_")]:
        test()


@pytest.mark.filterwarnings("ignore:PettingZoo in TorchRL", "ignore:Creating .*WeightUpdater")
@pytest.mark.parametrize("page", [p for p in pages() if any(not b.mark for b in blocks(p))])
def test_every_block_runs(page: str, folder: Path, command: Callable[..., Any]) -> None:
    env, names = environment(folder), dict[str, Any]()
    for block in blocks(page):
        if block.file and block.language != SHELL:
            (folder / block.file).write_text(block.text)
        if block.mark or missing(block.text):
            continue
        if block.language == "python":
            run_python(block, folder, names)
        elif block.language == SHELL:
            for statement in statements(block.text):
                if not statement.startswith(SETTING_UP):
                    run_statement(statement, env, command)


def test_constants_are_cut() -> None:
    text = "DECISIONS = 200_000  # of one agent\nEPISODES = 1\nMORE = 3\nx = DECISIONS = 7\n"
    text += "run.film(duration_s=100.0, fps=5)\n"
    assert shorter(text) == text.replace("200_000", "1024").replace("100", "2")


@pytest.mark.parametrize("block", COMMANDS, ids=str)
def test_every_command_has_its_options(block: Block) -> None:
    """Also of blocks that are long or not run."""
    for statement in statements(block.text):
        match words(statement):
            case ["mjforage", *rest]:
                app.parse_args(rest, exit_on_error=False, print_error=False)


def test_every_fence_has_a_language_that_is_known() -> None:
    others = [block for block in ALL if not block.language.startswith("{")]  # of Sphinx
    assert [str(block) for block in others if block.language not in LANGUAGES] == []
