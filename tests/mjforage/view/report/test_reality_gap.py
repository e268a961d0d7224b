"""Tables of the reality gap, from a real run of two short episodes in three worlds."""

import dataclasses
import itertools
import shutil
from pathlib import Path

import numpy as np
import polars as pl
import pytest

from mjforage.core.errors import UserError
from mjforage.core.mission_metrics import chosen_metrics, description
from mjforage.core.scenario_file import load_scenario
from mjforage.core.setup import Setup
from mjforage.runs.evaluate import evaluate
from mjforage.view.report.hull_tables import hulls_table
from mjforage.view.report.reality_gap import gap_table, ladder_table
from mjforage.view.report.run_logs import RunLogs, load_logs
from mjforage.view.report.text_tables import NOTHING


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> RunLogs:
    folder = tmp_path_factory.mktemp("gap") / "run"
    setup = Setup.of(load_scenario("comb-port", ["horizon=8"]))
    evaluate(setup, ["greedy", "random"], folder, episodes=3, worlds=("graph", "hulls", "physics"))
    return load_logs(folder)


def cell(text: str) -> float:
    return float(text.split(" ")[0].replace("−", "-"))


def test_every_metric_has_its_paired_difference(logs: RunLogs) -> None:
    table = gap_table(logs)
    assert table is not None and table.columns[:2] == ("graph", "physics")
    rows = {(row.group, row.head): row for row in table.rows}
    shown = [description(metric) for metric in chosen_metrics()]
    assert ("greedy", "PTA_C [%]") in rows
    for policy, metric in itertools.product(("greedy", "random"), shown):
        here, there = (logs.scalar((world, policy), metric.key) for world in ("physics", "graph"))
        both = np.isfinite(here) & np.isfinite(there)
        if not (np.isfinite(here) | np.isfinite(there)).any():
            assert (policy, metric.head) not in rows
            continue
        row = rows[policy, metric.head]
        assert (row.better, row.cells[5]) == (metric.better, str(both.sum()))
        if both.any():
            step = float((here - there)[both].mean())
            half_digit = 0.501 * 10 ** -len(row.cells[2].partition(".")[2])
            assert row.values[2] is not None and row.values[2].value == pytest.approx(step)
            assert cell(row.cells[2]) == pytest.approx(step, abs=half_digit)
        else:
            assert row.cells[2] == NOTHING


def test_each_world_is_measured_against_the_one_below(logs: RunLogs) -> None:
    table = ladder_table(logs)
    assert table is not None
    assert [row.head for row in table.rows] == ["+ hulls", "+ physics"] * 2
    assert table.columns[1] == "PTA_C"
    for row, (before, world) in zip(
        table.rows, [("graph", "hulls"), ("hulls", "physics")], strict=False
    ):
        step = logs.scalar((world, "greedy"), "pta_c") - logs.scalar((before, "greedy"), "pta_c")
        assert cell(row.cells[1]) == pytest.approx(step.mean(), abs=0.006)
    assert "+ physics: items as bodies in wind and water" in table.notes[0]
    assert "gusts" not in table.notes[0]


def test_outcomes_speeds_and_energy_come_from_the_logs(logs: RunLogs) -> None:
    table = hulls_table({"": logs})
    assert table is not None
    agents = pl.read_parquet(logs.folder / "agents.parquet").filter(
        (pl.col("world") == "physics")
        & (pl.col("policy") == "greedy")
        & (pl.col("step") > 0)
        & (pl.col("agent") >= 2)
    )
    row = next(r for r in table.rows if r.group == "greedy · physics" and r.head == "foragers")
    moves = agents.filter(pl.col("direction") != 8)
    assert 0 < len(moves) < len(agents) == 48
    assert (row.cells[0], row.cells[4]) == (str(len(moves)), str(48 - len(moves)))
    shares = [
        len(moves.filter(pl.col("outcome") == name)) / len(moves) for name in ("arrived", "late")
    ]
    assert [cell(text) for text in row.cells[1:3]] == pytest.approx(
        [100 * share for share in shares], abs=0.006
    )
    joules = agents.filter(pl.col("step") == 8)["work_j"].sum() / 3
    assert cell(row.cells[9]) == pytest.approx(joules / 1000, abs=0.06)
    assert joules > 0


def test_hulls_of_two_runs_stand_below_each_other(logs: RunLogs) -> None:
    table = hulls_table({"one": logs, "other": logs}, episodes=2)
    assert table is not None
    groups = list(dict.fromkeys(row.group for row in table.rows))
    assert groups == [
        f"{run}: {policy} · {world}"
        for run in ("one", "other")
        for policy in ("greedy", "random")
        for world in ("hulls", "physics")
    ]
    assert {int(row.cells[0]) + int(row.cells[4]) for row in table.rows} == {2 * 2 * 8}


def test_a_run_at_graph_level_has_no_gap(logs: RunLogs) -> None:
    alone = dataclasses.replace(logs, run=dataclasses.replace(logs.run, worlds=("graph",)))
    assert gap_table(alone) is None
    assert ladder_table(alone) is None
    assert hulls_table({"": alone}) is None


def test_agents_that_are_not_logged_are_named(logs: RunLogs, tmp_path: Path) -> None:
    pl.read_parquet(logs.folder / "agents.parquet").drop("work_j").write_parquet(
        tmp_path / "agents.parquet"
    )
    shutil.copy(logs.folder / "items.parquet", tmp_path)
    with pytest.raises(UserError, match="column 'work_j' is missing"):
        hulls_table({"": dataclasses.replace(logs, folder=tmp_path)})
