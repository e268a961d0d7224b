"""What a link takes: performance over its limits, the worth of range, and who knows what."""

import polars as pl

from mjforage.base.errors import UserError
from mjforage.runs.communication import AXES
from mjforage.runs.holders_seen import HoldersSeen
from mjforage.runs.parquet import read_parquet
from mjforage.runs.replaying import replay_of_run
from mjforage.runs.run_info import REMEDY
from mjforage.runs.study import variant_folder
from mjforage.runs.variants import COMPLETE
from mjforage.view.page import style
from mjforage.view.report.run_logs import RunLogs, Series, load_logs
from mjforage.view.report.step_means import KEYS
from mjforage.view.report.studies.axis_figure import AxisFigure, axis_figure
from mjforage.view.report.studies.axis_tables import reference_table, tables_along
from mjforage.view.report.studies.holder_maps import holders_picture
from mjforage.view.report.studies.range_cost import Costs, cost_picture, cost_table
from mjforage.view.report.studies.study_logs import StudyLogs
from mjforage.view.report.studies.study_page import Section
from mjforage.view.report.studies.variant_courses import courses_picture

COMPARED = ("pta_c", "nt50", "nt90", "csr", "handover")
SHOWN = (
    *COMPARED,
    *("aoi", "position_age", "disagreement", "rmse", "rmse_holders"),
    *("contact", "delivered", "lost", "dropped", "bytes_sent"),
)
DIFFERENCE = "disagreement"
RANGE, RELAY = AXES[0], AXES[-1]
KNOWN = "range-64-quays"  # variant whose maps are shown


def _performance(logs: StudyLogs) -> Section:
    policies = style.ordered(logs.base.policies)
    drawn = [
        axis_figure(
            f"axes-{world}",
            f"Where cooperation breaks{logs.suffix(world)}",
            "What the link allows, one limit at a time; the others are as of the ideal link. Boats "
            "with the relay reach some 36 m, its mast some 160 m; they are compared with the same "
            "fleet where nobody passes on what others saw, all else with the ideal link.",
            AxisFigure(logs, world, AXES, policies),
        )
        for world in logs.worlds
    ]
    words = (
        "Every agent acts by what it saw and heard itself. Differences are to the ideal link, on "
        "the same episodes. Beside the relay's boat the others begin at starts that are drawn "
        "anew, so that its differences to the ideal link hold items and drift alike only."
    )
    tables = tables_along(logs, AXES, COMPARED, SHOWN)
    return Section("performance", "Performance over the link", words, tables, drawn)


def _relay(logs: StudyLogs) -> Section:
    words = (
        "A boat that stands at a start, sees its own node alone and takes nothing. The radio has "
        "1 mW at 2.4 GHz (two rays, no walls); antennas stand 0.25 m above the water, that of "
        "the mast 5 m. The same boats, starts and radio throughout: what differs is who passes "
        "on the looks of others, nobody, that boat, that boat with its mast, or all."
    )
    title = "Minus the same fleet where nobody passes on"
    tables = [reference_table(logs, RELAY, "relay", title, COMPARED)]
    return Section("relay", "What a relay is worth", words, tables)


def _range_cost(logs: StudyLogs) -> Section:
    tables, drawn = [], []
    for world in logs.worlds:
        costs = Costs(logs, RANGE, world)
        if costs.steps:
            tables.append(cost_table(logs, world, costs))
            drawn.append(cost_picture(logs, world, costs))
    return Section("range-cost", "Cost of information", "", tables, drawn)


def _ages(logs: StudyLogs) -> Section:
    drawn = []
    for line, points in RANGE.lines.items():
        played = [one for one in points if one.variant in logs.runs]
        variants = [(one.variant, _short(one.variant, one.value)) for one in played]
        if COMPLETE not in dict(variants):
            variants.append((COMPLETE, "ideal"))
        for world in logs.worlds:
            end = line.replace(" ", "-")
            drawn.append(
                courses_picture(
                    logs,
                    f"ages-{end}-{world}",
                    f"Age and disagreement over the range, {line}{logs.suffix(world)}",
                    "How old what agents know is, and how unlike their maps are.",
                    variants,
                    ("aoi", DIFFERENCE),
                    world,
                )
            )
    return Section("ages", "Age of information and disagreement", "", (), drawn)


def _short(variant: str, value: float) -> str:
    """A range in the legend."""
    if variant == COMPLETE:
        return "ideal"
    return f"{value:g} m" if 0.0 < value < float("inf") else RANGE.tick(value)


def _holders(logs: StudyLogs) -> Section:
    """The maps of two holders, or why they cannot be shown."""
    name, title = "holders", "What two agents know"
    if KNOWN not in logs.runs:
        return Section(name, title, f"This study has no variant `{KNOWN}`.")
    folder = variant_folder(logs.folder, KNOWN)
    world, policy = logs.worlds[0], logs.runs[KNOWN].policies[0]
    seen = HoldersSeen(_least_alike(load_logs(folder), (world, policy)))
    try:
        replay = replay_of_run(folder, world, policy, 0, (seen,))
    except UserError as error:
        return Section(name, title, f"The episode cannot be played again: {error}.")
    words = f"{logs.title(KNOWN)}: the step at which the maps of all agents are least alike."
    return Section(name, title, words, (), [holders_picture("holders", title, replay, seen.maps)])


def _least_alike(logs: RunLogs, series: Series) -> int:
    """Step of the first episode at which maps differ most; a third of the horizon if unknown."""
    if DIFFERENCE not in logs.columns_of_steps:
        return logs.run.horizon // 3
    path, (world, policy) = logs.folder / "steps.parquet", series
    mine = pl.col("world").eq(world) & pl.col("policy").eq(policy) & pl.col("episode").eq(0)
    rows = read_parquet(path, (*KEYS, "step", DIFFERENCE), mine, REMEDY).sort("step")
    found = rows[DIFFERENCE].cast(pl.Float64).fill_nan(None)
    if not found.count():
        return logs.run.horizon // 3
    return int(found.fill_null(-1.0).to_numpy().argmax())


def sections(logs: StudyLogs) -> list[Section]:
    """The page's sections."""
    made = [_performance(logs), _relay(logs), _range_cost(logs), _ages(logs), _holders(logs)]
    return [one for one in made if one.tables or one.pictures or one.words]
