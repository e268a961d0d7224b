"""Which policies of a world are best in a metric, by a test rather than by their rounded means."""

import numpy as np

from metrics import holm, paired_p
from mjforage.core.mission_metrics import Description
from mjforage.view.report.run_logs import RunLogs, Series

LEVEL = 0.05
FEWEST = 10  # episodes that a pair needs to be judged

NOTE = (
    "bold: the best mean of its world and those that cannot be told from it (paired t-tests with "
    f"the best over the same episodes at the level {LEVEL:g}, corrected by Holm's method for the "
    f"policies of the column, {FEWEST} episodes or more; bounds aside; none where all are alike)"
)


def best_of(logs: RunLogs, metric: Description) -> set[Series]:
    """World and policy of the best mean of each world, and of those not told apart from it.

    None where the metric has no direction, too few episodes, or where no policy is worse.
    """
    if not metric.better:
        return set()
    found: set[Series] = set()
    for world in logs.run.worlds:
        found |= _best_of_world(logs, metric, world)
    return found


def _best_of_world(logs: RunLogs, metric: Description, world: str) -> set[Series]:
    players = [(world, policy) for policy in logs.policies if policy not in logs.run.bounds]
    values = {one: logs.scalar(one, metric.key) for one in players}
    means = {one: float(np.nanmean(x)) for one, x in values.items() if np.isfinite(x).any()}
    if len(means) < 2:
        return set()
    top = max(means, key=lambda one: metric.better * means[one])
    others = [one for one in means if one != top]
    pairs = [int(np.isfinite(values[one] - values[top]).sum()) for one in others]
    corrected = holm([float(paired_p(values[one], values[top])) for one in others])
    judged = zip(others, pairs, corrected, strict=True)
    alike = {one for one, n, p in judged if n >= FEWEST and p >= LEVEL}
    if max(pairs) < FEWEST or len(alike) == len(others):
        return set()
    return {top, *alike}
