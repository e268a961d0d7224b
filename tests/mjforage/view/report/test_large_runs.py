"""Reports of very many policies, episodes and steps: how much is drawn, held and written."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import polars as pl
import pytest

from mjforage.view.page import Row, Table, embedded_within
from mjforage.view.page.figure import ReportFigure, canvas
from mjforage.view.report import write_report
from mjforage.view.report.curves import time_figures
from mjforage.view.report.report_page import report_page
from mjforage.view.report.run_logs import TRACK_STEPS, load_logs
from mjforage.view.report.sections import ROWS, cut
from mjforage.view.report.shown import PAIRS, POLICIES, only, shown_policies
from mjforage.view.report.step_means import POINTS
from mjforage.view.report.track_figure import tracks_figure
from tests.mjforage.conftest import Command
from tests.mjforage.view.report.large_runs import of_policies

MakeRun = Callable[..., Path]
MOST_BYTES = 5_000_000


@pytest.fixture
def many(make_run: MakeRun) -> Path:
    """A run of 200 policies."""
    return of_policies(make_run(policies=("greedy",), episodes=2, horizon=6), 200)


def names(*numbers: int) -> tuple[str, ...]:
    return tuple(f"policy-{i:04d}" for i in numbers)


def test_of_200_policies_the_best_are_shown(many: Path) -> None:
    logs = load_logs(many)
    best = names(*range(POLICIES))
    assert shown_policies(logs) == best
    assert shown_policies(logs, names(7, 3)) == names(3, 7)
    shown = only(logs, best)
    tables = {table.name: table for table in report_page(logs, shown, ()).tables}
    headline, paired = tables["headline"], tables["paired"]
    assert len(headline.rows) == 200
    assert {row.group.count("policy-") for row in paired.rows} == {2}
    assert len({row.group for row in paired.rows}) == 20 * 19 // 2 <= PAIRS
    assert len(tracks_figure(shown).figure.axes) <= 20
    for picture in time_figures(shown):
        for axes in picture.figure.axes:
            assert len(axes.lines) <= 20


@pytest.mark.usefixtures("unprinted")
def test_the_page_says_what_it_leaves_out_and_the_files_have_all(
    many: Path, command: Command, refused: Callable[..., str]
) -> None:
    page = write_report(many).read_text()
    assert len(page) < MOST_BYTES / 3  # what is left is for figures and replay
    assert "show 20 of the 200 policies: the best by" in page
    assert "<code>mjforage report FOLDER --policy NAME --policy NAME</code> shows others" in page
    csv = pl.read_csv(many / "tables" / "metrics.csv", infer_schema_length=None)
    assert csv["policy"].n_unique() == 200
    asked = command("report", many, "--policy", "policy-0100", "--policy", "policy-0050")
    assert asked.code == 0
    page = (many / "report.html").read_text()
    assert "show 2 of the 200 policies" in page
    assert re.findall("policy-0[0-9]+ − policy-0[0-9]+", page)[0] == "policy-0050 − policy-0100"
    assert "policy auction: is not in this run; choose policy-0000" in refused(
        "report", many, "--policy", "auction"
    )


def test_of_a_long_horizon_so_many_steps_are_drawn(make_run: MakeRun) -> None:
    folder = make_run(policies=("greedy",), episodes=1, horizon=2500)
    logs = load_logs(folder)
    assert logs.means.height == POINTS + 1
    assert logs.means["step"].to_list()[:: POINTS // 2] == [0, 1250, 2500]
    assert (logs.tracks["step"] <= TRACK_STEPS).all()
    for picture in time_figures(logs):
        for line in picture.figure.axes[0].lines:
            assert np.size(line.get_xdata()) == POINTS + 1


def test_the_largest_figures_become_pictures_until_all_have_room(tmp_path: Path) -> None:
    pictures = []
    for name, points in (("small", 5), ("large", 5000)):
        figure = canvas(4.0, 3.0)
        figure.subplots().scatter(*np.random.default_rng(0).random((2, points)))
        pictures.append(ReportFigure(name, name, "", figure))
    small, large = embedded_within(200_000, pictures, tmp_path)
    assert small.source.startswith("data:image/svg") and large.source.startswith("data:image/png")
    assert len(small.source) + len(large.source) <= 200_000
    assert (tmp_path / "figures" / "large.svg").stat().st_size > 200_000


def test_a_table_too_long_for_a_page_is_cut_and_says_so() -> None:
    rows = tuple(Row(str(i), ("1",)) for i in range(ROWS + 1))
    table = cut(Table("long", "Long", ("one",), rows))
    assert len(table.rows) == ROWS
    assert table.notes == ("The first 3000 of 3001 rows; the files in `tables/` have all.",)
