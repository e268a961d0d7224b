"""The last unseen items, one by one: particles that no view of the episode has met.

A particle is an item that may exist: a hotspot and a start drawn from the belief, a drift near the
estimate, noise of its own. It is run through all the views of the episode so far and thrown away
if one of them would have shown it. Those left over are where unseen items can be; each stands for
(items in all) / (particles tried).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from graph_planner.belief_planner.hotspots import Hotspots
from graph_planner.belief_planner.shore import Shore, drifted, settled
from graph_planner.belief_planner.wind import Wind
from graph_planner.compiled import inlined, kernel
from graph_planner.geodesics import Int32Array
from graph_planner.randomness import normal, uniform

TRIES = 400  # particles tried in one decision
MOST = 300  # kept
_DRAWS = 16  # numbers that a particle may draw per step


class Stragglers(NamedTuple):
    """Memory of a batch: the views of all steps, and particles, the first `count` of an episode."""

    views: NDArray[np.uint64]  # (episode, step, word) a bit per node
    count: NDArray[np.int64]  # (episode,)
    tried: NDArray[np.int64]  # (episode,)
    label: NDArray[np.int64]  # (episode, particle) its number, which its random draws go by
    row: NDArray[np.float64]  # (episode, particle) [node]
    col: NDArray[np.float64]
    drift: NDArray[np.float64]  # (episode, particle, 2) [node/step]
    noise: float  # largest own drift per axis [node/step]


def stragglers(episodes: int, nodes: int, horizon: int, noise: float) -> Stragglers:
    """No particles yet."""
    both = (episodes, MOST)
    return Stragglers(
        np.zeros((episodes, horizon + 1, nodes // 64 + 1), np.uint64),
        np.zeros(episodes, np.int64),
        np.zeros(episodes, np.int64),
        np.zeros(both, np.int64),
        np.zeros(both),
        np.zeros(both),
        np.zeros((*both, 2)),
        noise,
    )


@kernel
def remember(stragglers: Stragglers, e: int, now: int, last_seen: NDArray[np.int16]) -> None:
    """Keep the view of step `now`."""
    words = stragglers.views[e, now]
    for node in range(last_seen.size):
        if last_seen[node] == now:
            words[node >> 6] |= np.uint64(1) << np.uint64(node & 63)


@inlined
def _met(views: NDArray[np.uint64], step: int, node: int) -> bool:
    return (views[step, node >> 6] >> np.uint64(node & 63)) & np.uint64(1) != 0


@kernel
def _carried(
    stragglers: Stragglers, shore: Shore, key: np.uint64, e: int, i: int, step: int
) -> int:
    """Let particle i drift into `step`; its node."""
    label, noise = stragglers.label[e, i], stragglers.noise
    shift_row = stragglers.drift[e, i, 0] + noise * (2.0 * uniform(key, _DRAWS * label, step) - 1.0)
    shift_col = stragglers.drift[e, i, 1] + noise * (
        2.0 * uniform(key, _DRAWS * label + 1, step) - 1.0
    )
    row, col, node = drifted(
        shore, stragglers.row[e, i], stragglers.col[e, i], shift_row, shift_col, 1.0
    )
    stragglers.row[e, i], stragglers.col[e, i] = row, col
    return int(node)


@kernel
def _drawn(chances: NDArray[np.float64], draw: float) -> int:
    """First index at which the running sum (ending in 1) exceeds the draw."""
    return min(np.searchsorted(chances, draw, side="right"), chances.size - 1)


@kernel
def advance(stragglers: Stragglers, shore: Shore, key: np.uint64, e: int, now: int) -> None:
    """Let the particles drift into step `now`, and throw away those that are in view."""
    i = 0
    while i < stragglers.count[e]:
        node = _carried(stragglers, shore, key, e, i, now)
        if _met(stragglers.views[e], now, node):
            stragglers.count[e] -= 1
            last = stragglers.count[e]
            stragglers.label[e, i] = stragglers.label[e, last]
            stragglers.row[e, i] = stragglers.row[e, last]
            stragglers.col[e, i] = stragglers.col[e, last]
            stragglers.drift[e, i] = stragglers.drift[e, last]
        else:
            i += 1


@kernel
def try_more(
    stragglers: Stragglers, spots: Hotspots, wind: Wind, shore: Shore, key: np.uint64, e: int,
    now: int, spread: float,
) -> None:
    """Draw particles and keep those that no view up to step `now` has met.

    Parameters
    ----------
    key : of the policy's random stream
    spread : standard deviation of a hotspot per axis [node]
    """
    many = 0
    for h in range(spots.sighted.shape[1]):
        many += spots.sighted[e, h] > 0
    if many == 0:
        return
    running = np.empty((many, spots.chance.shape[2]))
    for h in range(many):
        running[h] = np.cumsum(spots.chance[e, h])
    for _ in range(TRIES):
        i, label = stragglers.count[e], stragglers.tried[e]
        if i == MOST:
            break
        stragglers.tried[e] += 1
        stragglers.label[e, i] = label
        first = _DRAWS * label
        hotspot = _drawn(running[label % many], uniform(key, first + 2, 0))
        row = shore.rows[hotspot] + spread * normal(key, first // 2 + 2, 0)
        col = shore.cols[hotspot] + spread * normal(key, first // 2 + 3, 0)
        row, col, node = settled(shore, row, col)
        stragglers.row[e, i], stragglers.col[e, i] = row, col
        for axis in range(2):
            stragglers.drift[e, i, axis] = wind.mean[e, axis] + wind.deviation[e, axis] * normal(
                key, first // 2 + 4 + axis, 0
            )
        alive = not _met(stragglers.views[e], 0, node)
        step = 1
        while alive and step <= now:
            alive = not _met(
                stragglers.views[e], step, _carried(stragglers, shore, key, e, i, step)
            )
            step += 1
        if alive:
            stragglers.count[e] = i + 1


@kernel
def expect_stragglers(
    stragglers: Stragglers, shore: Shore, e: int, total: float, expected: NDArray[np.float64]
) -> None:
    """Fill expected (node,): unseen items in every node, of `total` items in all."""
    expected[:] = 0.0
    for i in range(stragglers.count[e]):
        _, _, node = settled(shore, stragglers.row[e, i], stragglers.col[e, i])
        expected[node] += total / stragglers.tried[e]
