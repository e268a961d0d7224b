"""Contribution of each part of the belief planner, and its performance in unexpected worlds."""

from collections.abc import Sequence

from mjforage.mission.scoring import describe
from mjforage.runs.studies.variants import BASELINES, COMPLETE, FAST, PARTS, ROBUST, WRONG, without
from mjforage.view.page.table import Table
from mjforage.view.report.contrasts import Contrast, differences_table, means_table
from mjforage.view.report.run_logs import Case, policy_name
from mjforage.view.report.sections import Section
from mjforage.view.report.studies.study_logs import StudyLogs

COMPARED = ("pta_d", "pta_c", "nt50", "nt90", "csr", "rmse")
SHOWN = (*COMPARED, "cleared", "length")


def _baselines(logs: StudyLogs, variant: str, world: str) -> dict[str, Case]:
    """Greedy and the oracle, under their names."""
    return {
        policy_name(policy, logs.bounds): logs.case(variant, world, policy) for policy in BASELINES
    }


def _minus(name: str, title: str, contrasts: Sequence[Contrast]) -> Table:
    return differences_table(name, title, [describe(key) for key in COMPARED], contrasts)


def _means(name: str, title: str, groups: dict[str, dict[str, Case]]) -> Table:
    return means_table(name, title, [describe(key) for key in SHOWN], groups)


def _parts(logs: StudyLogs) -> Section:
    tables = []
    names = {
        "belief": "whole planner",
        **{without(part): f"without {part}" for part in PARTS},
        FAST: "fast",
        ROBUST: "robust",
    }
    for world in logs.worlds:
        planner = {
            head: logs.case(COMPLETE, world, policy)
            for policy, head in names.items()
            if logs.plays(policy, COMPLETE)
        }
        others, end = _baselines(logs, COMPLETE, world), logs.suffix(world)
        (_, whole), *parts = [*planner.items(), *others.items()]
        *shown, (_, oracle) = [*planner.items(), *others.items()]
        to_whole = [Contrast(head, case, whole) for head, case in parts]
        to_oracle = [Contrast(head, case, oracle) for head, case in shown]
        title = f"Minus the oracle, which is an upper bound{end}"
        tables += [
            _means(f"parts-{world}", f"Means{end}", {"": planner | others}),
            _minus(f"parts-whole-{world}", f"Minus the whole planner{end}", to_whole),
            _minus(f"parts-oracle-{world}", title, to_oracle),
        ]
    words = (
        "`belief` plays with one of its parts switched off at a time (its "
        "options). The oracle receives every item and the drift: it is an upper bound."
    )
    return Section("parts", "Contribution of each part", words, tables)


def _wrong(logs: StudyLogs) -> Section:
    tables = []
    for world in logs.worlds:
        means, minus = {}, []
        for variant in (COMPLETE, *WRONG):
            met = "expected world" if variant == COMPLETE else logs.title(variant)
            planner = {
                head: logs.case(variant, world, policy)
                for head, policy in (("belief", "belief"), ("belief, robust", ROBUST))
            }
            others = _baselines(logs, variant, world)
            (_, greedy), oracle = others.items()
            means[met] = planner | others
            compared = (*planner.items(), oracle)
            minus += [Contrast(head, case, greedy, met) for head, case in compared]
        end = logs.suffix(world)
        tables += [
            _means(f"wrong-{world}", f"Means in unexpected worlds{end}", means),
            _minus(f"wrong-greedy-{world}", f"Minus greedy{end}", minus),
        ]
    assumed = logs.info.scenario["prior"]
    plural = "" if assumed["hotspots"] == 1 else "s"
    words = (
        f"The planner assumes {assumed['hotspots']} hotspot{plural} and a drift of up to "
        f"{assumed['drift_node_per_step']:g} nodes per step and axis; with `robust` up to three "
        "hotspots and twice the drift. The worlds here are different."
    )
    return Section("wrong", "Unexpected worlds", words, tables)


def sections(logs: StudyLogs) -> list[Section]:
    """The page's sections."""
    return [_parts(logs), _wrong(logs)]
