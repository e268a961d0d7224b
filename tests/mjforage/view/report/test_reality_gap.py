"""Tables of the reality gap, from known numbers, and of hulls, from a real run of three worlds."""

import dataclasses
import shutil
from pathlib import Path

import numpy as np
import polars as pl
import pytest

from mjforage.base.errors import UserError
from mjforage.mission.setup import Setup
from mjforage.runs.evaluate import evaluate
from mjforage.scenario.scenario_file import load_scenario
from mjforage.view.report.hull_tables import hulls_table
from mjforage.view.report.reality_gap import gap_figures, gap_table, levels_table
from mjforage.view.report.run_logs import RunLogs, load_logs
from tests.mjforage.view.report.known_data import P, cells, known_run, starred, three_worlds, told


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> RunLogs:
    folder = tmp_path_factory.mktemp("gap") / "run"
    setup = Setup.of(load_scenario("comb-port", ["horizon=8"]))
    evaluate(setup, ["greedy", "random"], folder, episodes=3, worlds=("graph", "hulls", "physics"))
    return load_logs(folder)


def test_every_metric_has_its_paired_difference_last_minus_first() -> None:
    """Hulls, in between, are not in it."""
    table = gap_table(three_worlds())
    assert table.columns[:2] == ("physics", "graph")
    assert cells(table) == {
        ("greedy", "PTA_C [%]"): (
            *(told("pta_c", 50.0), told("pta_c", 80.0), "*−30.00*", "−30.00 to −30.00", P, "10"),
        ),
        ("greedy", "NT_90"): (
            *(told("nt90", 1.000), told("nt90", 0.500), "*0.500*", "0.500 to 0.500", P, "10"),
        ),
        ("levy", "PTA_C [%]"): (
            *(told("pta_c", 56.0), told("pta_c", 60.0), "*−4.00*", "−4.00 to −4.00", P, "10"),
        ),
        ("levy", "NT_90"): (
            *(told("nt90", 0.875), told("nt90", 0.750), "*0.125*", "0.125 to 0.125", P, "10"),
        ),
    }
    assert [row.better for row in table.rows] == [1, -1, 1, -1]


def test_the_figure_has_the_differences_of_the_table() -> None:
    """Of PTA_C and NT90, for greedy and levy: the last world minus the first."""
    [shown] = gap_figures(three_worlds())
    points = [
        [np.ravel(line.get_xydata()).tolist() for line in axes.lines if line.get_marker() != "None"]
        for axes in shown.figure.axes
        if axes.get_visible()
    ]
    assert points == [[[-30.0, 0.0], [-4.0, 1.0]], [[0.5, 0.0], [0.125, 1.0]]]


def test_a_metric_that_one_world_lacks_has_no_difference() -> None:
    logs = known_run({("graph", "greedy"): {"csr": 0.5}, ("hulls", "greedy"): {"pta_c": 70.0}})
    assert cells(gap_table(logs)) == {
        ("greedy", "PTA_C [%]"): (told("pta_c", 70.0), "–", "–", "–", "–", "0"),
        ("greedy", "CSR"): ("–", told("csr", 0.5), "–", "–", "–", "0"),
    }


def test_each_world_is_measured_against_the_one_below() -> None:
    """PTA_C of greedy is 80, 60 and 50, of levy 60, 50 and 56; NT90 .5, .625, 1; .75, .5, .875."""
    table = levels_table(three_worlds())
    pta, nt = table.columns.index("PTA_C"), table.columns.index("NT_90")
    found = {(row.group, row.head): (starred(row)[pta], starred(row)[nt]) for row in table.rows}
    assert found == {
        ("greedy", "+ hulls"): ("*−20.00 (−20.00 to −20.00)*", "*0.125 (0.125 to 0.125)*"),
        ("greedy", "+ physics"): ("*−10.00 (−10.00 to −10.00)*", "*0.375 (0.375 to 0.375)*"),
        ("levy", "+ hulls"): ("*−10.00 (−10.00 to −10.00)*", "*−0.250 (−0.250 to −0.250)*"),
        ("levy", "+ physics"): ("*6.00 (6.00 to 6.00)*", "*0.375 (0.375 to 0.375)*"),
    }
    assert (table.better[pta], table.better[nt]) == (1, -1)
    assert "+ hulls: hulls, thrusters" in table.notes[0]
    assert "+ physics: items as bodies in wind and water" in table.notes[0]
    assert "gusts" not in table.notes[0]


def test_a_run_at_graph_level_has_no_gap(logs: RunLogs) -> None:
    alone = dataclasses.replace(logs, run=dataclasses.replace(logs.run, worlds=("graph",)))
    assert not gap_table(alone).rows and not hulls_table(alone).rows


def test_agents_that_are_not_logged_are_named(logs: RunLogs, tmp_path: Path) -> None:
    pl.read_parquet(logs.folder / "agents.parquet").drop("work_j").write_parquet(
        tmp_path / "agents.parquet"
    )
    shutil.copy(logs.folder / "items.parquet", tmp_path)
    with pytest.raises(UserError, match="column 'work_j' is missing"):
        hulls_table(dataclasses.replace(logs, folder=tmp_path))
