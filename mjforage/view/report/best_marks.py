"""Policies of a world that are best in a metric, by a test rather than by their rounded means."""

from collections.abc import Mapping
from typing import TypeVar

import numpy as np

from mjforage.metrics import holm, paired_p
from mjforage.mission.scoring import Description
from mjforage.view.report.run_logs import Case, FloatArray, RunLogs

Name = TypeVar("Name")

LEVEL = 0.05
FEWEST = 10  # episodes that a pair needs to be judged

NOTE = (
    "bold: the best mean of its world and those that cannot be told from it (paired t-tests with "
    f"the best over the same episodes at the level {LEVEL:g}, corrected by Holm's method for the "
    f"policies of the column, {FEWEST} episodes or more; bounds aside; none where all are alike)"
)


def best_of(logs: RunLogs, metric: Description) -> set[Case]:
    """The best mean of each world, and those not significantly different from it.

    None where the metric has no direction, too few episodes, or where no policy is worse.
    """
    cases = [case for case in logs.cases if case.policy not in logs.run.bounds and metric.better]
    return {
        case
        for world in logs.run.worlds
        for case in best_and_alike(
            {one: one.values(metric.key) for one in cases if one.world == world}, metric.better
        )
    }


def best(values: Mapping[Name, FloatArray], better: int) -> Name | None:
    """Name of the best mean; None where none is defined.

    Parameters
    ----------
    values : (episode,) of each, NaN = undefined
    better : 1 more, -1 less is better
    """
    means = {one: float(np.nanmean(x)) for one, x in values.items() if np.isfinite(x).any()}
    return max(means, key=lambda one: better * means[one]) if means else None


def against_best(values: Mapping[Name, FloatArray], better: int) -> dict[Name, float]:
    """P-values of all others against the best by paired t-tests, corrected for each other by Holm.

    Of those that are defined in some episode; arguments as of `best`.
    """
    top = best(values, better)
    others = [one for one, x in values.items() if one != top and np.isfinite(x).any()]
    if top is None:
        return {}
    corrected = holm([float(paired_p(values[one], values[top])) for one in others])
    return dict(zip(others, corrected.tolist(), strict=True))


def best_and_alike(values: Mapping[Name, FloatArray], better: int) -> set[Name]:
    """The best mean and those not significantly below; none if all are alike or data too few."""
    top, p = best(values, better), against_best(values, better)
    if top is None or not p:
        return set()
    pairs = {one: int(np.isfinite(values[one] - values[top]).sum()) for one in p}
    alike = {one for one in p if pairs[one] >= FEWEST and p[one] >= LEVEL}
    if max(pairs.values()) < FEWEST or len(alike) == len(p):
        return set()
    return {top, *alike}
