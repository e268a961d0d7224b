"""Effect of missed detections and false alarms, and of wrong assumptions about them."""

from mjforage.runs.studies.sensing import ASSUMPTIONS, AXES, PLANNER, SLOPE_NODE
from mjforage.view.report.sections import Section
from mjforage.view.report.studies.along_axes import tables_along
from mjforage.view.report.studies.axis_figure import axis_figures
from mjforage.view.report.studies.study_logs import StudyLogs

COMPARED = ("pta_c", "nt50", "nt90", "csr", "handover")
SHOWN = (*COMPARED, "pta_d", "rmse", "brier_skill", "calibration_error")


def _performance(logs: StudyLogs) -> Section:
    caption = "Limits of sensing, one at a time, against perfect sensing."
    about = "axes", "Performance over the limits of sensing", caption
    heads = ("missed items", "p over distance", "false alarms", "field of view")
    drawn = axis_figures(logs, about, AXES, logs.policies, heads)
    words = (
        "The belief planner knows p and the rate of false alarms (`[prior]`), but neither that "
        "items stay hidden nor how long false alarms stay. Where p falls with distance, it is "
        f"1/(1 + exp((d − half)/{SLOPE_NODE:g})) at d nodes."
    )
    tables = tables_along(logs, (*AXES, *ASSUMPTIONS), COMPARED, SHOWN)
    return Section("performance", "Performance over sensing", words, tables, drawn)


def _assumed(logs: StudyLogs) -> Section:
    caption = "Assumptions of the planner, over the true values."
    about = "assumed", "Right and wrong assumptions", caption
    planners = tuple(one for one in logs.policies if one.partition("(")[0] in PLANNER)
    heads = ("chance of detection", "false alarms")
    drawn = axis_figures(logs, about, ASSUMPTIONS, planners, heads) if planners else []
    return Section("assumed", "Right and wrong assumptions", pictures=drawn)


def sections(logs: StudyLogs) -> list[Section]:
    """The page's sections."""
    return [_performance(logs), _assumed(logs)]
