"""All figures of the report, drawn under one style."""

from mjforage.view.page.figure import ReportFigure, house_style
from mjforage.view.report.curves import time_figures
from mjforage.view.report.distributions import distribution_figures
from mjforage.view.report.map_figures import scenario_figure
from mjforage.view.report.run_logs import RunLogs, pick_replay
from mjforage.view.report.track_figure import tracks_figure


def draw_figures(logs: RunLogs) -> list[ReportFigure]:
    """Draw every figure, in the order of the report: scenario, tracks, curves, distributions.

    The scenario is drawn from a replay: a run that keeps none goes without.
    """
    replay = pick_replay(logs)
    with house_style():
        return [
            *([scenario_figure(logs, replay)] if replay else []),
            tracks_figure(logs),
            *time_figures(logs),
            *distribution_figures(logs),
        ]
