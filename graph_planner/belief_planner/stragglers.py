"""The last unseen items, one by one: particles that no view of the episode has met.

A particle is an item that may exist: either one that was never seen, drawn from the belief about
the hotspots, or one that was seen and lost, drawn from where it was last. It drifts near the
estimate with noise of its own, is run through all the views of the episode since, and is thrown
away if one of them shows it or a forager would have collected it. Those left over are
where unseen items can be. Each of the first kind stands for (items in all) / (particles tried).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined, kernel
from mjforage.base.randomness import bits, normal, uniform
from mjforage.graph_planner.belief_planner.boundary import Boundary, settled
from mjforage.graph_planner.belief_planner.hotspots import Hotspots, believed
from mjforage.graph_planner.belief_planner.missed_detections import (
    MissedDetections,
    missed,
    missed_detections,
)
from mjforage.graph_planner.belief_planner.wind import Wind
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.walls import own_node

UNSEEN = 200  # of them kept
LOSSES = 32  # items lost at a time
TRIES_LOST = 80  # particles tried for each
EVERY = 3  # steps whose noise is drawn at once
FOUND_GATE = 2.0  # a new track so near to a lost item's particle is that item [node]
NEVER_SEEN = -1
_DRAWS = 16  # numbers that a particle may draw per step
_TO_SYMMETRIC = 2.0 / (1 << 32)


class Stragglers(NamedTuple):
    """Memory of a batch: all views and ways so far, lost items, and particles."""

    views: NDArray[np.uint64]  # (episode, step, word) a bit per node
    foragers: Int32Array  # (episode, step, forager) nodes
    number: NDArray[np.int64]  # (episode,) particles
    tried: NDArray[np.int64]  # (episode,) of unseen items
    labels: NDArray[np.int64]  # (episode,) particles ever drawn
    source: NDArray[np.int64]  # (episode, particle) lost item, or NEVER_SEEN
    label: NDArray[np.int64]  # (episode, particle) its number, which its random draws go by
    row: NDArray[np.float64]  # (episode, particle) [node]
    col: NDArray[np.float64]
    drift: NDArray[np.float64]  # (episode, particle, 2) [node/step]
    begun: NDArray[np.float64]  # (episode, particle, 2) row and column where it began [node]
    since: NDArray[np.int64]  # (episode, particle) and the step
    lost: NDArray[np.int64]  # (episode, loss) particles it began with, 0 free
    noise: float  # largest own drift per axis [node/step]
    missed_detections: MissedDetections  # of those views


def stragglers(
    episodes: int,
    nodes: int,
    horizon: int,
    foragers: int,
    noise: float,
    may_miss: MissedDetections | None = None,
) -> Stragglers:
    """Nothing lost and no particles yet.

    Parameters
    ----------
    noise : largest own drift of an item per axis [node/step]
    may_miss : what views may miss; absent: nothing
    """
    both = (episodes, UNSEEN + LOSSES * TRIES_LOST // 4)
    return Stragglers(
        np.zeros((episodes, horizon + 1, nodes // 64 + 1), np.uint64),
        np.full((episodes, horizon + 1, foragers), -1, np.int32),
        number=np.zeros(episodes, np.int64),
        tried=np.zeros(episodes, np.int64),
        labels=np.zeros(episodes, np.int64),
        source=np.zeros(both, np.int64),
        label=np.zeros(both, np.int64),
        row=np.zeros(both),
        col=np.zeros(both),
        drift=np.zeros((*both, 2)),
        begun=np.zeros((*both, 2)),
        since=np.zeros(both, np.int64),
        lost=np.zeros((episodes, LOSSES), np.int64),
        noise=noise,
        missed_detections=may_miss or missed_detections(episodes, nodes, horizon, np.ones(1)),
    )


@kernel
def remember(
    stragglers: Stragglers,
    e: int,
    now: int,
    last_seen: NDArray[np.int16],
    foragers_at: Int32Array,
) -> None:
    """Keep the view and the foragers' nodes (forager,), negative where not known, of step `now`."""
    words = stragglers.views[e, now]
    for node in range(last_seen.size):
        if last_seen[node] == now:
            words[node >> 6] |= np.uint64(1) << np.uint64(node & 63)
    for f in range(foragers_at.size):
        if foragers_at[f] >= 0:
            stragglers.foragers[e, now, f] = foragers_at[f]


@inlined
def was_in_view(views: NDArray[np.uint64], step: int, node: int) -> bool:
    """Whether a view of the episode, at a step, held a node."""
    return bool((views[step, node >> 6] >> np.uint64(node & 63)) & np.uint64(1) != 0)


@kernel
def _is_missed(
    missed_detections: MissedDetections, key: np.uint64, e: int, label: int, step: int, node: int
) -> bool:
    """A view misses a particle in it; `label` is that of its first draw."""
    if missed_detections.near.shape[1] == 0:
        return False
    return bool(uniform(key, label + 1, step) < missed(missed_detections, e, step, node))


@kernel
def _survives(
    stragglers: Stragglers,
    boundary: Boundary,
    key: np.uint64,
    e: int,
    i: int,
    first: int,
    last: int,
) -> bool:
    """Let particle i drift into the steps from `first` to `last`.

    Returns
    -------
    False if it is collected before one of them, or seen in one of them
    """
    views, foragers, framed = stragglers.views[e], stragglers.foragers[e], boundary.framed
    row, col, node = settled(boundary, stragglers.row[e, i], stragglers.col[e, i])
    drift_row, drift_col = stragglers.drift[e, i, 0], stragglers.drift[e, i, 1]
    noise, label = stragglers.noise * np.sqrt(EVERY), _DRAWS * stragglers.label[e, i]
    alive = True
    for step in range(first, last + 1):
        for f in range(foragers.shape[1]):
            alive = alive and foragers[step, f] != node
        if not alive:
            break
        row += drift_row
        col += drift_col
        if step % EVERY == 0:
            draw = bits(key, label, step)
            row += noise * (np.float64(draw >> np.uint64(32)) * _TO_SYMMETRIC - 1.0)
            col += noise * (np.float64(draw & np.uint64(0xFFFFFFFF)) * _TO_SYMMETRIC - 1.0)
        node = own_node(framed, row, col)
        if node < 0:
            row, col, node = settled(boundary, row, col)
        alive = not was_in_view(views, step, node) or _is_missed(
            stragglers.missed_detections, key, e, label, step, node
        )
        if not alive:
            break
    stragglers.row[e, i], stragglers.col[e, i] = row, col
    return alive


@kernel
def _remove(stragglers: Stragglers, e: int, i: int) -> None:
    """Remove particle i; the last one takes its place."""
    stragglers.number[e] -= 1
    last = stragglers.number[e]
    stragglers.source[e, i] = stragglers.source[e, last]
    stragglers.label[e, i] = stragglers.label[e, last]
    stragglers.row[e, i] = stragglers.row[e, last]
    stragglers.col[e, i] = stragglers.col[e, last]
    stragglers.drift[e, i] = stragglers.drift[e, last]
    stragglers.begun[e, i] = stragglers.begun[e, last]
    stragglers.since[e, i] = stragglers.since[e, last]


@kernel
def advance(stragglers: Stragglers, boundary: Boundary, key: np.uint64, e: int, now: int) -> None:
    """Let the particles drift into step `now`, and throw away those that are in view."""
    i = 0
    while i < stragglers.number[e]:
        if _survives(stragglers, boundary, key, e, i, now, now):
            i += 1
        else:
            _remove(stragglers, e, i)


@kernel
def retest(stragglers: Stragglers, boundary: Boundary, key: np.uint64, e: int, now: int) -> None:
    """Run the particles again, up to step `now`, through views that late looks have added to.

    Their drift and noise are those of before, so those that live are where they were.
    """
    i = 0
    while i < stragglers.number[e]:
        since = stragglers.since[e, i]
        stragglers.row[e, i] = stragglers.begun[e, i, 0]
        stragglers.col[e, i] = stragglers.begun[e, i, 1]
        met = _began_in_view(stragglers, boundary, key, e, i)
        if not met and _survives(stragglers, boundary, key, e, i, since + 1, now):
            i += 1
        else:
            _remove(stragglers, e, i)


@kernel
def _began_in_view(
    stragglers: Stragglers, boundary: Boundary, key: np.uint64, e: int, i: int
) -> bool:
    """Whether a particle that was never seen began where a view of step 0 shows it."""
    row, col = stragglers.begun[e, i, 0], stragglers.begun[e, i, 1]
    _, _, node = settled(boundary, row, col)
    if stragglers.source[e, i] != NEVER_SEEN or not was_in_view(stragglers.views[e], 0, node):
        return False
    label = _DRAWS * stragglers.label[e, i]
    return not _is_missed(stragglers.missed_detections, key, e, label, 0, node)


@kernel
def _run(
    stragglers: Stragglers,
    wind: Wind,
    boundary: Boundary,
    key: np.uint64,
    e: int,
    source: int,
    row: float,
    col: float,
    since: int,
    now: int,
) -> bool:
    """Run a new particle from where it was at step `since` through the views; keep it if it lives.

    Its number must have been counted in `labels` already.
    """
    i, label = stragglers.number[e], stragglers.labels[e] - 1
    if i == stragglers.row.shape[1]:
        return False
    row, col, _ = settled(boundary, row, col)
    stragglers.row[e, i], stragglers.col[e, i] = row, col
    stragglers.begun[e, i, 0], stragglers.begun[e, i, 1], stragglers.since[e, i] = row, col, since
    stragglers.label[e, i], stragglers.source[e, i] = label, source
    for axis in range(2):
        draw = normal(key, _DRAWS // 2 * label + 4 + axis, 0)
        stragglers.drift[e, i, axis] = wind.mean[e, axis] + wind.deviation[e, axis] * draw
    if not _survives(stragglers, boundary, key, e, i, since + 1, now):
        return False
    stragglers.number[e] = i + 1
    return True


@kernel
def lose(
    stragglers: Stragglers,
    wind: Wind,
    boundary: Boundary,
    key: np.uint64,
    e: int,
    node: int,
    since: int,
    now: int,
) -> None:
    """Draw particles for an item that was last seen in a node at step `since`, and is not found."""
    place = -1
    for k in range(LOSSES):
        if stragglers.lost[e, k] == 0:
            place = k
            break
    if place < 0:
        return
    for _ in range(TRIES_LOST):
        if stragglers.lost[e, place] == TRIES_LOST // 4:
            break
        stragglers.labels[e] += 1
        first = _DRAWS * (stragglers.labels[e] - 1)
        row = boundary.rows[node] + uniform(key, first + 2, 0) - 0.5
        col = boundary.cols[node] + uniform(key, first + 3, 0) - 0.5
        if _run(stragglers, wind, boundary, key, e, place, row, col, since, now):
            stragglers.lost[e, place] += 1


@kernel
def find(stragglers: Stragglers, boundary: Boundary, e: int, node: int) -> bool:
    """Whether a newly seen item is a lost one, by the nearest particle; that loss is then over."""
    nearest, best = FOUND_GATE**2, NEVER_SEEN
    for i in range(stragglers.number[e]):
        if stragglers.source[e, i] != NEVER_SEEN:
            down = boundary.rows[node] - stragglers.row[e, i]
            right = boundary.cols[node] - stragglers.col[e, i]
            if down * down + right * right < nearest:
                nearest, best = down * down + right * right, stragglers.source[e, i]
    if best == NEVER_SEEN:
        return False
    i = 0
    while i < stragglers.number[e]:
        if stragglers.source[e, i] == best:
            _remove(stragglers, e, i)
        else:
            i += 1
    stragglers.lost[e, best] = 0
    return True


@kernel
def _drawn(chances: NDArray[np.float64], draw: float) -> int:
    """First index at which the running sum (ending in 1) exceeds the draw."""
    return min(int(np.searchsorted(chances, draw, side="right")), chances.size - 1)


@kernel
def try_more(
    stragglers: Stragglers,
    spots: Hotspots,
    wind: Wind,
    boundary: Boundary,
    key: np.uint64,
    e: int,
    now: int,
    spread: float,
    tries: int,
) -> None:
    """Draw particles of unseen items, and keep those that no view up to step `now` has met.

    Parameters
    ----------
    key : of the policy's random stream
    spread : standard deviation of a hotspot per axis [node]
    tries : particles tried
    """
    many, kept = 0, 0
    for h in range(believed(spots, e)):
        many += spots.sighted[e, h] > 0
    for i in range(stragglers.number[e]):
        kept += stragglers.source[e, i] == NEVER_SEEN
    if many == 0 or kept >= UNSEEN:
        return
    running = np.empty((many, spots.chance.shape[2]))
    for h in range(many):
        running[h] = np.cumsum(spots.chance[e, h])
    for _ in range(tries):
        if kept == UNSEEN:
            break
        label = stragglers.labels[e]
        stragglers.labels[e] += 1
        stragglers.tried[e] += 1
        first = _DRAWS * label
        hotspot = _drawn(running[label % many], uniform(key, first + 2, 0))
        row = boundary.rows[hotspot] + spread * normal(key, first // 2 + 2, 0)
        col = boundary.cols[hotspot] + spread * normal(key, first // 2 + 3, 0)
        _, _, node = settled(boundary, row, col)
        seen = was_in_view(stragglers.views[e], 0, node)
        if not seen or _is_missed(stragglers.missed_detections, key, e, first, 0, node):
            kept += _run(stragglers, wind, boundary, key, e, NEVER_SEEN, row, col, 0, now)


@kernel
def expect_stragglers(
    stragglers: Stragglers,
    boundary: Boundary,
    e: int,
    total: float,
    real: float,
    expected: NDArray[np.float64],
) -> None:
    """Add unseen and lost items to expected (node,).

    Parameters
    ----------
    total : items of all hotspots; 0 leaves those out that were never seen
    real : chance that an item given up was there at all
    """
    for i in range(stragglers.number[e]):
        source = stragglers.source[e, i]
        _, _, node = settled(boundary, stragglers.row[e, i], stragglers.col[e, i])
        if source == NEVER_SEEN:
            expected[node] += total / stragglers.tried[e]
        else:
            expected[node] += real / stragglers.lost[e, source]
