"""The summary of a metric in a results table."""

from dataclasses import dataclass

from numpy.typing import ArrayLike

from mjforage.metrics import statistics
from mjforage.metrics._checks import FloatArray, IntArray
from mjforage.metrics.resampling import RESAMPLES, bootstrap


@dataclass(frozen=True, eq=False)
class Summary:
    """Summary of a metric over episodes; every array is (...), in the unit of the metric.

    Attributes
    ----------
    mean, sem, iqm : as the functions of these names in `mjforage.metrics.statistics`
    low, high : bootstrap 95 % percentile interval of the mean
    n : episodes where the metric is defined
    """

    mean: FloatArray
    sem: FloatArray
    iqm: FloatArray
    low: FloatArray
    high: FloatArray
    n: IntArray


def summarise(
    values: ArrayLike, seed: int, *, strata: ArrayLike | None = None, resamples: int = RESAMPLES
) -> Summary:
    """Summarise (..., episode) values; arguments and errors as in `bootstrap`."""
    interval = bootstrap(values, seed, strata=strata, resamples=resamples)
    return Summary(
        mean=interval.value,
        sem=statistics.sem(values),
        iqm=statistics.iqm(values),
        low=interval.low,
        high=interval.high,
        n=interval.n,
    )
