"""Every two policies of a world on the same episodes: paired difference, and who is better."""

import itertools
import math
from dataclasses import dataclass

from mjforage.metrics import probability_of_improvement
from mjforage.mission.mission_metrics import Description
from mjforage.view.page.table import Number, Row, Table
from mjforage.view.report.differences import (
    SEED,
    Difference,
    corrected,
    family_note,
    p_text,
    set_apart,
)
from mjforage.view.report.run_logs import RunLogs
from mjforage.view.report.text_tables import number, policy_name


@dataclass(frozen=True)
class _Pair:
    """Two policies of a world in one metric, over the episodes where both are defined."""

    group: str
    metric: Description
    gap: Difference
    better: float  # P(first better than second), NaN where the metric has no direction


def _pair(logs: RunLogs, world: str, first: str, second: str, metric: Description) -> _Pair:
    x, y = (logs.scalar((world, policy), metric.key) for policy in (first, second))
    better = math.nan
    if metric.better:
        ours, theirs = metric.better * x, metric.better * y
        share = probability_of_improvement(ours, theirs, SEED, resamples=1)
        better = float(share.value)
    suffix = f" · {world}" if len(logs.run.worlds) > 1 else ""
    names = [policy_name(policy, logs.run.bounds) for policy in (first, second)]
    group = f"{names[0]} − {names[1]}{suffix}"
    return _Pair(group, metric, Difference(x, y, metric), better)


def comparison_table(logs: RunLogs) -> Table | None:
    """All pairs of policies within each world, in the metrics to compare in; None with one policy.

    What is bold is so after Holm's correction over the whole table.
    """
    compared = [one for one in logs.metrics.values() if one.compared and logs.defined(one.key)]
    pairs = [
        _pair(logs, world, first, second, metric)
        for world in logs.run.worlds
        for first, second in itertools.combinations(logs.policies, 2)
        for metric in compared
    ]
    if not pairs:
        return None
    family = [pair.gap for pair in pairs]
    judged = zip(pairs, corrected(family), set_apart(family), strict=True)
    rows = tuple(
        Row(
            pair.metric.head,
            (
                pair.gap.text,
                pair.gap.interval,
                p_text(p),
                number(pair.better, 2),
                str(pair.gap.n),
            ),
            group=pair.group,
            best=frozenset({0} if apart else ()),
            better=pair.metric.better,
            values=(*pair.gap.split, Number(p), Number(pair.better), Number(pair.gap.n)),
        )
        for pair, p, apart in judged
    )
    notes = (
        "Difference: first policy minus second, mean over the episodes where both are defined, "
        f"with the bootstrap 95 % interval of itself alone; {family_note(family)} (p). P(better): "
        "probability that an episode of the first policy beats one of the second, ties counting "
        "half.",
    )
    columns = ("difference", "95 % interval", "p", "P(better)", "n")
    return Table("paired", "Paired comparison", columns, rows, notes, head="metric")
