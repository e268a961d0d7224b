"""Every two policies of a world on the same episodes: paired difference, and which is better."""

from itertools import combinations

from mjforage.view.page.table import Table
from mjforage.view.report.contrasts import Contrast, every_metric_table
from mjforage.view.report.run_logs import Case, RunLogs, policy_name


def comparison_table(logs: RunLogs) -> Table:
    """All pairs of policies within each world, in the metrics to compare in.

    All of the table are one family of tests.
    """
    contrasts = []
    for world in logs.run.worlds:
        suffix = f" · {world}" if len(logs.run.worlds) > 1 else ""
        for pair in combinations(logs.policies, 2):
            names = " − ".join(policy_name(one, logs.run.bounds) for one in pair)
            first, second = (Case(logs, world, policy) for policy in pair)
            contrasts.append(Contrast("", first, second, f"{names}{suffix}"))
    metrics = [one for one in logs.metrics.values() if one.compared and logs.defined(one.key)]
    return every_metric_table(
        "paired",
        "Paired comparison",
        metrics,
        contrasts,
        "Difference: first policy minus second, mean over the episodes where both are defined",
    )
