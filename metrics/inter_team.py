"""Inter-team metrics: how two teams with different roles depend on each other.

Equations: paper, "Metrics Definition", subsection "Inter-team metrics".
"""

import numpy as np
from numpy.typing import ArrayLike

from mjforage.metrics._checks import (
    BoolArray,
    FloatArray,
    IntArray,
    agent_indices,
    ratio,
    whole_steps,
)
from mjforage.metrics.events import EventTable, counts_by_step

# Increments of k/K at different levels differ in their last bits; below this share of the
# largest value two steps count as equally busy, so that the first of them is the peak.
_TIE = 1e-9


def mean_dsl(events: EventTable, scouts: ArrayLike, horizon: int) -> FloatArray:
    """Mean Discovery-to-Service Latency, paper "DSL": (t_c - t_d) / T.

    Of the items that a scout discovered and that were collected.

    Parameters
    ----------
    events : (..., item)
    scouts : (agent,) indices of the agents whose discoveries count; may be empty
    horizon : T [step]; later collections are not counted

    Returns
    -------
    (...) in [0, 1]; NaN without such an item

    Raises
    ------
    ValueError
        the scouts are no distinct agent indices, or the horizon is below 1.
    """
    steps = whole_steps(horizon)
    served = _found_by(events, scouts) & (events.collected_at <= steps)
    # Whole steps are added, so that no padding of the item axis changes a bit.
    waited = np.where(served, events.collected_at - events.discovered_at, 0.0).sum(axis=-1)
    return ratio(waited / steps, served.sum(axis=-1))


def itl(series_1: ArrayLike, series_2: ArrayLike) -> FloatArray:
    """Inter-Team Temporal Lag between the busiest steps, paper "ITL".

    The peak of a team is the first step t >= 1 with the largest R(t) - R(t - 1); a team that
    never does anything peaks at step 1.

    Parameters
    ----------
    series_1, series_2 : (..., T + 1) cumulative performance of each team, counts or PTA

    Returns
    -------
    (...) in [0, 1); NaN where a series is undefined

    Raises
    ------
    ValueError
        the series have different lengths, or no step after the start.
    """
    return _lag(np.diff(_series(series_1), axis=-1), np.diff(_series(series_2), axis=-1))


def itl_level(series_1: ArrayLike, series_2: ArrayLike) -> FloatArray:
    """ITL between the first maxima of R(t) itself, over t = 0..T; else as `itl`, in [0, 1]."""
    return _lag(_series(series_1), _series(series_2), before_first=0)


def csr_series(events: EventTable, scouts: ArrayLike, horizon: int) -> FloatArray:
    """Cooperative Success Ratio, paper "CSR": collected and scout-discovered / collected.

    Of the items collected up to each step.

    Parameters
    ----------
    events : (..., item)
    scouts : (agent,) indices of the agents whose discoveries count; may be empty
    horizon : T [step]

    Returns
    -------
    (..., T + 1) in [0, 1], NaN where nothing was collected

    Raises
    ------
    ValueError
        the scouts are no distinct agent indices, or the horizon is below 1.
    """
    joint = np.where(_found_by(events, scouts), events.collected_at, np.nan)
    return ratio(counts_by_step(joint, horizon), counts_by_step(events.collected_at, horizon))


def _found_by(events: EventTable, scouts: ArrayLike) -> BoolArray:
    return np.isin(events.discovered_by, agent_indices(scouts, "scouts"))


def _series(series: ArrayLike) -> FloatArray:
    values = np.asarray(series, dtype=np.float64)
    whole_steps(values.shape[-1] - 1 if values.ndim else 0)
    return values


def _first_peak(activity: FloatArray) -> IntArray:
    scale = np.abs(activity).max(axis=-1, keepdims=True)
    highest = activity.max(axis=-1, keepdims=True)
    return np.asarray((activity >= highest - _TIE * scale).argmax(axis=-1))


def _lag(activity_1: FloatArray, activity_2: FloatArray, before_first: int = 1) -> FloatArray:
    lengths = activity_1.shape[-1], activity_2.shape[-1]
    if lengths[0] != lengths[1]:
        raise ValueError(
            f"the series span {lengths[0]} and {lengths[1]} steps; pad the shorter one"
        )
    horizon = lengths[0] - 1 + before_first
    lag = np.abs(_first_peak(activity_1) - _first_peak(activity_2)) / horizon
    undefined = np.isnan(activity_1).any(axis=-1) | np.isnan(activity_2).any(axis=-1)
    return np.where(undefined, np.nan, lag)
