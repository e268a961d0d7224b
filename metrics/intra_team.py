"""Intra-team metrics: how the agents of one team share the work and the view.

Equations: paper, "Metrics Definition", subsection "Intra-team metrics".
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mjforage.base.compiled import kernel
from mjforage.metrics._checks import FloatArray, IntArray, agent_indices, first, ratio, same_shape
from mjforage.metrics.events import counts_by_step


def contributions(handled_by: ArrayLike, agents: ArrayLike) -> IntArray:
    """Items that each agent of a team handled: `handled_by` (..., item), -1 = none -> (..., agent).

    Raises ValueError when `agents` (agent,) are no distinct agent indices.
    """
    team = agent_indices(agents, "agents")
    by = np.asarray(handled_by)
    counts = np.zeros((*by.shape[:-1], len(team)), dtype=np.int64)
    for place, agent in enumerate(team):
        counts[..., place] = np.sum(by == agent, axis=-1)
    return counts


def gini(contribution: ArrayLike) -> FloatArray:
    """Gini index of contributions, paper "Gini": `sum_ij |c_i - c_j| / (2 n^2 mean(c))`.

    The double sum is taken over the sorted gaps: the k-th gap parts k agents from n - k.

    Parameters
    ----------
    contribution : (..., agent) >= 0, any unit

    Returns
    -------
    (...) in [0, (n - 1) / n]; NaN where nothing was handled or the team is empty

    Raises
    ------
    ValueError
        a contribution is negative or not finite.
    """
    shares = np.asarray(contribution, dtype=np.float64)
    bad = ~np.isfinite(shares) | (shares < 0)
    if bad.any():
        where = first(bad)
        raise ValueError(f"contribution{list(where)} is {shares[where]}; finite and >= 0 needed")
    ranked = np.sort(shares, axis=-1)
    team = ranked.shape[-1]
    below = np.arange(1, team)
    differences = np.sum(np.diff(ranked, axis=-1) * (below * (team - below)), axis=-1)
    return ratio(differences, team * np.sum(ranked, axis=-1))


def team_gini_series(
    times: ArrayLike, handled_by: ArrayLike, agents: ArrayLike, horizon: int
) -> FloatArray:
    """Gini of the items handled up to each step, (..., horizon + 1).

    `handled_by` (..., item) is `discovered_by` or `collected_by` of an event table, `times`
    (..., item) [step] belong to it, and `agents` (agent,) are the team. Raises ValueError as
    `contributions`, and when shapes differ.
    """
    at, by = np.asarray(times, dtype=np.float64), np.asarray(handled_by)
    same_shape("times", at, "handled_by", by)
    team = agent_indices(agents, "agents")
    counts = np.zeros((*at.shape[:-1], horizon + 1, len(team)))
    for place, agent in enumerate(team):
        counts[..., place] = counts_by_step(np.where(by == agent, at, np.nan), horizon)
    return gini(counts)


def coverage_overlap(times_seen: NDArray[np.integer]) -> FloatArray:
    """Coverage Overlap, paper "CO": nodes seen by >= 2 agents / nodes seen by >= 1.

    Parameters
    ----------
    times_seen : (..., node) number of agents of the team that see each node now

    Returns
    -------
    (...) in [0, 1], NaN where no node is seen

    Raises
    ------
    ValueError
        the counts are not integers, or one is negative.
    """
    seen = np.asarray(times_seen)
    if seen.dtype.kind not in "iu" or seen.ndim == 0:
        raise ValueError(f"times_seen: integers (..., node) are needed, not {seen.dtype}")
    share = np.empty(seen.shape[:-1])
    maps = np.ascontiguousarray(seen).reshape(share.size, seen.shape[-1])
    if _overlap(maps, share.reshape(-1)):
        where = first(seen < 0)
        raise ValueError(f"times_seen{list(where)} is {seen[where]}; counts are 0 or more")
    return share


def marginal_contribution(
    full: ArrayLike, without: ArrayLike, *, higher_is_better: bool
) -> FloatArray:
    """Marginal Contribution of an agent, paper "MC".

    Parameters
    ----------
    full : (...) performance R of the whole team
    without : (...) performance of the team without the agent
    higher_is_better : True for benefits, (R_full - R_without) / R_full; False for costs,
        (R_without - R_full) / R_without

    Returns
    -------
    (...) at most 1 for R >= 0, negative where the team does better without; NaN for x / 0

    Raises
    ------
    ValueError
        the shapes cannot be combined.
    """
    whole, rest = np.asarray(full, dtype=np.float64), np.asarray(without, dtype=np.float64)
    if higher_is_better:
        return ratio(whole - rest, whole)
    return ratio(rest - whole, rest)


@kernel
def _overlap(times_seen: NDArray[np.integer], share: FloatArray) -> bool:
    """Fill `share` (map,) from `times_seen` (map, node); True when a count is negative."""
    negative = False
    for m in range(times_seen.shape[0]):
        once = 0
        twice = 0
        below = 0
        for n in range(times_seen.shape[1]):
            count = times_seen[m, n]
            once += count >= 1
            twice += count >= 2
            below += count < 0
        share[m] = twice / once if once > 0 else np.nan
        negative = negative or below > 0
    return negative
