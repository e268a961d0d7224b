"""Pages of studies stay below 5 MB, and say which rows they leave out."""

from pathlib import Path

import matplotlib as mpl
import numpy as np

from mjforage.view.page.figure import ReportFigure, canvas, house_style
from mjforage.view.page.table import Number, Row, Table
from mjforage.view.report.sections import Section
from mjforage.view.report.studies import write_study_report
from mjforage.view.report.studies.study_page import study_page
from tests.mjforage.view.report.made_up_study import made_up_study

FIVE_MB = 5_000_000


def table(name: str, rows: int) -> Table:
    value = Number(0.123456789, 0.1, 0.2)
    row = Row("a policy of some length", ("0.123 ± 0.045",) * 12, values=(value,) * 12)
    return Table(name, name, tuple(f"column {k}" for k in range(12)), (row,) * rows)


def noisy(name: str) -> ReportFigure:
    """A figure whose SVG has some 2 MB."""
    with house_style():
        figure = canvas(6.0, 4.0)
        axes = figure.add_subplot()
        points = np.random.default_rng(1).normal(size=(2, 20_000))
        with mpl.rc_context({"path.simplify": False}):
            axes.plot(*points)
    return ReportFigure(name, name, name, figure)


def test_tables_make_room_for_figures_and_figures_for_the_page(tmp_path: Path) -> None:
    logs = made_up_study(tmp_path, {"first": ("greedy",), "second": ("greedy",)}, episodes=2)
    sections = [
        Section(f"s{k}", f"Section {k}", "", [table(f"t{k}", 2500)], [noisy(f"p{k}")])
        for k in range(6)
    ]
    text = study_page(logs, sections).text(tmp_path, logs.whole)
    assert len(text.encode()) < FIVE_MB
    assert text.count("of 2500 rows; the files in <code>tables/</code> have all") == 6
    assert text.count("<figure") >= 6


def test_a_board_of_many_courses_and_policies(tmp_path: Path) -> None:
    names = tuple(f"greedy(distance={k + 1})" for k in range(10))
    made_up_study(tmp_path, {f"bay-{k}": names for k in range(60)}, 3, "board")
    assert write_study_report(tmp_path).stat().st_size < FIVE_MB
