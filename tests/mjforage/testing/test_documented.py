"""The how-to pages on parts of a user's own: every block runs, in its order, in an empty folder."""

import importlib
import os
import re
import runpy
import shlex
import subprocess
import sys
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

HOWTO = Path(__file__).parents[3] / "docs" / "howto"
PAGES = ("policy", "metric", "reward", "algorithm")
BLOCK = re.compile(r"^(<!-- not run[^\n]*\n)?```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
FEWER = re.compile(r"--episodes \d+")
LIBRARIES = {"my_ppo": "stable_baselines3", "my_torchrl": "tensordict"}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("mjforage.view.report.draw_figures", lambda logs: [])  # takes seconds
    path = list(sys.path)
    yield tmp_path
    sys.path[:] = path
    for name in [name for name in sys.modules if name.startswith(("my_", "check_mine"))]:
        del sys.modules[name]


def blocks(page: str) -> list[tuple[str, str]]:
    """(kind, text) of the blocks that are run."""
    found = BLOCK.findall((HOWTO / f"{page}.md").read_text("utf-8"))
    return [(kind, text) for skipped, kind, text in found if not skipped]


def missing(text: str) -> bool:
    """Whether a block needs a library that is not here."""
    needed = [library for module, library in LIBRARIES.items() if module in text]
    return any(importlib.util.find_spec(library) is None for library in needed)


def carried_out(text: str, command: Callable[..., Any]) -> None:
    """A block of the shell; commands of ours and scripts in this process, which is quicker."""
    lines = text.splitlines()
    if any("<<" in line for line in lines):
        subprocess.run(["bash", "-e", "-c", text], check=True)
        return
    for first, *rest in (shlex.split(FEWER.sub("--episodes 2", line)) for line in lines):
        if first == "mjforage":
            done = command(*rest)
            assert done.code == 0, (rest, done)
        elif first == "python" and rest[0] != "-c":
            runpy.run_path(rest[0], run_name="__main__")
        elif first == "python":
            exec(rest[1], {})
        else:
            subprocess.run([first, *rest], check=True)


@pytest.mark.parametrize("page", PAGES)
def test_every_block_runs(page: str, folder: Path, command: Callable[..., Any]) -> None:
    ran = [kind for kind, text in blocks(page) if not missing(text)]
    for kind, text in blocks(page):
        if missing(text):
            continue
        if kind == "sh":
            carried_out(text, command)
            continue
        assert kind == "python", kind
        name = text.split("\n", 1)[0].removeprefix("# ")
        assert name.endswith(".py"), f"{page}: the first line of a Python block names its file"
        (folder / name).write_text(text)
        assert f"`{name}`" in (HOWTO / f"{page}.md").read_text("utf-8"), name
    assert {"python", "sh"} <= set(ran)


def test_entry_points_name_what_the_pages_have(folder: Path) -> None:
    named, groups = set(), set()
    for page in PAGES:
        text = (HOWTO / f"{page}.md").read_text("utf-8")
        groups |= set(re.findall(r'entry-points\."mjforage\.(\w+)"', text))
        named |= set(re.findall(r'\w = "(my_\w+:\w+)"', text))
        for kind, source in blocks(page):
            if kind == "python":
                (folder / source.split("\n", 1)[0].removeprefix("# ")).write_text(source)
    sys.path.append(os.fspath(folder))
    for module, _, path in (value.partition(":") for value in named):
        assert hasattr(importlib.import_module(module), path), path
    assert groups == {"policies", "metrics", "rewards", "observations", "algorithms"}
    assert len(named) == len(groups)


def test_the_project_file_is_one(folder: Path) -> None:
    text = next(t for kind, t in blocks("policy") if kind == "sh" and "pyproject.toml" in t)
    subprocess.run(["bash", "-e", "-c", text], check=True)
    project = tomllib.loads((folder / "pyproject.toml").read_text())["project"]
    assert project["entry-points"]["mjforage.policies"] == {"homing": "my_policies:Homing"}
