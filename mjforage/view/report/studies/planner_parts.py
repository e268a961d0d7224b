"""What each part of the belief planner is worth, and what a world it does not expect costs it."""

from collections.abc import Sequence

from mjforage.mission.mission_metrics import describe
from mjforage.runs.variants import BASELINES, COMPLETE, FAST, PARTS, ROBUST, WRONG, without
from mjforage.view.page.figure import ReportFigure, house_style
from mjforage.view.report.studies.compared_players import (
    Line,
    difference,
    differences_table,
    means_table,
)
from mjforage.view.report.studies.forest import Subject, forest
from mjforage.view.report.studies.study_logs import Player, StudyLogs
from mjforage.view.report.studies.study_page import Section
from mjforage.view.report.text_tables import policy_name

COMPARED = ("pta_d", "pta_c", "nt50", "nt90", "csr", "rmse")
SHOWN = (*COMPARED, "cleared", "length")
WORLDS_MET = (COMPLETE, *WRONG)


def _planner(logs: StudyLogs, world: str) -> list[Line]:
    """The whole planner, then with each part switched off, fast and robust."""
    names = {without(part): f"without {part}" for part in PARTS} | {FAST: "fast", ROBUST: "robust"}
    names, there = {"belief": "whole planner"} | names, logs.runs[COMPLETE].policies
    return [Line(names[one], Player(COMPLETE, world, one)) for one in names if one in there]


def _others(logs: StudyLogs, variant: str, world: str) -> list[Line]:
    names = {policy: policy_name(policy, logs.bounds) for policy in BASELINES}
    return [Line(names[policy], Player(variant, world, policy)) for policy in BASELINES]


def _picture(
    logs: StudyLogs, name: str, title: str, caption: str, pairs: Sequence[tuple[Line, Line]]
) -> ReportFigure:
    subjects = [
        Subject(
            line.head,
            line.look,
            {key: difference(logs, line, against, key) for key in COMPARED},
        )
        for line, against in pairs
    ]
    with house_style():
        return forest(name, title, caption, [describe(key) for key in COMPARED], subjects)


def _parts(logs: StudyLogs) -> Section:
    tables, pictures = [], []
    for world in logs.worlds:
        planner, others = _planner(logs, world), _others(logs, COMPLETE, world)
        whole, oracle = (
            planner[0],
            next(line for line in others if line.player.policy in logs.bounds),
        )
        rest = [*planner[1:], *others]
        means = {"": [*planner, *others]}
        short, to_oracle = {"": (whole, rest)}, [*planner, *others[:1]]
        end = logs.suffix(world)
        tables += [
            means_table(logs, f"parts-{world}", f"Means{end}", SHOWN, means),
            differences_table(
                logs, f"parts-whole-{world}", f"Minus the whole planner{end}", COMPARED, short
            ),
            differences_table(
                logs,
                f"parts-oracle-{world}",
                f"Minus the oracle, which is a bound{end}",
                COMPARED,
                {"": (oracle, to_oracle)},
            ),
        ]
        pictures.append(
            _picture(
                logs,
                f"parts-{world}",
                f"What each part is worth{end}",
                "Difference to the whole planner on the same episodes.",
                [(line, whole) for line in rest],
            )
        )
    words = (
        "`belief` plays with one of its parts switched off at a time (its "
        "options). The oracle sees every item and the drift: it is a bound, not a policy."
    )
    return Section("parts", "What each part is worth", words, tables, pictures)


def _wrong(logs: StudyLogs) -> Section:
    tables, pictures = [], []
    for world in logs.worlds:
        means, groups, pairs = {}, {}, []
        for variant in WORLDS_MET:
            met = "expected world" if variant == COMPLETE else logs.title(variant)
            planner = [
                Line("belief", Player(variant, world, "belief")),
                Line("belief, robust", Player(variant, world, ROBUST)),
            ]
            others = _others(logs, variant, world)
            greedy, oracle = others
            means[met] = [*planner, *others]
            groups[met] = (greedy, [*planner, oracle])
            pairs += [(Line(f"{line.head}: {met}", line.player), greedy) for line in planner]
        end = logs.suffix(world)
        tables += [
            means_table(logs, f"wrong-{world}", f"Means in wrong worlds{end}", SHOWN, means),
            differences_table(
                logs, f"wrong-greedy-{world}", f"Minus greedy{end}", COMPARED, groups
            ),
        ]
        caption = "Difference to Greedy on the same episodes."
        title = f"The belief planner in worlds it does not expect{end}"
        pictures.append(_picture(logs, f"wrong-{world}", title, caption, pairs))
    assumed = logs.info.scenario["prior"]
    plural = "" if assumed["hotspots"] == 1 else "s"
    words = (
        f"The planner assumes {assumed['hotspots']} hotspot{plural} and a drift of up to "
        f"{assumed['drift_node_per_step']:g} nodes per step and axis; with `robust` up to three "
        "hotspots and twice the drift. Here the world is another one."
    )
    return Section("wrong", "Wrong worlds", words, tables, pictures)


def sections(logs: StudyLogs) -> list[Section]:
    """The page's sections."""
    return [_parts(logs), _wrong(logs)]
