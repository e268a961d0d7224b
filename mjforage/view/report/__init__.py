"""Tables, figures and one self-contained report.html, from a run folder's logs alone."""

from pathlib import Path

from mjforage.core.whole_files import write_bytes
from mjforage.view.page import embedded
from mjforage.view.report.all_figures import draw_figures
from mjforage.view.report.clearing import clearing_table
from mjforage.view.report.exports import NOTHING_ELSE, Exports, export
from mjforage.view.report.hull_tables import hulls_table
from mjforage.view.report.policy_pairs import comparison_table
from mjforage.view.report.reality_gap import gap_table, ladder_table
from mjforage.view.report.report_page import render
from mjforage.view.report.run_logs import load_logs
from mjforage.view.report.run_pairs import write_pair
from mjforage.view.report.text_tables import (
    full_table,
    headline_table,
    paper_tables,
    terminal_table,
)

__all__ = ["Exports", "terminal_table", "write_pair", "write_report"]


def write_report(folder: Path, wanted: Exports = NOTHING_ELSE) -> Path:
    """Write ``figures/*.png|svg``, ``tables/*.csv`` and ``report.html`` into a run folder.

    Nothing is re-simulated, and the same logs give the same bytes.

    Returns
    -------
    Path
        The report.

    Raises
    ------
    UserError
        If a log is missing, truncated, foreign or incomplete, or the folder cannot be written.
    """
    logs = load_logs(folder)
    pictures = draw_figures(logs)
    figures = [embedded(picture, folder) for picture in pictures]
    headline, papers, full = headline_table(logs), paper_tables(logs), full_table(logs)
    paired, hulls, clearing = comparison_table(logs), hulls_table({"": logs}), clearing_table(logs)
    gap = [table for table in (ladder_table(logs), gap_table(logs)) if table is not None]
    text = render(logs, figures, headline, papers, full, paired, gap, hulls, clearing)
    tables = (headline, clearing, *gap, hulls, *papers, full, paired)
    export(folder, [table for table in tables if table is not None], pictures, wanted)
    target = folder / "report.html"
    write_bytes(target, text.encode("utf-8"))
    return target
