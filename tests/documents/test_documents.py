"""Every block of README.md and docs/ runs outside of the checkout, with fewer episodes."""

import importlib
import importlib.util
import re
import runpy
import subprocess
import sys
import tomllib
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from mjforage.cli.commands import app
from mjforage.graph_planner.policies.registry import POLICIES
from tests.documents.__main__ import surroundings
from tests.documents.blocks import LANGUAGES, REPOSITORY, SHELL, Block, blocks, pages
from tests.documents.shell import SETTING_UP, smaller, statements, words

ALL = [block for page in pages() for block in blocks(page)]
COMMANDS = [block for block in ALL if block.language == SHELL]
LIBRARIES = {"my_ppo": "stable_baselines3", "my_torchrl": "tensordict"}
"""A module of a page -> what it needs and an installation may lack."""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """An empty folder to work in, whose modules are forgotten afterwards.

    No figure is drawn, which takes seconds: tests of reports do.
    """
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("mjforage.view.report.draw_figures", lambda logs: [])
    path, known = list(sys.path), set(sys.modules)
    yield tmp_path
    sys.path[:] = path
    for name in set(sys.modules) - known:
        origin = getattr(sys.modules[name], "__file__", None)
        if origin and Path(origin).is_relative_to(tmp_path):
            del sys.modules[name]


def missing(text: str) -> bool:
    """Whether a block needs a library that is not here."""
    needed = [library for module, library in LIBRARIES.items() if module in text]
    return any(importlib.util.find_spec(library) is None for library in needed)


def run_statement(statement: str, told: dict[str, str], command: Callable[..., Any]) -> None:
    """Run a statement, ours and Python's in this process."""
    plain = words(statement)
    if plain and plain[0] == "mjforage":
        done = command(*smaller(plain[1:]))
        assert done.code == 0, (statement, done)
    elif plain and plain[0] == "python" and plain[1].endswith(".py"):
        runpy.run_path(plain[1], run_name="__main__")
    else:
        subprocess.run(["bash", "-euo", "pipefail", "-c", statement], env=told, check=True)


def run_python(block: Block, folder: Path) -> None:
    """Import a block that is a module, with its tests; run any other."""
    if block.file is None:
        script = folder / f"block_{block.line}.py"
        script.write_text(block.text)
        runpy.run_path(str(script), run_name="__main__")
        return
    sys.path.append(str(folder))
    module = importlib.import_module(block.file.removesuffix(".py"))
    sys.path.remove(str(folder))
    for test in [value for name, value in vars(module).items() if name.startswith("test_")]:
        test()


@pytest.mark.parametrize("page", [p for p in pages() if any(b.runs for b in blocks(p))])
def test_every_block_runs(page: str, folder: Path, command: Callable[..., Any]) -> None:
    told = surroundings(folder)
    for block in blocks(page):
        if block.file and block.language != SHELL:
            (folder / block.file).write_text(block.text)
        if not block.runs or missing(block.text):
            continue
        if block.language == "python":
            run_python(block, folder)
        elif block.language == SHELL:
            for statement in statements(block.text):
                if not statement.startswith(SETTING_UP):
                    run_statement(statement, told, command)


@pytest.mark.parametrize("block", COMMANDS, ids=str)
def test_every_command_is_one(block: Block) -> None:
    """Also of blocks that are long or not run: its options exist, and its policies."""
    own = {b.text for b in ALL if b.page == block.page}
    for statement in statements(block.text):
        plain = words(statement)
        if not plain or plain[0] != "mjforage":
            continue
        app.parse_args(plain[1:], exit_on_error=False, print_error=False)
        for option, name in pairwise(plain):
            known = name.partition("(")[0]
            if option == "--policy" and not POLICIES.has(known):
                assert ":" in known or any(
                    f"{known}.safetensors" in text or f'\n{known} = "' in text for text in own
                ), name


def test_environments_are_set_up_with_what_there_is() -> None:
    makefile = (REPOSITORY / "Makefile").read_text("utf-8")
    project = tomllib.loads((REPOSITORY / "pyproject.toml").read_text("utf-8"))["project"]
    for block in COMMANDS:
        for target in re.findall(r"^make ([\w-]+)", block.text, re.M):
            assert re.search(rf"^{target}:", makefile, re.M), (str(block), target)
        for extra in re.findall(r"mjforage\[([\w-]+)\]", block.text):
            assert extra in project["optional-dependencies"], (str(block), extra)


@pytest.mark.parametrize("page", pages())
def test_every_fence_has_a_language_that_is_known(page: str) -> None:
    others = [block for block in blocks(page) if not block.language.startswith("{")]  # of Sphinx
    assert [str(block) for block in others if block.language not in LANGUAGES] == []


def test_entry_points_name_what_the_pages_have() -> None:
    """The names that pages give are of classes that stand on one of them."""
    groups, named = set(), set()
    for text in ((REPOSITORY / page).read_text("utf-8") for page in pages()):
        groups |= set(re.findall(r'entry-points\."mjforage\.(\w+)"', text))
        named |= set(re.findall(r'\w = "(my_\w+:\w+)"', text))
    assert groups == {"policies", "metrics", "rewards", "observations", "algorithms"}
    for module, _, name in (value.partition(":") for value in named):
        held = [block.text for block in ALL if block.file == f"{module}.py"]
        assert any(f"class {name}" in text for text in held), name
