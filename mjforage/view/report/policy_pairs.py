"""Every two policies of a world on the same episodes: paired difference, and who is better."""

import itertools
import math

from metrics import probability_of_improvement
from mjforage.core.vocabulary import COMPARED, Metric, describe
from mjforage.view.report.differences import SEED, Difference
from mjforage.view.report.run_logs import RunLogs
from mjforage.view.report.text_tables import Row, Table, number, policy_name


def _row(logs: RunLogs, world: str, first: str, second: str, metric: Metric) -> Row:
    """Compare two policies in one metric, over the episodes where both are defined."""
    x, y = (logs.scalar((world, policy), metric.key) for policy in (first, second))
    gap, better = Difference(x, y, metric), math.nan
    if metric.better:
        share = probability_of_improvement(metric.better * x, metric.better * y, SEED)
        better = float(share.value)
    suffix = f" · {world}" if len(logs.run.worlds) > 1 else ""
    names = [policy_name(policy, logs.run.bounds) for policy in (first, second)]
    group = f"{names[0]} − {names[1]}{suffix}"
    cells = (gap.text, gap.interval, number(better, 2), str(gap.n))
    return Row(metric.label, cells, group=group, best=frozenset({0} if gap.apart else ()))


def comparison_table(logs: RunLogs) -> Table | None:
    """All pairs of policies within each world, in the headline metrics; None with one policy."""
    pairs = list(itertools.combinations(logs.policies, 2))
    rows = [
        _row(logs, world, first, second, metric)
        for world, (first, second) in itertools.product(logs.run.worlds, pairs)
        for metric in map(describe, COMPARED)
    ]
    if not rows:
        return None
    notes = (
        "Difference: first policy minus second, mean over the episodes where both are defined, "
        "with the bootstrap 95 % interval; bold where it leaves out zero. P(better): probability "
        "that an episode of the first policy beats one of the second, ties counting half.",
    )
    columns = ("difference", "95 % interval", "P(better)", "n")
    return Table("paired", "Paired comparison", columns, tuple(rows), notes)
