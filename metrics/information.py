"""Age and differences of information that travels between agents.

A belief owner is an agent, or a group with common knowledge, with the observations that it knows.
Ages are those of Kaul, Yates and Gruteser 2012, "Real-time status: How often should one update?",
INFOCOM: the time since what is known of a thing was true of it.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mjforage.base.compiled import kernel
from mjforage.metrics._checks import BoolArray, FloatArray, ratio, same_shape, whole_steps
from mjforage.metrics.error_products import error_products

_PART = 4096  # steps of 16 bits whose sum fits 32


def age_of_information(
    last_seen: NDArray[np.integer], now: NDArray[np.integer], horizon: int
) -> FloatArray:
    """AoI(t) of a map: mean over the nodes of min(t - l(v), T).

    Parameters
    ----------
    last_seen : (..., node) l, the step of the newest observation of each node; T or more before
        now if there is none
    now : (...) t [step], below 32,768 as the others are
    horizon : T [step], the age of a node never seen

    Returns
    -------
    (...) [step], the same bits whatever the leading axes

    Raises
    ------
    ValueError
        there is no node, the shapes do not fit, or the horizon is below 1.
    """
    seen, at = np.ascontiguousarray(last_seen), np.asarray(now)
    if seen.shape[-1] == 0:
        raise ValueError("last_seen: the map has no node; at least one is needed")
    if at.shape != seen.shape[:-1]:
        raise ValueError(f"now has shape {at.shape} but last_seen {seen.shape}: (..., node)")
    ages = np.empty(at.shape)
    maps = seen.reshape(-1, seen.shape[-1])
    if seen.dtype.itemsize > 2:
        maps = np.maximum(maps, np.iinfo(np.int16).min)  # or earlier: never
    _ages(maps, np.ascontiguousarray(at).reshape(-1), whole_steps(horizon), ages.reshape(-1))
    return ages


@kernel
def _ages(
    last_seen: NDArray[np.integer],  # (map, node)
    now: NDArray[np.integer],  # (map,)
    horizon: int,
    ages: FloatArray,  # (map,) out
) -> None:
    """Mean age of each map.

    The steps are added up in 32 bits, of which processors add most at once, by parts that fit.
    """
    nodes = last_seen.shape[1]
    for m in range(ages.size):
        oldest, total = np.int32(now[m] - horizon), np.int64(0)
        for first in range(0, nodes, _PART):
            part, among = last_seen[m, first : first + _PART], np.int32(0)
            for n in range(part.size):
                among = np.int32(among + max(np.int32(part[n]), oldest))
            total += among
        ages[m] = (np.int64(nodes) * now[m] - total) / nodes


def position_age(agent_seen: ArrayLike, now: ArrayLike) -> FloatArray:
    """Mean over agents h and their team-mates a of t - seen_h(a).

    Parameters
    ----------
    agent_seen : (..., agent, agent) seen_h(a), the step of the newest position of a that h has
        received; an agent's own position does not count
    now : (...) t [step]

    Returns
    -------
    (...) [step]; NaN with fewer than two agents

    Raises
    ------
    ValueError
        `agent_seen` is not square.
    """
    seen = np.asarray(agent_seen, np.float64)
    pairs = _pairs("agent_seen", seen.shape)
    ages = np.asarray(now, np.float64)[..., None, None] - seen
    own = np.trace(ages, axis1=-2, axis2=-1)
    return ratio(ages.sum(axis=(-2, -1)) - own, pairs)


def contact_share(linked: ArrayLike) -> FloatArray:
    """Pairs of agents (sender, receiver) that are linked, of all A (A - 1).

    Parameters
    ----------
    linked : (..., sender, receiver) True where a message gets across; the diagonal does not count

    Returns
    -------
    (...) in [0, 1]; NaN with fewer than two agents

    Raises
    ------
    ValueError
        `linked` is not square.
    """
    links = np.asarray(linked, np.bool_)
    pairs = _pairs("linked", links.shape)
    own = np.trace(links, axis1=-2, axis2=-1, dtype=np.int64)
    return ratio(links.sum(axis=(-2, -1)) - own, pairs)


def _pairs(name: str, shape: tuple[int, ...]) -> int:
    """A (A - 1) of a matrix (..., agent, agent)."""
    if len(shape) < 2 or shape[-1] != shape[-2]:
        raise ValueError(f"{name} has shape {shape}; (..., agent, agent) is needed")
    return shape[-1] * (shape[-1] - 1)


def unlikeness(
    together: NDArray[np.number],
    maps: NDArray[np.number],
    truth: NDArray[np.number],
    rmse: FloatArray,
    navigable: BoolArray,
) -> tuple[FloatArray, FloatArray]:
    """Disagreement of the maps of belief owners, and their error; smoothed as for `model_error`.

    Parameters
    ----------
    together : (..., node) items that all owners would believe in each node if they pooled their
        knowledge; any map gives the same but for rounding, but slower if others differ from it more
    maps : (..., owner, node) items that each believes in each node
    truth : (..., node) items
    rmse : (...) that of `together`, from `model_error` [item]
    navigable : (row, column) True where there is a node

    Returns
    -------
    disagreement : (...) mean over the pairs of owners of the RMSE between their maps [item]; NaN
        with fewer than two
    error : (...) mean over the owners of the RMSE of their maps [item]; NaN without an owner

    Raises
    ------
    ValueError
        as `model_error`.
    """
    among, with_truth = error_products(together, maps, truth, navigable)
    own = np.diagonal(among, axis1=-2, axis2=-1)
    one, other = np.triu_indices(maps.shape[-2], 1)
    apart = own[..., one] + own[..., other] - 2.0 * among[..., one, other]
    wrong = np.square(rmse)[..., None] - 2.0 * with_truth + own
    return _mean_root(apart), _mean_root(wrong)


def _mean_root(squares: FloatArray) -> FloatArray:
    """Mean of the roots over the last axis; NaN if it is empty."""
    roots = np.sqrt(np.maximum(np.ascontiguousarray(squares), 0.0))
    return ratio(roots.sum(axis=-1), roots.shape[-1])


def handover(discovered_at: ArrayLike, received_at: ArrayLike, horizon: int) -> FloatArray:
    """Mean over the items discovered of the time until an agent that serves them knows, over T.

    Parameters
    ----------
    discovered_at : (..., item) [step], NaN = never
    received_at : (..., item) [step] when the first agent that serves items knew; NaN = never,
        which counts as T
    horizon : T [step]

    Returns
    -------
    (...) in [0, 1]; NaN where nothing was discovered

    Raises
    ------
    ValueError
        the shapes differ, an item is received before it is discovered, or the horizon is below 1.
    """
    found = np.asarray(discovered_at, np.float64)
    received = np.asarray(received_at, np.float64)
    same_shape("discovered_at", found, "received_at", received)
    last = float(whole_steps(horizon))
    if (received < found).any():
        raise ValueError("received_at: an item is received before it is discovered")
    waited = np.where(np.isnan(received), last, np.minimum(received, last)) - found
    known = ~np.isnan(found)
    return ratio(np.where(known, waited, 0.0).sum(axis=-1), known.sum(axis=-1) * last)
