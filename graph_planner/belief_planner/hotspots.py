"""Posterior of the hotspots that items came from, and of the items still unseen.

Each of a given number of hotspots has a position (uniform over the nodes) and a number of items
(gamma distributed). Under every hypothesis of the drift it is known which start nodes have been in
view at some step, and how likely an item there was missed; U(c) is the share of a hotspot c that no
view showed. With n items seen at starts s_i the posterior is, by Poisson thinning,

    log p(c) = sum_i log P0[c, s_i] - (a + n) log(b + 1 - U(c)) + constant,

and the hotspot has (a + n) / (b + 1 - U(c)) items in all, of which P0[c, x] start in x. What was
never seen of that is carried on by the drift. Sightings too far from every hotspot refute the
assumed number of them (`believed`).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.graph_planner.belief_planner.boundary import Boundary, settled
from mjforage.graph_planner.belief_planner.settings import BeliefSettings
from mjforage.graph_planner.belief_planner.spatial_prior import (
    SpatialPrior,
    bounds,
    gathered,
    scattered,
    start_chances,
)
from mjforage.graph_planner.graph.geodesics import Int32Array

STRAY = 1e-5  # chance of a start anywhere, for tracks that are mistaken
FOREIGN = 2e-4  # below this chance a sighting belongs to another hotspot of those believed in
STRANGE = 1e-5  # and below this one to a hotspot beyond them
SPARE = 2  # hotspots that may show beyond those assumed
REFUTING = 3  # sightings by which such a hotspot is believed in
LEAST_LOG = -80.0  # no hotspot is less likely than that, against the likeliest
NEGLIGIBLE = 1e-3  # hypotheses of the drift with less weight are let go
STALE = 0.8  # starts are worked out again when the drift's estimate moved them so far [node]


class Hotspots(NamedTuple):
    """Memory of a batch."""

    assumed: int  # hotspots
    shape: float  # a of the number of items
    rate: float  # b for each of those assumed
    unseen: NDArray[np.float32]  # (episode, hypothesis, node) chance that no view showed a start
    share: NDArray[np.float64]  # (episode, hypothesis) weight of each drift
    log_starts: NDArray[np.float64]  # (episode, hotspot, node) sum of log P0 over its sightings
    chance: NDArray[np.float64]  # (episode, hotspot, node) posterior
    sighted: NDArray[np.int64]  # (episode, hotspot) sightings
    number: NDArray[np.int64]  # (episode,) sightings of all hotspots
    node: Int32Array  # (episode, sighting)
    step: Int32Array  # (episode, sighting)
    used: NDArray[np.float64]  # (episode, 2) drift by which the starts were worked out
    total: NDArray[np.float64]  # (episode,) items of all hotspots together, expected


def hotspots(
    episodes: int, nodes: int, hypotheses: int, capacity: int, settings: BeliefSettings
) -> Hotspots:
    """Hotspots before any sighting, by the assumptions of `settings`, with room for `capacity`."""
    shape = (settings.items / settings.items_sd) ** 2
    n = settings.hotspots + SPARE
    return Hotspots(
        assumed=settings.hotspots,
        shape=shape,
        rate=shape * settings.hotspots / settings.items,
        unseen=np.ones((episodes, hypotheses, nodes), np.float32),
        share=np.full((episodes, hypotheses), 1.0 / hypotheses),
        log_starts=np.zeros((episodes, n, nodes)),
        chance=np.full((episodes, n, nodes), 1.0 / nodes),
        sighted=np.zeros((episodes, n), np.int64),
        number=np.zeros(episodes, np.int64),
        node=np.zeros((episodes, capacity), np.int32),
        step=np.zeros((episodes, capacity), np.int32),
        used=np.zeros((episodes, 2)),
        total=np.full(episodes, settings.items),
    )


@kernel
def weigh(
    axis: NDArray[np.float64],
    grid: NDArray[np.float64],
    chance: NDArray[np.float64],
    share: NDArray[np.float64],
) -> None:
    """Weights (hypothesis,) of the drifts, from the wind's posterior (2, point) on its grid."""
    per_axis = np.zeros((2, axis.size))
    for a in range(2):
        for p in range(grid.size):
            nearest = 0
            for k in range(1, axis.size):
                if abs(axis[k] - grid[p]) < abs(axis[nearest] - grid[p]):
                    nearest = k
            per_axis[a, nearest] += chance[a, p]
    for r in range(axis.size):
        for c in range(axis.size):
            share[r * axis.size + c] = per_axis[0, r] * per_axis[1, c]


@kernel
def look(spots: Hotspots, e: int, nodes: Int32Array, factor: NDArray[np.float32]) -> None:
    """Take in a view of a step.

    Parameters
    ----------
    nodes : (hypothesis, node) where an item of each start is in that step
    factor : (node,) chance that the view did not show an item there
    """
    unseen, share = spots.unseen, spots.share
    for w in range(nodes.shape[0]):
        if share[e, w] > NEGLIGIBLE:
            for x in range(factor.size):
                unseen[e, w, x] *= factor[nodes[w, x]]


@kernel
def believed(spots: Hotspots, e: int) -> int:
    """Number of hotspots: as many as assumed, or else one more than have shown."""
    confirmed = spots.assumed
    while confirmed < spots.sighted.shape[1] and spots.sighted[e, confirmed] >= REFUTING:
        confirmed += 1
    return confirmed if confirmed == spots.assumed else min(confirmed + 1, spots.sighted.shape[1])


@kernel
def _add_start(
    spots: Hotspots,
    prior: SpatialPrior,
    boundary: Boundary,
    e: int,
    i: int,
    chances: NDArray[np.float64],
) -> None:
    """Credit sighting i to the hotspot that it fits best."""
    node, step = spots.node[e, i], float(spots.step[e, i])
    row = boundary.rows[node] - spots.used[e, 0] * step
    col = boundary.cols[node] - spots.used[e, 1] * step
    _, _, start = settled(boundary, row, col)
    start_chances(prior, start, chances)
    best, fit, many = 0, -1.0, believed(spots, e)
    for h in range(many):
        if spots.sighted[e, h] == 0:
            if fit < FOREIGN:
                best, fit = h, 1.0
            break
        here = 0.0
        for c in range(chances.size):
            here += chances[c] * spots.chance[e, h, c]
        if here > fit:
            best, fit = h, here
    if fit < STRANGE and many < spots.sighted.shape[1]:
        best = many
    spots.sighted[e, best] += 1
    stray = np.log(STRAY)  # of most nodes: a logarithm is dear
    for c in range(chances.size):
        spots.log_starts[e, best, c] += np.log(STRAY + chances[c]) if chances[c] > 0.0 else stray
    _normalise(spots.log_starts[e, best], spots.chance[e, best])  # the next is held against it


@kernel
def _normalise(log_weight: NDArray[np.float64], chance: NDArray[np.float64]) -> None:
    """Chances that add up to 1, from logarithms of their weights."""
    top = log_weight.max()
    least = np.exp(LEAST_LOG)  # of most nodes: an exponential is dear
    for c in range(chance.size):
        chance[c] = np.exp(log_weight[c] - top) if log_weight[c] - top > LEAST_LOG else least
    chance /= chance.sum()


@kernel
def _refit(spots: Hotspots, prior: SpatialPrior, boundary: Boundary, e: int, first: int) -> None:
    """Credit the sightings from number `first` on; from 0 on, all anew."""
    if first == 0:
        spots.log_starts[e] = 0.0
        spots.sighted[e] = 0
    chances = np.empty(spots.chance.shape[2])
    for i in range(first, spots.number[e]):
        _add_start(spots, prior, boundary, e, i, chances)


@kernel
def sight(
    spots: Hotspots,
    prior: SpatialPrior,
    boundary: Boundary,
    e: int,
    now: int,
    nodes: Int32Array,
    drift_row: float,
    drift_col: float,
) -> None:
    """Take in new sightings (sighting,) of step `now`, worked back to their starts.

    All starts are worked out again when the estimated drift has changed much.
    """
    known = spots.number[e]
    for i in range(nodes.size):
        if spots.number[e] < spots.node.shape[1]:
            spots.node[e, spots.number[e]], spots.step[e, spots.number[e]] = nodes[i], now
            spots.number[e] += 1
    off = max(abs(drift_row - spots.used[e, 0]), abs(drift_col - spots.used[e, 1]))
    longest = 0
    for i in range(known):
        longest = max(longest, spots.step[e, i])
    first = known
    if off * longest > STALE or known == 0:
        spots.used[e, 0], spots.used[e, 1] = drift_row, drift_col
        first = 0
    _refit(spots, prior, boundary, e, first)


@kernel
def retract(
    spots: Hotspots, prior: SpatialPrior, boundary: Boundary, e: int, node: int, step: int
) -> None:
    """Take back a sighting in a node at a step, which was of nothing."""
    last = spots.number[e] - 1
    for i in range(last + 1):
        if spots.node[e, i] == node and spots.step[e, i] == step:
            spots.node[e, i], spots.step[e, i] = spots.node[e, last], spots.step[e, last]
            spots.number[e] = last
            spots.chance[e] = 1.0 / spots.chance.shape[2]
            _refit(spots, prior, boundary, e, 0)
            break


@kernel
def _never_shown(share: NDArray[np.float64], unseen: NDArray[np.float32]) -> NDArray[np.float64]:
    """(node,) chance that no view showed an item which started there, over all drifts."""
    mean = np.zeros(unseen.shape[1])
    for w in range(share.size):
        if share[w] > NEGLIGIBLE:
            weight = share[w]
            for x in range(mean.size):
                mean[x] += weight * unseen[w, x]
    return mean


@kernel
def _locate(
    spots: Hotspots, prior: SpatialPrior, e: int, h: int, rate: float, mean: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Update the posterior of hotspot h.

    Returns: (node,) items that the hotspot has in all if it is there, and the box (see `bounds`)
    outside of which it is not.
    """
    n, a, b = mean.size, spots.shape + spots.sighted[e, h], rate
    log_starts, box = spots.log_starts[e, h], np.array([0, 1 << 40, 0, 1 << 40])
    if spots.sighted[e, h] > 0:
        box = bounds(prior, log_starts, log_starts.max() - a * np.log1p(1.0 / b) - 9.0)
    else:
        box[1], box[3] = np.int64(prior.rows.max()), np.int64(prior.cols.max())
    left, log_weight, total = np.full(n, -1.0), np.empty(n), np.empty(n)
    gathered(prior, mean, box, left)
    for c in range(n):
        rate = b + max(0.0, 1.0 - left[c])
        total[c] = a / rate
        log_weight[c] = -np.inf
        if left[c] >= 0.0:
            log_weight[c] = log_starts[c]
            log_weight[c] -= a * np.log(rate)
    _normalise(log_weight, spots.chance[e, h])
    return total, box


@kernel
def _carry(
    share: NDArray[np.float64],
    unseen: NDArray[np.float32],
    starts: NDArray[np.float64],
    nodes: Int32Array,
    expected: NDArray[np.float64],
) -> None:
    """Fill expected (node,): where the items of starts (node,) are now that no view showed."""
    expected[:] = 0.0
    for w in range(share.size):
        if share[w] > NEGLIGIBLE:
            weight = share[w]
            for x in range(starts.size):
                if unseen[w, x]:
                    expected[nodes[w, x]] += weight * unseen[w, x] * starts[x]


@kernel
def expect(
    spots: Hotspots, prior: SpatialPrior, e: int, nodes: Int32Array, expected: NDArray[np.float64]
) -> None:
    """Update the posterior and fill expected (node,): unseen items in every node now.

    `nodes`: (hypothesis, node) where an item of each start is now.
    """
    share, unseen, many = spots.share[e], spots.unseen[e], believed(spots, e)
    rate = spots.rate * many / spots.assumed
    mean, starts = _never_shown(share, unseen), np.zeros(expected.size)
    spots.total[e] = 0.0
    for h in range(many):
        items, box = _locate(spots, prior, e, h, rate, mean)
        alike = many - h if spots.sighted[e, h] == 0 else 1  # those never sighted are alike
        for c in range(items.size):
            items[c] *= alike * spots.chance[e, h, c]
            spots.total[e] += items[c]
        scattered(prior, items, box, starts)
        if alike > 1:
            spots.chance[e, h + 1 : many] = spots.chance[e, h]
        if spots.sighted[e, h] == 0:
            break
    _carry(share, unseen, starts, nodes, expected)
