"""Effect of a communication link: performance over its limits, and the value of a relay."""

from mjforage.runs.studies.communication import AXES
from mjforage.view.report.sections import Section
from mjforage.view.report.studies.along_axes import reference_table, tables_along
from mjforage.view.report.studies.axis_figure import axis_figures
from mjforage.view.report.studies.study_logs import StudyLogs

COMPARED = ("pta_c", "nt50", "nt90", "csr", "handover")
SHOWN = (
    *COMPARED,
    *("aoi", "position_age", "disagreement", "rmse", "rmse_holders"),
    *("contact", "delivered", "lost", "dropped", "bytes_sent"),
)


def _performance(logs: StudyLogs) -> Section:
    caption = (
        "Limits of the link, one at a time; all else is as with the ideal link. Vessels with the "
        "relay reach some 36 m, its mast some 160 m; they are compared with the same fleet where "
        "no vessel forwards measurements."
    )
    about = "axes", "Performance over the limits of the link", caption
    drawn = axis_figures(logs, about, AXES, logs.policies)
    words = (
        "Every agent acts on its own and received measurements. Differences are to the ideal link, "
        "on the same episodes. With a relay vessel the starts of the others are drawn anew, so "
        "that its differences to the ideal link share only items and drift."
    )
    tables = tables_along(logs, AXES, COMPARED, SHOWN)
    return Section("performance", "Performance over the link", words, tables, drawn)


def _relay(logs: StudyLogs) -> Section:
    words = (
        "The relay is a vessel that stays at a start, sees only its own node and collects nothing. "
        "The radio has 1 mW at 2.4 GHz (two rays, no walls); antennas stand 0.25 m above the "
        "water, that of the mast 5 m. Vessels, starts and radio are the same throughout. The "
        "difference is in the vessels that forward measurements of others: none, the relay, the "
        "relay with its mast, or all."
    )
    title = "Minus the same fleet where no vessel forwards"
    tables = [reference_table(logs, AXES[-1], "relay", title, COMPARED)]
    return Section("relay", "Value of a relay", words, tables)


def sections(logs: StudyLogs) -> list[Section]:
    """The page's sections."""
    return [_performance(logs), _relay(logs)]
