"""How far a command has come, said in lines where there is no terminal."""

import re
import subprocess
import sys
import time
from pathlib import Path

import pytest

import mjforage.base.kernel_cache  # noqa: F401  as loaded by whoever compiles
from mjforage.cli.progress import COMPILES, KEPT, Lines, Pace, duration, told


class Bench:
    """A clock that a test winds, and the lines that were said."""

    def __init__(self, unit: str = "episodes") -> None:
        self.now, self.said = 1000.0, list[str]()
        self.compiles, self.counted = False, 0.0
        self.lines = Lines("evaluate", unit, self.said.append, lambda: self.now, self.under_way)

    def under_way(self) -> tuple[bool, float]:
        return self.compiles, self.counted

    def after(self, seconds: float, done: float | None = None, total: float = 1200) -> str:
        self.now += seconds
        if done is not None:
            self.lines(done, total)
        self.lines.tell()
        return self.said[-1]


def test_a_line_says_what_is_done_and_how_long_the_rest_takes() -> None:
    bench = Bench()
    bench.lines(0, 1200)
    assert bench.after(60, 300) == "evaluate: 300 of 1,200 episodes, 25 %, about 3 min left"
    # nothing more is finished, so it takes longer
    assert bench.after(60) == "evaluate: 300 of 1,200 episodes, 25 %, about 6 min left"
    assert bench.after(10_000) == "evaluate: 300 of 1,200 episodes, 25 %, about 8.4 h left"


def test_what_is_being_done_counts_for_the_pace_and_not_as_finished() -> None:
    bench = Bench()
    bench.lines(0, 100)
    bench.counted = 25.0
    assert bench.after(60) == "evaluate: 0 of 100 episodes, 0 %, about 3 min left"


A_MINUTE_EACH: list[tuple[float, float, bool, float | None]] = [
    (60.0 * n, float(n), False, 60.0 * (10 - n) if n else None) for n in range(10)
]


@pytest.mark.parametrize(
    "table",
    [
        pytest.param(A_MINUTE_EACH, id="what is done every minute"),
        pytest.param([(0, 0, True, None), (5, 0, True, None), (9, 0, False, None)], id="nothing"),
        pytest.param(
            [(0, 0, True, None), (90, 0, False, None), (95, 2, False, 20), (100, 4, False, 15)],
            id="what came before kernels were compiled does not count",
        ),
        pytest.param(
            [(0, 0, False, None), (10, 2, False, 40), (20, 2, True, None), (30, 2, False, None)],
            id="kernels of what comes later",
        ),
        pytest.param(
            [(0, 0, False, None), (1, 5, False, 1), (2, 5, False, 2), (20, 5, False, 20)],
            id="what stands still takes longer",
        ),
        pytest.param(
            [(0, 0, False, None), (90, 9, False, 10), (95, 9.5, False, 5), (101, 9.9, False, None)],
            id="an end that does not come when it should is no longer foretold",
        ),
        pytest.param(
            [(0, 0, False, None), (1, 5, False, 1), (61, 6, False, 240), (121, 7, False, 180)],
            id="slow episodes that follow quick ones",
        ),
        pytest.param([(0, 0, False, None), (9, 10, False, None)], id="all is done"),
    ],
)
def test_the_end_is_foretold_from_what_runs(
    table: list[tuple[float, float, bool, float | None]],
) -> None:
    """Rows: time, how much of 10 is done, whether kernels are compiled, seconds left."""
    pace = Pace()
    for now, done, compiles, left in table:
        pace.look(now, done, compiles)
        assert pace.left(now, 10.0) == (None if left is None else pytest.approx(left)), now


def test_when_all_is_counted_nothing_is_foretold() -> None:
    bench = Bench()
    bench.lines(0, 1200)
    assert bench.after(60, 1200) == "evaluate: 1,200 of 1,200 episodes, 100 %, 60 s so far"


def test_what_an_earlier_call_did_says_nothing_of_the_pace() -> None:
    bench = Bench()
    bench.lines(600, 1200)
    assert bench.after(20) == "evaluate: 600 of 1,200 episodes, 50 %, 20 s so far"
    assert bench.after(40, 700).endswith("about 5 min left")


def test_while_kernels_are_compiled_that_is_said_and_nothing_is_foretold() -> None:
    bench = Bench()
    bench.compiles = True
    words = "compiling kernels, once for all runs of this kind; 20 s so far"
    assert bench.after(20) == f"evaluate: {words}"
    bench.lines(0, 1200)
    assert bench.after(0, 600) == f"evaluate: 600 of 1,200 episodes, 50 %, {words}"
    bench.compiles = False
    assert bench.after(0).endswith(", 20 s so far")
    assert "left" in bench.after(1, 700)


def test_kernels_that_cannot_be_kept_are_not_said_to_last(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    bench = Bench()
    bench.compiles = True
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "new" / "folder"))
    assert bench.after(20) == f"evaluate: {COMPILES}{KEPT}; 20 s so far"
    (tmp_path / "file").touch()
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "file"))
    assert bench.after(0) == f"evaluate: {COMPILES}; 20 s so far"


def test_before_anything_is_known_only_the_time_is_said() -> None:
    assert Bench().after(20) == "evaluate: 20 s so far"


def test_a_share_of_a_short_time_is_said_to_a_tenth() -> None:
    bench = Bench()
    bench.lines(0.18, 0.72)
    assert bench.after(20).startswith("evaluate: 0.2 of 0.7 episodes, 25 %")


def test_a_round_that_ends_beyond_the_end_is_all_of_it() -> None:
    bench = Bench()
    bench.lines(26, 3)
    assert bench.after(20) == "evaluate: 26 of 3 episodes, 100 %, 20 s so far"


def test_it_is_never_said_to_be_done_before_it_is() -> None:
    bench = Bench()
    bench.lines(0, 1200)
    assert ", 99 %," in bench.after(60, 1199)


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(0, "10 s"), (44, "40 s"), (89, "90 s"), (91, "2 min"), (3000, "50 min"), (9000, "2.5 h")],
)
def test_times_are_said_as_one_says_them(seconds: float, words: str) -> None:
    assert duration(seconds) == words


def test_lines_come_while_the_block_works_and_stop_with_it() -> None:
    said: list[str] = []
    lines = Lines("evaluate", "episodes", said.append)
    with told(lines, 0.01):
        lines(1, 2)
        until = time.monotonic() + 20
        while len(said) < 2 and time.monotonic() < until:
            time.sleep(0.01)
    assert len(said) >= 2
    told_then = len(said)
    time.sleep(0.05)
    assert len(said) == told_then


def test_without_a_terminal_they_are_plain_lines_on_stderr() -> None:
    program = (
        "import time; from mjforage.cli import console, progress\n"
        "progress.told.__wrapped__.__defaults__ = (0.05,)\n"
        "with console.bar('evaluate', 'episodes') as shown:\n"
        "    shown(1, 4); time.sleep(0.5)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout == ""
    line = r"evaluate: 1 of 4 episodes, 25 %, 10 s so far"
    assert re.fullmatch(rf"({line}\n)+", done.stderr)
