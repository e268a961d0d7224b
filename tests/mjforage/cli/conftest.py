"""Empty folders to work in, and finished runs."""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import nullcontext
from pathlib import Path

import pytest

from mjforage.cli import console
from tests.mjforage.cli.short_runs import EVALUATE
from tests.mjforage.cli.spoiling import SHORT, outcome

PROGRAM = "from mjforage.cli import main; main()"


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Work in an empty folder, and save no figure, which takes seconds."""
    folder = tmp_path_factory.mktemp("bad")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setattr("mjforage.cli.progress._lines", lambda text: nullcontext())
        patch.setattr("mjforage.bench.running.bench", lambda report: {})
        patch.setattr("mjforage.view.report.draw_figures", lambda logs: [])
        patch.setattr("mjforage.view.page.html.save_figure", lambda folder, picture: (b"", b""))
        yield folder


@pytest.fixture(scope="module")
def run(place: Path) -> Path:
    """Return a finished run, in the folder `run`."""
    assert outcome("evaluate", "--policy", "random", *SHORT, "--out", "run") == ""
    return place / "run"


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in an empty folder, so that a command that should be refused can be seen to write."""
    folder = tmp_path / "here"
    folder.mkdir()
    monkeypatch.chdir(folder)
    width = console.PIPE_COLUMNS  # the test runner sets COLUMNS
    monkeypatch.setattr(console.output, "width", width)
    return folder


@pytest.fixture(scope="session")
def reported(tmp_path_factory: pytest.TempPathFactory) -> "tuple[Path, list[str]]":
    """Return a run with its report, made by a process of its own, and the lines that it printed."""
    folder = tmp_path_factory.mktemp("reported") / "run"
    arguments = [*map(str, EVALUATE), "--policy", "lawnmower", "--out", str(folder)]
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, *arguments],
        capture_output=True,
        text=True,
        check=True,
        env={key: value for key, value in os.environ.items() if key != "COLUMNS"},
    )
    slow = r"[^\n]* (so far|left)\n"  # on a busy machine
    assert re.fullmatch(f"({slow})*", done.stderr)
    return folder, done.stdout.splitlines()


@pytest.fixture
def folder(reported: tuple[Path, list[str]], tmp_path: Path) -> Path:
    """Return a run with its report, to spoil."""
    return Path(shutil.copytree(reported[0], tmp_path / "run"))
