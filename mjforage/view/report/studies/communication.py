"""Effect of a communication link: performance over its limits, and the value of range."""

from mjforage.runs.studies.communication import AXES
from mjforage.runs.studies.variants import COMPLETE
from mjforage.view.report.sections import Section
from mjforage.view.report.studies.along_axes import reference_table, series_picture, tables_along
from mjforage.view.report.studies.axis_figure import AxisFigure, axis_figure
from mjforage.view.report.studies.range_cost import Costs, cost_table
from mjforage.view.report.studies.study_logs import StudyLogs

COMPARED = ("pta_c", "nt50", "nt90", "csr", "handover")
SHOWN = (
    *COMPARED,
    *("aoi", "position_age", "disagreement", "rmse", "rmse_holders"),
    *("contact", "delivered", "lost", "dropped", "bytes_sent"),
)
DIFFERENCE = "disagreement"
RANGE, RELAY = AXES[0], AXES[-1]


def _performance(logs: StudyLogs) -> Section:
    caption = (
        "Limits of the link, one at a time; all else is as with the ideal link. Vessels with the "
        "relay reach some 36 m, its mast some 160 m; they are compared with the same fleet where "
        "no vessel forwards measurements."
    )
    drawn = [
        axis_figure(
            f"axes-{world}",
            f"Performance over the limits of the link{logs.suffix(world)}",
            caption,
            AxisFigure(logs, world, AXES, logs.policies),
        )
        for world in logs.worlds
    ]
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
    tables = [reference_table(logs, RELAY, "relay", title, COMPARED)]
    return Section("relay", "Value of a relay", words, tables)


def _range_cost(logs: StudyLogs) -> Section:
    costs = [Costs(logs, RANGE, world) for world in logs.worlds]
    tables = [cost_table(one) for one in costs if one.steps]
    return Section("range-cost", "Cost of information", tables=tables)


def _ages(logs: StudyLogs) -> Section:
    drawn = []
    for line, points in RANGE.lines.items():
        names = {one.variant: _short(one.variant, one.value) for one in points} | {
            COMPLETE: "ideal"
        }
        for world in logs.worlds:
            name = f"ages-{line.replace(' ', '-')}-{world}"
            title = f"Age and disagreement over the range, {line}{logs.suffix(world)}"
            caption = "Age of the agents' information, and disagreement of their maps."
            about, keys = (name, title, caption), ("aoi", DIFFERENCE)
            drawn.append(series_picture(logs, about, list(names.items()), keys, world))
    return Section("ages", "Age of information and disagreement", pictures=drawn)


def _short(variant: str, value: float) -> str:
    """A range in the legend."""
    if variant == COMPLETE:
        return "ideal"
    return f"{value:g} m" if 0.0 < value < float("inf") else RANGE.tick(value)


def sections(logs: StudyLogs) -> list[Section]:
    """The page's sections."""
    return [_performance(logs), _relay(logs), _range_cost(logs), _ages(logs)]
