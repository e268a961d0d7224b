"""Cells of tables from (episode,) values of one policy or of two."""

import numpy as np
from numpy.typing import ArrayLike

from mjforage import metrics
from mjforage.mission.scoring import Description
from mjforage.view.report.cells import is_rough
from tests.evidence.piece import Cell

ANY = Description("", "")
"""A metric without known ends."""


def mean(values: ArrayLike, metric: Description = ANY, horizon: int = 1) -> Cell:
    """Mean of (episode,) values of a metric with its interval, 1 as `rough` where that is."""
    found = metrics.mean_interval(values, *metric.ends(horizon))
    numbers = defined(mean=found.value, low=found.low, high=found.high, n=found.n)
    return numbers | ({"rough": 1} if is_rough(metric, int(found.n)) else {})


def average(values: ArrayLike) -> Cell:
    """Mean of (episode,) values."""
    return defined(mean=metrics.mean(values), n=metrics.count(values))


def gap(values: ArrayLike, others: ArrayLike) -> Cell:
    """Mean of the differences of (episode,) values, entry by entry, ± half of its interval."""
    found = metrics.compared([metrics.statistics.defined(values) - np.asarray(others)])
    return defined(gap=found.value[0], half=found.high[0] - found.value[0], n=found.n[0])


def beside(values: ArrayLike, others: ArrayLike) -> Cell:
    """Mean of (episode,) values, and what they differ from others, ± half of its interval."""
    difference = gap(values, others)
    assert isinstance(difference, dict)
    return {**defined(mean=metrics.mean(values)), **difference}


def interval(values: ArrayLike, others: ArrayLike) -> Cell:
    """Mean of the differences of (episode,) values, with its 95 % interval of itself alone."""
    found = metrics.compared([metrics.statistics.defined(values) - np.asarray(others)])
    return defined(gap=found.value[0], low=found.low[0], high=found.high[0], n=found.n[0])


def defined(**numbers: ArrayLike) -> dict[str, float]:
    """Those numbers that are defined; counts stay whole."""
    found = {key: float(value) for key, value in numbers.items()}  # type: ignore[arg-type]
    return {
        key: int(value) if key == "n" else value for key, value in found.items() if value == value
    }
