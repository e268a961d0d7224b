"""What a paper takes from a report: tables and figures in the formats that were asked for."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import polars as pl
import pytest

from mjforage.base.errors import UserError
from mjforage.mission.mission_metrics import describe
from mjforage.view.page.figure import ReportFigure
from mjforage.view.report import Exports, write_report
from mjforage.view.report.best_marks import best_of
from mjforage.view.report.report_page import draw_figures
from mjforage.view.report.run_logs import Case, RunLogs, load_logs
from tests.mjforage.view.report.made_up_episodes import Plan
from tests.mjforage.view.report.made_up_runs import build

MakeRun = Callable[..., Path]


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> list[dict[str, bytes]]:
    """File name -> content of all formats, written twice from the same logs, of two figures."""
    folder, found = build(tmp_path_factory.mktemp("written") / "run", Plan()), []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("mjforage.view.report.draw_figures", a_map_and_curves)
        for _ in range(2):
            write_report(folder, Exports.of("latex, csv,markdown", "pdf,png,svg"))
            files = [*(folder / "tables").iterdir(), *(folder / "figures").iterdir()]
            found.append({path.name: path.read_bytes() for path in files})
    return found


def a_map_and_curves(logs: RunLogs) -> list[ReportFigure]:
    return [one for one in draw_figures(logs) if one.name in ("tracks", "pta")]


def test_tables_and_figures_are_written_in_the_formats_wanted(
    written: list[dict[str, bytes]],
) -> None:
    kinds = ("tex", "csv", "md")
    assert {f"{name}.{kind}" for name in ("headline", "table-2") for kind in kinds} <= set(
        written[0]
    )
    assert re.search(r"<text[^>]*>greedy</text>", written[0]["pta.svg"].decode())
    pdf = written[0]["pta.pdf"]
    assert (pdf.startswith(b"%PDF") and b"/CIDFontType2" in pdf) or b"/TrueType" in pdf
    assert b"/Type3" not in pdf


def test_the_same_logs_give_the_same_files(written: list[dict[str, bytes]]) -> None:
    assert written[0] == written[1]


def test_without_them_figures_are_outlines_and_no_pdf_is_made(
    make_run: MakeRun, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = make_run()
    monkeypatch.setattr("mjforage.view.report.draw_figures", a_map_and_curves)
    write_report(folder)
    assert {path.suffix for path in (folder / "figures").iterdir()} == {".png", ".svg"}
    assert "<text" not in (folder / "figures" / "pta.svg").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("tables", "figures", "message"),
    [
        ("latx", "", "--tables latx: no format 'latx'; choose from latex, csv, markdown"),
        ("csv,", "", "--tables csv,: no format ''; choose from latex, csv, markdown"),
        ("", "pdf,jpg", "--figures pdf,jpg: no format 'jpg'; choose from pdf, png, svg"),
    ],
)
def test_a_format_that_is_none_is_one_clear_error(tables: str, figures: str, message: str) -> None:
    with pytest.raises(UserError, match=f"^{re.escape(message)}$"):
        Exports.of(tables, figures)


def logs_with(folder: Path, values: dict[str, list[float]]) -> RunLogs:
    """Logs in which NT90 of each policy is as told."""
    logs = load_logs(folder)
    table = logs.episodes.sort("policy", "episode")
    told = [value for policy in sorted(values) for value in values[policy]]
    changed = table.with_columns(pl.Series("nt90", told))
    return RunLogs(logs.folder, logs.run, logs.summary, changed)


def test_bold_are_the_best_and_those_not_told_apart_from_it(make_run: MakeRun) -> None:
    folder = make_run(policies=("greedy", "levy", "random"), episodes=12)
    wobble = list(np.tile([0.0, 0.02, 0.04], 4))
    best, alike, worse = (
        wobble,
        [w + s for w, s in zip(wobble, [0.05, -0.049] * 6, strict=True)],
        [w + 0.3 for w in wobble],
    )
    logs = logs_with(folder, {"greedy": best, "levy": alike, "random": worse})
    assert best_of(logs, describe("nt90")) == {
        Case(logs, "graph", who) for who in ("greedy", "levy")
    }


def test_none_is_bold_where_all_are_alike_or_episodes_are_few(make_run: MakeRun) -> None:
    alike = {"greedy": [0.1, 0.2] * 6, "levy": [0.2, 0.1] * 6}
    logs = logs_with(make_run(episodes=12), alike)
    assert best_of(logs, describe("nt90")) == set()
    apart = {"greedy": [0.1, 0.2, 0.1] * 3, "levy": [0.8, 0.9, 0.8] * 3}
    logs = logs_with(make_run(episodes=9), apart)
    assert best_of(logs, describe("nt90")) == set()
