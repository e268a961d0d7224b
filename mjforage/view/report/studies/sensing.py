"""Effect of missed detections and false alarms, and of wrong assumptions about them."""

from mjforage.runs.studies.sensing import ASSUMPTIONS, AXES, PLANNER, SLOPE_NODE
from mjforage.view.report.sections import Section
from mjforage.view.report.studies.along_axes import tables_along
from mjforage.view.report.studies.axis_figure import AxisFigure, axis_figure
from mjforage.view.report.studies.study_logs import StudyLogs

COMPARED = ("pta_c", "nt50", "nt90", "csr", "handover")
SHOWN = (*COMPARED, "pta_d", "rmse", "brier_skill", "calibration_error")


def _performance(logs: StudyLogs) -> Section:
    drawn = [
        axis_figure(
            f"axes-{world}",
            f"Performance over the limits of sensing{logs.suffix(world)}",
            "Limits of sensing, one at a time, against perfect sensing.",
            AxisFigure(logs, world, AXES, logs.policies),
            ("missed items", "p over distance", "false alarms", "field of view"),
        )
        for world in logs.worlds
    ]
    words = (
        "The belief planner knows p and the rate of false alarms (`[prior]`), but neither that "
        "items stay hidden nor how long false alarms stay. Where p falls with distance, it is "
        f"1/(1 + exp((d − half)/{SLOPE_NODE:g})) at d nodes."
    )
    tables = tables_along(logs, (*AXES, *ASSUMPTIONS), COMPARED, SHOWN)
    return Section("performance", "Performance over sensing", words, tables, drawn)


def _planners(logs: StudyLogs) -> tuple[str, ...]:
    """Policies that assume something."""
    return tuple(one for one in logs.policies if one.partition("(")[0] in PLANNER)


def _assumed(logs: StudyLogs) -> Section:
    players = _planners(logs)
    drawn = [
        axis_figure(
            f"assumed-{world}",
            f"Right and wrong assumptions{logs.suffix(world)}",
            "Assumptions of the planner, over the true values.",
            AxisFigure(logs, world, ASSUMPTIONS, players),
            ("chance of detection", "false alarms"),
        )
        for world in logs.worlds
        if players
    ]
    return Section("assumed", "Right and wrong assumptions", pictures=drawn)


def sections(logs: StudyLogs) -> list[Section]:
    """The page's sections."""
    return [_performance(logs), _assumed(logs)]
