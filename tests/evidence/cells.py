"""Cells of tables from (episode,) values of one policy or of two."""

from numpy.typing import ArrayLike

from mjforage import metrics
from tests.evidence.piece import Cell


def mean(values: ArrayLike) -> Cell:
    """Mean of (episode,) values, ± 1.96 SEM."""
    found = {"mean": metrics.mean(values), "half": metrics.half_width_95(values)}
    return defined(**found, n=metrics.count(values))


def average(values: ArrayLike) -> Cell:
    """Mean of (episode,) values."""
    return defined(mean=metrics.mean(values), n=metrics.count(values))


def gap(values: ArrayLike, others: ArrayLike) -> Cell:
    """Mean of the differences of (episode,) values, entry by entry, ± 1.96 SEM."""
    differences = metrics.statistics.defined(values) - metrics.statistics.defined(others)
    found = {"gap": metrics.mean(differences), "half": metrics.half_width_95(differences)}
    return defined(**found, n=metrics.count(differences))


def beside(values: ArrayLike, others: ArrayLike) -> Cell:
    """Mean of (episode,) values, and what they differ from others, ± 1.96 SEM."""
    difference = gap(values, others)
    assert isinstance(difference, dict)
    return {**defined(mean=metrics.mean(values)), **difference}


def interval(values: ArrayLike, others: ArrayLike) -> Cell:
    """Mean of the differences of (episode,) values, with its bootstrap 95 % interval."""
    found = metrics.paired_difference(values, others, 0)
    return defined(gap=found.value, low=found.low, high=found.high, n=found.n)


def defined(**numbers: ArrayLike) -> dict[str, float]:
    """Those numbers that are defined; counts stay whole."""
    found = {key: float(value) for key, value in numbers.items()}  # type: ignore[arg-type]
    return {
        key: int(value) if key == "n" else value for key, value in found.items() if value == value
    }
