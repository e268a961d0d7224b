"""Progress of a command in lines where there is no terminal."""

import re
import subprocess
import sys

import pytest
from rich.progress import Progress, Task

from mjforage.base import compiled
from mjforage.cli.progress import COMPILES, Report, duration, line, reporting


class Clock:
    """A clock that a test winds."""

    def __init__(self) -> None:
        self.now = 1000.0

    def __call__(self) -> float:
        return self.now


def task() -> tuple[Report, Task, Clock]:
    clock = Clock()
    return *reporting(Progress(disable=True, get_time=clock), "episodes"), clock


@pytest.mark.parametrize(
    ("done", "total", "words"),
    [
        (300, 1200, "300 of 1,200 episodes, 25 %, about 3 min left"),
        (1199, 1200, "1,199 of 1,200 episodes, 99 %, about 10 s left"),
        (1200, 1200, "1,200 of 1,200 episodes, 100 %, 60 s so far"),
        (26, 3, "26 of 3 episodes, 100 %, 60 s so far"),
        (0.18, 0.72, "0.2 of 0.7 episodes, 25 %, about 3 min left"),
        (0, 1200, "0 of 1,200 episodes, 0 %, 60 s so far"),
    ],
)
def test_a_line_says_what_is_done_and_how_long_the_rest_takes(
    done: float, total: float, words: str
) -> None:
    report, one, clock = task()
    report(0, total)
    clock.now += 60.0
    report(done, total)
    assert line("evaluate", one) == f"evaluate: {words}"


def test_what_an_earlier_call_did_says_nothing_of_the_pace() -> None:
    report, one, clock = task()
    report(600, 1200)
    clock.now += 60.0
    report(700, 1200)
    assert line("evaluate", one).endswith("58 %, about 5 min left")


def test_before_anything_is_known_only_the_time_is_said() -> None:
    _, one, clock = task()
    clock.now += 20.0
    assert line("evaluate", one) == "evaluate: 20 s so far"


def test_while_kernels_are_compiled_that_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiled, "compiling", lambda: True)
    _, one, clock = task()
    clock.now += 20.0
    assert line("evaluate", one) == f"evaluate: {COMPILES}; 20 s so far"


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(0, "10 s"), (44, "40 s"), (89, "90 s"), (91, "2 min"), (3000, "50 min"), (9000, "2.5 h")],
)
def test_times_are_said_as_one_says_them(seconds: float, words: str) -> None:
    assert duration(seconds) == words


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
    assert re.fullmatch(r"(evaluate: 1 of 4 episodes, 25 %, 10 s so far\n)+", done.stderr)
