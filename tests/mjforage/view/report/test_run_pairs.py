"""Two runs on the same episodes: what they must share, what is paired, and the page on them."""

import csv
import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

from mjforage.base.errors import UserError
from mjforage.view.report.run_logs import load_logs
from mjforage.view.report.run_pairs import (
    difference_tables,
    paired_cases,
    shared_episodes,
    write_pair,
)
from tests.mjforage.conftest import Command
from tests.mjforage.view.report.known_data import cells, known_run
from tests.mjforage.view.report.replay_data import MakeRun

GREEDY = ("graph", "greedy")


def change(folder: Path, edit: Callable[[dict[str, Any]], object]) -> Path:
    path = folder / "run.json"
    run = json.loads(path.read_text())
    edit(run)
    path.write_text(json.dumps(run))
    return folder


def table(page: Path, name: str) -> list[dict[str, str]]:
    with (page.parent / "tables" / f"{name}.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def test_differences_are_of_the_episodes_that_both_have(make_run: MakeRun) -> None:
    one, two = make_run(episodes=5), make_run(episodes=4)
    path = two / "episodes.parquet"
    shift = pl.col("pta_c") - pl.Series(np.resize([10.0, 12.0, 11.0, 7.0], 8))
    pl.read_parquet(path).with_columns(pta_c=shift).write_parquet(path)
    page = write_pair(one, two)
    assert page == one / "compared-with-run-1" / "report.html"
    by_policy = {row["policy"]: row for row in table(page, "pair-brief")}
    x, y = (
        load_logs(folder).episodes.filter(policy="greedy", world="graph").sort("episode")["pta_c"]
        for folder in (one, two)
    )
    mean = float((x[:4] - y).mean())  # type: ignore[arg-type]
    greedy = by_policy["greedy"]
    (column,) = [
        name
        for name in greedy
        if name.startswith("PTA_C") and "low" not in name and "high" not in name
    ]
    assert float(greedy[column]) == pytest.approx(mean)
    text = page.read_text("utf-8")
    assert "4 shared episodes" in text and "run-0 minus run-1" in text
    assert table(page, "pair")[0]["metric"] == "PTA_D [%]"


def test_differences_point_and_are_signed_as_their_metrics_say() -> None:
    """Of the first run minus the second: greedy collects 10 more, an eighth of the horizon sooner.

    Levy collects 4 less, a quarter later. Four tests of p = 2^-9 each: .008.
    """
    one = known_run(
        {
            ("graph", "greedy"): {"pta_c": 80.0, "nt90": 0.5},
            ("graph", "levy"): {"pta_c": 60.0, "nt90": 0.75},
        }
    )
    two = known_run(
        {
            ("graph", "greedy"): {"pta_c": 70.0, "nt90": 0.625},
            ("graph", "levy"): {"pta_c": 64.0, "nt90": 0.5},
        }
    )
    brief, full = difference_tables((one, two), ("one", "two"), 10)
    assert (brief.columns, brief.better) == (("PTA_C", "NT_90"), (1, -1))
    assert cells(brief) == {
        ("", "greedy"): ("*10.00 (10.00 to 10.00)*", "*−0.125 (−0.125 to −0.125)*"),
        ("", "levy"): ("*−4.00 (−4.00 to −4.00)*", "*0.250 (0.250 to 0.250)*"),
    }
    assert cells(full)["greedy", "NT_90"] == (
        *("0.500 ± 0.061", "0.625 ± 0.061", "*−0.125*", "−0.125 to −0.125", "0.008", "10"),
    )
    assert cells(full)["levy", "PTA_C [%]"] == (
        *("60.00 ± 1.96", "64.00 ± 1.96", "*−4.00*", "−4.00 to −4.00", "0.008", "10"),
    )
    assert [row.better for row in full.rows] == [1, -1, 1, -1]
    numbers = [[x and x.value for x in row.values][:3] for row in full.rows[:2]]
    assert numbers == [[80.0, 70.0, 10.0], [0.5, 0.625, -0.125]]


def test_what_differs_between_them_is_told(make_run: MakeRun) -> None:
    def edit(run: dict[str, Any]) -> None:
        run["scenario"]["teams"]["scouts"]["radius"] = 2.5
        run["code"] = {"mine": "1234"}

    page = write_pair(make_run(), change(make_run(), edit))
    rows = [(row["setting"], row["run-0"], row["run-1"]) for row in table(page, "pair-settings")]
    assert rows == [
        ("scenario.teams.scouts.radius", "4.0", "2.5"),
        ("code", "", '{"mine": "1234"}'),
    ]


@pytest.mark.parametrize(
    ("edit", "words"),
    [
        (lambda run: run.update(seed=5), "seed is 5 there and 0 here"),
        (
            lambda run: run["scenario"]["items"].update(mean=60.0),
            "items.mean is 60.0 there and 75.0 here",
        ),
        (
            lambda run: run["map"].update(pitch_m=2.0),
            "map is comb-port, 13 x 10, 2 m there and comb-port, 13 x 10, 4 m here",
        ),
    ],
)
def test_runs_without_a_shared_episode_are_refused(
    make_run: MakeRun, edit: Callable[[dict[str, Any]], object], words: str
) -> None:
    one, two = make_run(), change(make_run(), edit)
    with pytest.raises(UserError, match=re.escape(words)) as caught:
        write_pair(one, two)
    assert str(caught.value).startswith(f"{two}: shares no episodes with {one}: ")
    assert "\n" not in str(caught.value) and not (one / "compared-with-run-1").exists()


def test_items_that_lie_elsewhere_are_found_in_the_logs(make_run: MakeRun) -> None:
    one, two = make_run(episodes=3), make_run(episodes=3)
    path = two / "items.parquet"
    moved = pl.when(pl.col("episode") == 1, pl.col("item") == 2).then(0.5).otherwise(0.0)
    pl.read_parquet(path).with_columns(pl.col("row_start") + moved).write_parquet(path)
    with pytest.raises(UserError, match="the items of episode 1 lie elsewhere"):
        shared_episodes(load_logs(one), load_logs(two))


def test_like_is_paired_with_like(make_run: MakeRun) -> None:
    def pairs(one: Path, two: Path) -> list[Any]:
        found = paired_cases(load_logs(one), load_logs(two))
        return [tuple((case.world, case.policy) for case in pair) for pair in found]

    both = make_run()
    assert pairs(both, make_run(worlds=("graph", "physics"))) == [
        (GREEDY, GREEDY),
        (("graph", "levy"), ("graph", "levy")),
    ]
    other = make_run(policies=("pso",))
    assert pairs(both, other) == [(GREEDY, ("graph", "pso")), (("graph", "levy"), ("graph", "pso"))]
    hulls = make_run(worlds=("physics",), policies=("greedy",))
    assert pairs(both, hulls) == [(GREEDY, ("physics", "greedy"))]
    assert len(pairs(other, hulls)) == 1


def test_a_folder_that_holds_a_run_keeps_its_own_report(make_run: MakeRun) -> None:
    one, two = make_run(), make_run()
    with pytest.raises(UserError, match="holds a run or study, whose report stays"):
        write_pair(one, two, two)
    with pytest.raises(UserError, match="is the same folder as"):
        write_pair(one, one)


def test_folders_of_one_name_are_called_by_their_paths(make_run: MakeRun, tmp_path: Path) -> None:
    for name, folder in (("a", make_run()), ("b", make_run())):
        (tmp_path / name).mkdir()
        folder.rename(tmp_path / name / "run")
    page = write_pair(tmp_path / "a" / "run", tmp_path / "b" / "run").read_text("utf-8")
    assert f"<h1>{tmp_path}/a/run and {tmp_path}/b/run</h1>" in page


def test_the_command(
    make_run: MakeRun, command: Command, refused: Callable[..., str], tmp_path: Path
) -> None:
    one, two, out = make_run(), make_run(), tmp_path / "page"
    assert f"report: {out / 'report.html'}" in command("report", one, two, "--out", out).out
    assert "--out" in refused("report", one, "--out", out)
    assert "name two runs" in refused("report", one, study_in(tmp_path))
    assert "report of 3 folders: name one, or two" in refused("report", one, two, one)


def study_in(folder: Path) -> Path:
    (folder / "study").mkdir()
    (folder / "study" / "study.json").write_text("{}")
    return folder / "study"
