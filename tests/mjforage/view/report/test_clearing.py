"""The table of how long it takes to clean up."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import polars as pl
import pytest

import mjforage as mf


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> list[mf.Run]:
    """One run of 12 episodes that mostly end clean, one of episodes that are too short."""
    folder = tmp_path_factory.mktemp("runs")
    few = {"mean": 6.0, "std": 0.0}
    return [
        mf.evaluate(
            "open-bay", ["greedy"], episodes=12, folder=folder / f"t-{t}", horizon=t, items=few
        )
        for t in (150, 3)
    ]


def test_times_are_those_of_the_items(runs: list[mf.Run]) -> None:
    long, short = runs
    found = long.clearing.filter(pl.col("share") == 0.5)
    minutes = long.scenario.scenario.period_s / 60
    half = [
        sorted(one["t_collected"].fill_null(10**9).to_list())[math.ceil(len(one) / 2) - 1] * minutes
        for one in long.items.partition_by("episode")
    ]
    assert found["median_min"].item() == pytest.approx(sum(sorted(half)[5:7]) / 2)
    assert (found["low_min"].item(), found["high_min"].item()) == pytest.approx(
        (sorted(half)[2], sorted(half)[9])
    )
    assert found["n"].item() == 12
    assert short.clearing["never"].to_list() == [1.0, 1.0, 1.0]
    assert all(map(math.isinf, short.clearing["median_min"]))


def test_the_report_and_the_terminal_have_the_answer(
    runs: list[mf.Run], command: Callable[..., Any]
) -> None:
    done = command("answer", *(run.folder for run in runs))
    assert done.code == 0, done
    lines = [line for line in done.out.splitlines() if ": greedy" in line]
    assert [line.split()[0] for line in lines] == ["t-150:", "t-3:"]
    assert lines[1].split()[2:] == ["never", "100"] * 3
    assert "78–100" in done.out
    page = Path(runs[0].report()).read_text(encoding="utf-8")
    assert "Time to clean up" in page
    kept = pl.read_csv(Path(runs[0].report()).parent / "tables" / "clearing.csv")
    assert kept.height == 1


def test_a_folder_that_is_no_run_is_one_line(tmp_path: Path, command: Callable[..., Any]) -> None:
    done = command("answer", tmp_path)
    assert done.code != 0 and "run.json" in done.err and done.err.count("\n") <= 2
