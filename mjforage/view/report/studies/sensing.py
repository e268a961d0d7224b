"""What misses and false alarms take, and what it costs a planner to be wrong about them."""

from collections.abc import Mapping

from mjforage.runs.sensing import ASSUMPTIONS, AXES, PLANNER, SLOPE_NODE
from mjforage.view.page import style
from mjforage.view.report.studies.axis_figure import AxisFigure, axis_figure
from mjforage.view.report.studies.axis_tables import tables_along
from mjforage.view.report.studies.reliability import Bins, reliability_picture
from mjforage.view.report.studies.study_logs import StudyLogs
from mjforage.view.report.studies.study_page import Section

COMPARED = ("pta_c", "nt50", "nt90", "csr", "handover")
SHOWN = (*COMPARED, "pta_d", "rmse", "brier", "brier_skill", "reliability")


def _performance(logs: StudyLogs) -> Section:
    drawn = [
        axis_figure(
            f"axes-{world}",
            f"Where cooperation breaks{logs.suffix(world)}",
            "What looks lack, one thing at a time, against perfect sensing.",
            AxisFigure(logs, world, AXES, style.ordered(logs.base.policies)),
            ("missed items", "p over distance", "false alarms", "field of view"),
        )
        for world in logs.worlds
    ]
    words = (
        "The belief planner is told p and the rate of false alarms (`[belief]`), but neither that "
        "items stay hidden nor how long false alarms stay. Where p falls with distance, it is "
        f"1/(1 + exp((d − half)/{SLOPE_NODE:g})) at d nodes."
    )
    tables = tables_along(logs, (*AXES, *ASSUMPTIONS), COMPARED, SHOWN)
    return Section("performance", "Performance over sensing", words, tables, drawn)


def _assumed(logs: StudyLogs) -> Section:
    players = tuple(
        policy
        for policy in style.ordered(logs.base.policies)
        if policy.partition("(")[0] in PLANNER
    )
    drawn = [
        axis_figure(
            f"assumed-{world}",
            f"Right and wrong assumptions{logs.suffix(world)}",
            "What the planner assumes, over what is true.",
            AxisFigure(logs, world, ASSUMPTIONS, players),
            ("chance of detection", "false alarms"),
        )
        for world in logs.worlds
        if players
    ]
    return Section("assumed", "Right and wrong assumptions", "", (), drawn)


def _calibration(kinds: Mapping[str, Bins]) -> Section:
    title = "Calibration"
    caption = "Chances of the belief planner that a node holds an item, against the truth."
    drawn = [reliability_picture("reliability", title, caption, kinds)] if kinds else []
    return Section("calibration", title, "", (), drawn)


def sections(logs: StudyLogs, reliability: Mapping[str, Bins] | None = None) -> list[Section]:
    """The page's sections.

    Parameters
    ----------
    reliability : variant in words -> bins of the planner's forecasts; none: no diagram
    """
    made = [_performance(logs), _assumed(logs), _calibration(reliability or {})]
    return [one for one in made if one.tables or one.pictures]
