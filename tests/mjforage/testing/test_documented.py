"""All blocks of docs/extending.md run, in its order, in an empty folder."""

import importlib
import os
import re
import runpy
import shlex
import sys
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

PAGE = (Path(__file__).parents[3] / "docs" / "extending.md").read_text()
BLOCKS = re.findall(r"^```(\w*)\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
LIBRARIES = {"my_ppo": "stable_baselines3", "my_torchrl": "tensordict"}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    monkeypatch.chdir(tmp_path)
    path = list(sys.path)
    yield tmp_path
    sys.path[:] = path
    for name in [name for name in sys.modules if name.startswith(("my_", "test_mine"))]:
        del sys.modules[name]


def missing(text: str) -> bool:
    """Whether a block needs a library that is not here."""
    needed = [library for module, library in LIBRARIES.items() if module in text]
    return any(importlib.util.find_spec(library) is None for library in needed)


def carried_out(line: str, command: Callable[..., Any]) -> None:
    first, *rest = shlex.split(line)
    if first == "python":
        runpy.run_path(rest[0], run_name="__main__")
        return
    assert first == "mjforage", line
    done = command(*rest)
    assert done.code == 0, (line, done)


def test_every_block_runs(folder: Path, command: Callable[..., Any]) -> None:
    kinds = []
    for kind, text in BLOCKS:
        kinds.append(kind)
        if kind == "python":
            name = text.split("\n", 1)[0].removeprefix("# ").removesuffix(".py")
            (folder / f"{name}.py").write_text(text)
            if not missing(name):
                sys.path.append(os.fspath(folder))
                module = importlib.import_module(name)
                sys.path.remove(os.fspath(folder))
                for test in [v for n, v in vars(module).items() if n.startswith("test_")]:
                    test()
        elif kind == "toml":
            entry_points = tomllib.loads(text)["project"]["entry-points"]
            assert set(entry_points) == {
                f"mjforage.{what}"
                for what in ("policies", "metrics", "rewards", "observations", "algorithms")
            }
            named = {value for group in entry_points.values() for value in group.values()}
        else:
            for line in text.splitlines():
                if not missing(line):
                    carried_out(line, command)
    assert (kinds.count("python"), kinds.count("toml"), kinds.count("")) == (9, 1, 6)
    for value in named:
        module_name, _, path = value.partition(":")
        assert hasattr(sys.modules[module_name], path), value
