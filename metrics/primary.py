"""Primary metrics: how much of the task is done, how soon, and how fresh the knowledge is.

Equations: paper, "Metrics Definition", subsection "Primary metrics".
"""

import numpy as np
from numpy.typing import ArrayLike

from mjforage.metrics._checks import BoolArray, FloatArray, ratio, same_shape, whole_steps
from mjforage.metrics.events import counts_by_step


def pta_series(times: ArrayLike, exists: BoolArray, horizon: int) -> FloatArray:
    """Percentage of Target Achieved, paper "PTA": 100 U / U_UB, of the events up to each step.

    Parameters
    ----------
    times : (..., item) [step] of discovery or of collection, NaN = never
    exists : (..., item) False for padding
    horizon : T [step]

    Returns
    -------
    (..., T + 1) [%], NaN where no item exists

    Raises
    ------
    ValueError
        the shapes differ, or as `counts_by_step`.
    """
    at = np.asarray(times, dtype=np.float64)
    same_shape("times", at, "exists", np.asarray(exists))
    counts = counts_by_step(np.where(exists, at, np.nan), horizon)
    return ratio(100.0 * counts, np.sum(exists, axis=-1)[..., None])


def nt(series: ArrayLike, threshold: float) -> FloatArray:
    """Normalised Time to X, paper "NT_X": first step with PTA >= X, over T.

    Parameters
    ----------
    series : (..., T + 1) [%] a PTA series
    threshold : X [%], in (0, 100]

    Returns
    -------
    (...) in [0, 1]; 1 when X is never reached, NaN where the series is undefined

    Raises
    ------
    ValueError
        X is outside (0, 100], or the series has no step after the start.
    """
    if not 0.0 < threshold <= 100.0:
        raise ValueError(f"threshold {threshold}: a percentage above 0 and up to 100 is needed")
    values = np.asarray(series, dtype=np.float64)
    horizon = whole_steps(values.shape[-1] - 1)
    reached = values >= threshold
    step = np.where(reached.any(axis=-1), reached.argmax(axis=-1), horizon)
    return np.where(np.isnan(values).any(axis=-1), np.nan, step / horizon)


def throughput(times: ArrayLike, agents: int, horizon: int) -> FloatArray:
    """Items handled per agent and step, paper "Throughput".

    Parameters
    ----------
    times : (..., item) [step] when each was handled: collected for foragers, discovered for
        scouts; NaN = never
    agents : number of agents in the team, 0 or more
    horizon : T [step]; later events are not counted

    Returns
    -------
    (...) [item / (agent step)], NaN without agents

    Raises
    ------
    ValueError
        negative number of agents, or a horizon below 1.
    """
    if agents < 0:
        raise ValueError(f"agents {agents}: a team has 0 or more")
    handled = counts_by_step(times, horizon)[..., -1]
    return ratio(handled, float(agents * horizon))


def mean_idleness(idleness: ArrayLike) -> FloatArray:
    """MI(t), paper "Idleness Metrics": mean over the nodes.

    Parameters
    ----------
    idleness : (..., node) each in [0, 1]

    Returns
    -------
    (...) in [0, 1], the same bits whatever the leading axes

    Raises
    ------
    ValueError
        there is no node.
    """
    values = np.ascontiguousarray(idleness, dtype=np.float64)
    if values.shape[-1] == 0:
        raise ValueError("idleness: the map has no node; at least one is needed")
    return np.asarray(values.mean(axis=-1))


def irr(mean_idleness_series: ArrayLike, step: float = 1.0) -> FloatArray:
    """Idleness Reduction Rate, paper "IRR": (I(t) - I(t + 1)) / step.

    Parameters
    ----------
    mean_idleness_series : (..., T + 1) MI(t)
    step : the time between two values, 1 [step] or any other unit

    Returns
    -------
    (..., T) entry t for the change from t to t + 1; the mean is (I(0) - I(T)) / T

    Raises
    ------
    ValueError
        `step` is not positive.
    """
    if not step > 0:
        raise ValueError(f"step {step}: a positive time is needed")
    return -np.diff(np.asarray(mean_idleness_series, dtype=np.float64), axis=-1) / step
