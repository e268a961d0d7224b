"""What misses and false alarms take, and what it costs a planner to be wrong about them."""

import numpy as np

from mjforage.base.errors import UserError
from mjforage.runs.forecasts_seen import ForecastsSeen
from mjforage.runs.replaying import replay_of_run
from mjforage.runs.sensing import ASSUMPTIONS, AXES, PLANNER, SLOPE_NODE
from mjforage.runs.study import variant_folder
from mjforage.runs.variants import COMPLETE
from mjforage.view.page import style
from mjforage.view.report.studies.axis_figure import AxisFigure, axis_figure
from mjforage.view.report.studies.axis_tables import tables_along
from mjforage.view.report.studies.reliability import Bins, reliability_picture
from mjforage.view.report.studies.study_logs import StudyLogs
from mjforage.view.report.studies.study_page import Section

COMPARED = ("pta_c", "nt50", "nt90", "csr", "handover")
SHOWN = (*COMPARED, "pta_d", "rmse", "brier_skill", "calibration_error")

EPISODES = 8  # of which forecasts are shown
FORECAST = {
    COMPLETE: "perfect sensing",
    "detection-0.7": "p = 0.7, known",
    "detection-0.5": "p = 0.5, known",
    "detection-0.5-for-1": "p = 0.5, taken for 1",
    "detection-0.9-for-0.5": "p = 0.9, taken for 0.5",
}
"""Variants of which forecasts are shown, and what the legend calls them."""


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
        "The belief planner is told p and the rate of false alarms (`[prior]`), but neither that "
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


def _bins(logs: StudyLogs, variant: str, policy: str) -> Bins:
    """How the forecasts of a variant came true, in its first episodes in the first world."""
    seen, folder = ForecastsSeen(), variant_folder(logs.folder, variant)
    for episode in range(min(EPISODES, logs.base.episodes)):
        replay_of_run(folder, logs.worlds[0], policy, episode, (seen,))
    number, forecast, outcome = seen.sums[:, :3].T
    with np.errstate(invalid="ignore"):
        return Bins(forecast / number, outcome / number, number.astype(np.int64))


def _calibration(logs: StudyLogs) -> Section:
    """How sure the planner is and how right, or why that cannot be shown."""
    name, title = "calibration", "Calibration"
    players = [one for one in logs.base.policies if one.partition("(")[0] in PLANNER]
    if not players:
        return Section(name, title, "")
    try:
        kinds = {
            words: _bins(logs, variant, players[0])
            for variant, words in FORECAST.items()
            if variant in logs.runs
        }
    except UserError as error:
        return Section(name, title, f"The episodes cannot be played again: {error}.")
    caption = (
        "Chances of the belief planner that a node holds an item, against the truth; "
        f"{min(EPISODES, logs.base.episodes)} episodes played again."
    )
    return Section(name, title, "", (), [reliability_picture("reliability", title, caption, kinds)])


def sections(logs: StudyLogs) -> list[Section]:
    """The page's sections."""
    made = [_performance(logs), _assumed(logs), _calibration(logs)]
    return [one for one in made if one.tables or one.pictures or one.words]
