"""Tables, figures and one self-contained report.html, from a run folder's logs alone."""

from collections.abc import Sequence
from pathlib import Path

from mjforage.view.report.clearing import clearing_table
from mjforage.view.report.exports import NOTHING_ELSE, Exports, write_page
from mjforage.view.report.report_page import draw_figures, metric_tables, report_page
from mjforage.view.report.run_logs import load_logs
from mjforage.view.report.shown import only, shown_policies
from mjforage.view.report.text_tables import needed_table, plain_table, terminal_table

__all__ = [
    "Exports",
    "clearing_table",
    "load_logs",
    "needed_table",
    "plain_table",
    "terminal_table",
    "write_report",
]


def write_report(
    folder: Path, wanted: Exports = NOTHING_ELSE, policies: Sequence[str] = ()
) -> Path:
    """Write ``figures/*.png|svg``, ``tables/*.csv`` and ``report.html`` into a run folder.

    Nothing is re-simulated, and the same logs give the same bytes. Of a run too large for one page
    it shows a part, see `shown`; the tables of metrics in ``tables`` have all policies. Raises
    `UserError` if a log is missing, truncated, foreign or incomplete, the folder cannot be written,
    or there is no such policy.

    Returns: the report.

    Parameters
    ----------
    wanted : formats besides those
    policies : policies to show; none for all, or the best and the worst of very many
    """
    logs = load_logs(folder)
    shown = only(logs, shown_policies(logs, policies))
    page = report_page(logs, shown, draw_figures(shown))
    more = metric_tables(logs) if shown is not logs else ()
    return write_page(folder, page, shown, wanted, more)
