"""Policies of a world that are best in a metric, by a test rather than by their rounded means."""

from collections.abc import Mapping

import numpy as np

from mjforage.metrics import FEWEST
from mjforage.mission.scoring import Description
from mjforage.view.report.differences import HOW, LEVEL, Name, pairs
from mjforage.view.report.run_logs import Case, FloatArray, RunLogs

MOST = 40  # policies that compete for the mark

NOTE = (
    "bold: the best mean of its world and those that cannot be told from it (multiple comparisons "
    f"with the best: {HOW} of all pairs of the column over the same episodes, together at the "
    f"level {LEVEL:g}, {FEWEST} episodes or more; bounds aside; of more than {MOST} policies "
    f"the best {MOST})"
)


def best_of(logs: RunLogs, metric: Description) -> set[Case]:
    """The best mean of each world, and those not significantly different from it.

    None where the metric has no direction, too few episodes or a single policy.
    """
    cases = [case for case in logs.cases if case.policy not in logs.run.bounds and metric.better]
    return {
        case
        for world in logs.run.worlds
        for case in best_and_alike(
            {one: one.values(metric.key) for one in cases if one.world == world}, metric.better
        )
    }


def best_first(values: Mapping[Name, FloatArray], better: int) -> list[Name]:
    """Names by their means, the best first; those that are defined nowhere are left out.

    `values`: (episode,) of each, NaN = undefined; `better`: 1 more, -1 less is better.
    """
    means = {one: float(np.nanmean(x)) for one, x in values.items() if np.isfinite(x).any()}
    return sorted(means, key=lambda one: -better * means[one])


def best_and_alike(values: Mapping[Name, FloatArray], better: int) -> set[Name]:
    """The best mean and those not significantly worse; none where no pair is tested.

    Multiple comparisons with the best: Hsu 1996, *Multiple Comparisons*, chapter 4. All pairs are
    one family, so that equal policies are all in it in 95 % of the families; of more than `MOST`
    policies only those with the best means compete.
    """
    names = best_first(values, better)[:MOST]
    if not names:
        return set()
    top, found = names[0], pairs({one: values[one] for one in names})
    tested = {one: found[one, top].p for one in names[1:]}
    alike = {one for one, p in tested.items() if p >= LEVEL}
    return {top, *alike} if np.isfinite(list(tested.values())).any() else set()
