"""The command line in this process and in one of its own, and small finished runs."""

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import pytest

from mjforage.base.errors import UserError
from mjforage.cli import main
from mjforage.mission.setup import Setup
from mjforage.runs.evaluate import evaluate
from mjforage.scenario.scenario_file import load_scenario
from mjforage.view.render.opengl import Canvas
from tests.mjforage.printing import unprinted_figures

HORIZON = 12
POLICIES = ("greedy", "levy")

# A shell may have started us with Ctrl-C switched off, which processes inherit. On a slow machine
# a command says how far it has come, on a fast one it does not.
PROGRAM = """
import contextlib, signal
signal.signal(signal.SIGINT, signal.default_int_handler)
import mjforage.cli.progress
mjforage.cli.progress._lines = lambda text: contextlib.nullcontext()
{before}
from mjforage.cli import main
main()
"""


@dataclass(frozen=True)
class Outcome:
    """Result of a command."""

    code: int
    out: str
    err: str


Command = Callable[..., Outcome]


@pytest.fixture
def command(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Command:
    """Run the command line in this process, without the lines that say how far it has come."""
    monkeypatch.setattr("mjforage.cli.progress._lines", lambda text: nullcontext())

    def run(*arguments: object) -> Outcome:
        capsys.readouterr()
        code: Any = 0
        try:
            main([str(argument) for argument in arguments])
        except SystemExit as end:
            code = end.code or 0
        captured = capsys.readouterr()
        return Outcome(int(code), captured.out, captured.err)

    return run


@pytest.fixture
def refused(command: Command) -> Callable[..., str]:
    """Run a command that must fail with exit code 2 and one line, and return that line."""

    def run(*arguments: object) -> str:
        outcome = command(*arguments)
        assert outcome.code == 2, outcome
        assert outcome.err.startswith("mjforage: "), outcome
        assert outcome.err.count("\n") == 1, outcome
        return outcome.err

    return run


@pytest.fixture
def unprinted() -> Iterator[None]:
    """Reports are written with blank figures: for tests of what else is on the page."""
    with unprinted_figures():
        yield


Start = Callable[..., "subprocess.Popen[str]"]


@pytest.fixture
def start() -> Iterator[Start]:
    """Start the command line in a process group of its own, as a terminal does."""
    started = []

    def popen(*arguments: object, before: str = "") -> "subprocess.Popen[str]":
        process = subprocess.Popen(
            [sys.executable, "-c", PROGRAM.format(before=before), *map(str, arguments)],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
            env={key: value for key, value in os.environ.items() if key != "COLUMNS"},
        )
        started.append(process)
        return process

    yield popen
    for process in started:
        with process:
            process.kill()


def small_run(folder: Path, **settings: Any) -> Path:
    """Evaluate a few short episodes into a folder, without a report."""
    overrides = (f"horizon={settings.pop('horizon', HORIZON)}", *settings.pop("overrides", ()))
    scenario = load_scenario("comb-port", overrides)
    policies = settings.pop("policies", POLICIES)
    evaluate(Setup.of(scenario), policies, folder, **{"episodes": 3} | settings)
    return folder


@pytest.fixture(scope="session")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a finished run that nobody may change: greedy and levy, 3 episodes, 12 steps."""
    return small_run(tmp_path_factory.mktemp("finished") / "run")


@pytest.fixture
def run_copy(finished: Path, tmp_path: Path) -> Path:
    """Return a finished run to spoil."""
    return Path(shutil.copytree(finished, tmp_path / "copy"))


@pytest.fixture(scope="session")
def evaluate_small() -> Callable[..., Path]:
    """Return `small_run`: folder, then `policies`, `episodes`, `overrides` and so on."""
    return small_run


@pytest.fixture(scope="session")
def opengl() -> None:
    """Skip where no OpenGL driver is installed, the one reason not to draw."""
    try:
        Canvas(mujoco.MjModel.from_xml_string("<mujoco/>"), 8, 8).close()
    except UserError as error:
        required = "MJFORAGE_REQUIRE_OPENGL" in os.environ
        (pytest.fail if required else pytest.skip)(str(error))
