"""Cost of a study: CPU time of its episodes, and throughput of the calls that computed them."""

from collections import defaultdict
from collections.abc import Iterable

import numpy as np

from mjforage.metrics import half_width_95, mean
from mjforage.runs.costs import Cost
from mjforage.view.page import style
from mjforage.view.page.table import Row, Table
from mjforage.view.report.cells import Cell, number_cell, row
from mjforage.view.report.run_logs import policy_name
from mjforage.view.report.studies.study_logs import StudyLogs

Work = tuple[str, str]
"""World and policy, which calls must share to be compared."""


def works(logs: StudyLogs) -> list[Work]:
    """Worlds of one policy next to one another."""
    found = {(cost.world, cost.policy) for costs in logs.costs.values() for cost in costs}
    policies = style.ordered(policy for _, policy in found)
    return [(w, policy) for policy in policies for w in logs.worlds if (w, policy) in found]


def _of(costs: Iterable[Cost], work: Work) -> list[Cost]:
    return [cost for cost in costs if (cost.world, cost.policy) == work]


def _head(logs: StudyLogs, work: Work) -> str:
    return policy_name(work[1], logs.bounds) + logs.suffix(work[0])


def later_chunks(costs: Iterable[Cost]) -> set[Cost]:
    """Chunks but a worker's first of a policy in a call, which also loads and compiles."""
    own: dict[tuple[str, str, str], list[Cost]] = defaultdict(list)
    for one in costs:
        own[one.started, one.worker, one.policy].append(one)
    first = {worker: min(one.began_s for one in several) for worker, several in own.items()}
    return {one for who, several in own.items() for one in several if one.began_s > first[who]}


def cost_table(logs: StudyLogs) -> Table:
    """CPU time per episode and decision, of every world and policy."""
    rows = []
    for work in works(logs):
        variants = [_of(costs, work) for costs in logs.costs.values()]
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
        rows.append(row(_head(logs, work), cells, style.policy_colour(work[1])))
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


def throughput_row(call: list[Cost], work: Work, head: str) -> Row:
    """Work of one call on one world and policy.

    The time between the call's first and last moment of computing is shared out among its works
    in proportion to the time that workers spent on them, so that waiting workers count.
    """
    own = _of(call, work)
    begin, end = min(c.began_s for c in call), max(c.began_s + c.wall_s for c in call)
    wall_s = (end - begin) * sum(c.wall_s for c in own) / sum(c.wall_s for c in call)
    episodes, cpu_s = sum(c.episodes for c in own), sum(c.cpu_s for c in own)
    workers = own[0].workers
    busy = 100 * cpu_s / (wall_s * workers)
    figures = (workers, episodes, wall_s, episodes / wall_s, cpu_s / episodes, busy)
    cells = (Cell(own[0].how), *map(number_cell, figures, (0, 0, 1, 2, 4, 0)))
    return row(f"{own[0].started[:19]} UTC", cells, style.policy_colour(work[1]), group=head)


def throughput_table(logs: StudyLogs) -> Table:
    """A row per call, under the world and policy that make rows comparable."""
    calls: dict[str, list[Cost]] = defaultdict(list)
    for cost in (cost for costs in logs.costs.values() for cost in costs):
        calls[cost.started].append(cost)
    rows = [
        throughput_row(call, work, _head(logs, work))
        for work in works(logs)
        for _, call in sorted(calls.items())
        if _of(call, work)
    ]
    notes = (
        "A row per call and what it computed, also of calls that were stopped or killed: finished "
        "chunks keep their own times. Only rows of one heading are alike. Wall: from the call's "
        "first to its last moment of computing, shared out among the headings in proportion to the "
        "time that workers spent; busy: CPU time over wall time times workers. Calls of less "
        "than a minute mostly load and compile.",
    )
    labels = ("computed by", "workers", "episodes", "wall", "episodes", "CPU time", "busy")
    units = ("", "", "", "s", "per s", "s per episode", "%")
    return Table("throughput", "Throughput", labels, tuple(rows), notes, units, head="call")
