"""The event table: step and agent of each item's discovery and collection."""

from dataclasses import dataclass
from math import prod

import numpy as np
from numpy.typing import ArrayLike

from mjforage.base.views import view_of
from mjforage.metrics._checks import BoolArray, FloatArray, IntArray, first, same_shape, whole_steps

NEVER = np.nan
NOBODY = -1


@dataclass(frozen=True, eq=False)
class EventTable:
    """Discovery and collection of each item; any leading axes (policy, episode, ...).

    The arrays are copied, checked and made read-only. An item that was collected unseen is
    entered as discovered by its collector at that same time.

    Attributes
    ----------
    discovered_at : (..., item) [step], NaN = never
    discovered_by : (..., item) agent index, -1 = none
    collected_at : (..., item) [step], NaN = never
    collected_by : (..., item) agent index, -1 = none
    exists : (..., item) False for padding where episodes differ in their number of items

    Raises
    ------
    ValueError
        shapes or dtypes do not fit, a time is negative or infinite, a time has no agent or an
        agent no time, an item is collected undiscovered or before its discovery, or padding
        has an event.
    """

    discovered_at: FloatArray
    discovered_by: IntArray
    collected_at: FloatArray
    collected_by: IntArray
    exists: BoolArray

    def __post_init__(self) -> None:
        exists = np.array(self.exists)
        if exists.dtype != np.bool_ or exists.ndim == 0:
            raise ValueError(f"exists: booleans (..., item) are needed, not {exists.dtype}")
        self._set("exists", exists)
        for what in ("discovered", "collected"):
            at = _times(f"{what}_at", getattr(self, f"{what}_at"))
            by = _agents(f"{what}_by", getattr(self, f"{what}_by"))
            same_shape("exists", exists, f"{what}_at", at)
            same_shape("exists", exists, f"{what}_by", by)
            _check_pair(what, at, by, exists)
            self._set(f"{what}_at", at)
            self._set(f"{what}_by", by)
        _check_order(self.discovered_at, self.collected_at)

    def _set(self, name: str, array: FloatArray | IntArray | BoolArray) -> None:
        """Store an array as read-only, since all metrics share it."""
        object.__setattr__(self, name, view_of(array))


def counts_by_step(times: ArrayLike, horizon: int) -> IntArray:
    """Cumulative number of events with time <= t, for t = 0..horizon.

    Parameters
    ----------
    times : (..., item) [step], NaN = never
    horizon : T [step], at least 1; later events are not counted

    Returns
    -------
    (..., T + 1) never falling

    Raises
    ------
    ValueError
        a time is negative or infinite, or the horizon is below 1.
    """
    at = _times("times", times)
    steps = whole_steps(horizon) + 1
    episodes = at.reshape(prod(at.shape[:-1]), at.shape[-1])
    counted = episodes <= horizon
    row = np.nonzero(counted)[0]
    step = np.ceil(episodes[counted]).astype(np.int64)
    per_step = np.bincount(row * steps + step, minlength=len(episodes) * steps)
    return np.cumsum(per_step.reshape(*at.shape[:-1], steps), axis=-1, dtype=np.int64)


def _times(name: str, times: ArrayLike) -> FloatArray:
    at = np.array(times, dtype=np.float64)
    if at.ndim == 0:
        raise ValueError(f"{name}: an array (..., item) is needed, not one number")
    bad = np.isinf(at) | (at < 0)
    if bad.any():
        where = first(bad)
        raise ValueError(f"{name}{list(where)} is {at[where]}; a step >= 0, or NaN for never")
    return at


def _agents(name: str, agents: ArrayLike) -> IntArray:
    by = np.array(agents)
    if by.dtype.kind not in "iu" and by.size:
        raise ValueError(f"{name} has dtype {by.dtype}; integers are needed, -1 for nobody")
    if by.size and by.min() < NOBODY:
        raise ValueError(f"{name}: agent {by.min()} is unknown; indices start at 0, -1 is nobody")
    return by.astype(np.int64)


def _check_pair(what: str, at: FloatArray, by: IntArray, exists: BoolArray) -> None:
    happened = ~np.isnan(at)
    unpaired = happened != (by != NOBODY)
    if unpaired.any():
        where = first(unpaired)
        raise ValueError(
            f"item {list(where)}: {what}_at is {at[where]} but {what}_by {by[where]}; "
            "a time needs an agent and an agent a time"
        )
    if (happened & ~exists).any():
        where = first(happened & ~exists)
        raise ValueError(f"item {list(where)} is {what} but does not exist; blank its events")


def _check_order(discovered_at: FloatArray, collected_at: FloatArray) -> None:
    wrong = ~np.isnan(collected_at) & ~(discovered_at <= collected_at)
    if wrong.any():
        where = first(wrong)
        raise ValueError(
            f"item {list(where)} is collected at {collected_at[where]} but discovered at "
            f"{discovered_at[where]}; an item collected unseen is discovered at that same time"
        )
