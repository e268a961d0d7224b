"""Cost of a study: CPU time of its episodes and decisions."""

from collections import defaultdict
from collections.abc import Iterable

import numpy as np

from mjforage.metrics import half_width_95, mean
from mjforage.runs.costs import Cost
from mjforage.view.page import style
from mjforage.view.page.table import Table
from mjforage.view.report.cells import Cell, number_cell, row
from mjforage.view.report.run_logs import policy_name
from mjforage.view.report.studies.study_logs import StudyLogs


def later_chunks(costs: Iterable[Cost]) -> set[Cost]:
    """Chunks but a worker's first of a policy in a call, which also loads and compiles."""
    own: dict[tuple[str, str, str], list[Cost]] = defaultdict(list)
    for one in costs:
        own[one.started, one.worker, one.policy].append(one)
    first = {worker: min(one.began_s for one in several) for worker, several in own.items()}
    return {one for who, several in own.items() for one in several if one.began_s > first[who]}


def cost_table(logs: StudyLogs) -> Table:
    """CPU time per episode and decision: a row per policy and world."""
    found = {(cost.policy, cost.world) for costs in logs.costs.values() for cost in costs}
    policies = style.ordered(policy for policy, _ in found)
    rows = []
    for work in ((policy, world) for policy in policies for world in logs.worlds):
        if work not in found:
            continue
        variants = [[c for c in v if (c.policy, c.world) == work] for v in logs.costs.values()]
        later = later_chunks(cost for costs in variants for cost in costs)
        warm = [[cost for cost in costs if cost in later or not later] for costs in variants]
        warm = [costs for costs in warm if costs]
        chunks = [cost for costs in warm for cost in costs]
        episodes, cpu_s = sum(c.episodes for c in chunks), sum(c.cpu_s for c in chunks)
        means = np.array([sum(c.cpu_s for c in v) / sum(c.episodes for c in v) for v in warm])
        cells = (
            number_cell(len(warm), 0),
            number_cell(episodes, 0),
            number_cell(episodes / len(chunks), 1),
            _short(float(mean(means)), float(half_width_95(means))),
            _short(1000 * cpu_s / sum(cost.steps for cost in chunks)),
        )
        policy, world = work
        head = policy_name(policy, logs.bounds) + logs.suffix(world)
        rows.append(row(head, cells, style.policy_colour(policy)))
    note = (
        "CPU time of one core: mean of the variants' means ± 1.96 SEM over the variants, whose "
        "real differences are in it. A worker's first chunk of a row also loads and compiles, and "
        "is left out unless there is no other. Not in it: starting workers, writing, the episodes "
        "played again to keep their replays, merging and drawing."
    )
    labels = ("variants", "episodes", "episodes", "CPU time", "CPU time")
    units = ("", "", "per chunk", "s per episode", "ms per decision")
    return Table("cost", "Cost", labels, tuple(rows), (note,), units)


def _short(value: float, half: float = float("nan")) -> Cell:
    """A number with two digits of its half width, or three of its own where that is undefined."""
    size = half if np.isfinite(half) and half > 0 else value / 10
    digits = max(0, 1 - int(np.floor(np.log10(size)))) if size > 0 else 0
    return number_cell(value, digits, half)
