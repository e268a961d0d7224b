"""Every two policies of a world on the same episodes: paired difference, and who is better."""

import itertools
import math
from dataclasses import dataclass

import numpy as np

from metrics import paired_difference, probability_of_improvement
from mjforage.report.logs import RunLogs
from mjforage.report.tables import NOTHING, Row, Table, number, policy_name
from mjforage.vocabulary import COMPARED, Metric, describe

SEED = 0  # of the bootstrap: a report made twice must be the same


@dataclass(frozen=True)
class Pair:
    """First policy minus second in one metric, over the episodes where both are defined."""

    difference: float
    low: float  # bootstrap 95 % interval
    high: float
    better: float  # probability that the first is better; NaN where the metric has no direction
    n: int


def compare(logs: RunLogs, world: str, first: str, second: str, metric: Metric) -> Pair:
    """Compare two policies in one metric."""
    x, y = (logs.scalar((world, policy), metric.key) for policy in (first, second))
    gap = paired_difference(x, y, SEED)
    better = math.nan
    if metric.better:
        share = probability_of_improvement(metric.better * x, metric.better * y, SEED)
        better = float(share.value)
    return Pair(float(gap.value), float(gap.low), float(gap.high), better, int(gap.n))


def _cells(pair: Pair, metric: Metric) -> tuple[str, ...]:
    interval = NOTHING
    if not math.isnan(pair.low):
        interval = f"{number(pair.low, metric.digits)} to {number(pair.high, metric.digits)}"
    return (number(pair.difference, metric.digits), interval, number(pair.better, 2), str(pair.n))


def _resolved(pair: Pair) -> bool:
    """Whether the interval leaves out zero."""
    ends = np.array([pair.low, pair.high])
    return bool(np.all(ends > 0) or np.all(ends < 0))


def comparison_table(logs: RunLogs) -> Table | None:
    """All pairs of policies within each world, in the headline metrics; None with one policy."""
    pairs = list(itertools.combinations(logs.policies, 2))
    rows = []
    for world, (first, second) in itertools.product(logs.run.worlds, pairs):
        suffix = f" · {world}" if len(logs.run.worlds) > 1 else ""
        for metric in map(describe, COMPARED):
            pair = compare(logs, world, first, second, metric)
            group = f"{policy_name(first)} − {policy_name(second)}{suffix}"
            best = frozenset({0}) if _resolved(pair) else frozenset()
            rows.append(Row(metric.label, _cells(pair, metric), group=group, best=best))
    if not rows:
        return None
    notes = (
        "Difference: first policy minus second, mean over the episodes where both are defined, "
        "with the bootstrap 95 % interval; bold where it leaves out zero. P(better): probability "
        "that an episode of the first policy beats one of the second, ties counting half.",
    )
    columns = ("difference", "95 % interval", "P(better)", "n")
    return Table("paired", "Paired comparison", columns, tuple(rows), notes)
