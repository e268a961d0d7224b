"""Exports for a paper: tables and figures in the formats that were asked for."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from mjforage.base.errors import UserError
from mjforage.view.page.figure import ReportFigure
from mjforage.view.report import Exports, write_report
from mjforage.view.report.report_page import draw_figures
from mjforage.view.report.run_logs import RunLogs
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
            write_report(folder, Exports.of(("latex", "csv", "markdown"), ("pdf", "png", "svg")))
            files = [*(folder / "tables").iterdir(), *(folder / "figures").iterdir()]
            found.append({path.name: path.read_bytes() for path in files})
    return found


def a_map_and_curves(logs: RunLogs) -> list[ReportFigure]:
    return [one for one in draw_figures(logs) if one.name in ("tracks", "pta")]


def test_tables_and_figures_are_written_in_the_formats_wanted(
    written: list[dict[str, bytes]],
) -> None:
    kinds = ("tex", "csv", "md")
    assert {f"{name}.{kind}" for name in ("headline", "paper") for kind in kinds} <= set(written[0])
    assert re.search(r"<text[^>]*>greedy</text>", written[0]["pta.svg"].decode())
    pdf = written[0]["pta.pdf"]
    assert (pdf.startswith(b"%PDF") and b"/CIDFontType2" in pdf) or b"/TrueType" in pdf
    assert b"/Type3" not in pdf


def test_the_same_logs_give_the_same_files(written: list[dict[str, bytes]]) -> None:
    assert written[0] == written[1]


@pytest.mark.parametrize(
    ("tables", "figures", "message"),
    [
        (["latx"], [], "tables: no format 'latx'; choose from latex, csv, markdown"),
        (["csv", ""], [], "tables: no format ''; choose from latex, csv, markdown"),
        ([], ["pdf", "jpg"], "figures: no format 'jpg'; choose from pdf, png, svg"),
    ],
)
def test_a_format_that_is_none_is_one_clear_error(
    tables: list[str], figures: list[str], message: str
) -> None:
    with pytest.raises(UserError, match=f"^{re.escape(message)}$"):
        Exports.of(tables, figures)
