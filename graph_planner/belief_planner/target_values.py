"""Target values of items to collect and of nodes to see, from the beliefs."""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.graph_planner.belief_planner.beliefs import Beliefs
from mjforage.graph_planner.belief_planner.boundary import Boundary
from mjforage.graph_planner.belief_planner.settings import BeliefSettings
from mjforage.graph_planner.belief_planner.stops import Floating
from mjforage.graph_planner.belief_planner.tracks import Tracks
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.mission.task import Observation

PROBABLE = 40  # nodes of unseen items that foragers may go to
LEAST = 0.02  # unseen items worth a forager's thought
AGE_SHARE = 0.02  # what seeing a known item again is worth, per step unseen [item]
GHOST_SHARE = 0.02  # what seeing an outdated belief again is worth, per step unseen [item]
OLDEST = 30.0  # steps unseen after which those shares stop growing
FAILED = 0.2  # what an item counts where a hull gave it up a while ago


def summed(place: Int32Array, value: NDArray[np.float64], size: int) -> NDArray[np.float64]:
    """(size,) sum of the values at each place."""
    return np.bincount(place, value, minlength=size).astype(np.float64)


@kernel
def likeliest(expected: NDArray[np.float64], best: NDArray[np.int64]) -> int:
    """Fill `best` with the nodes of more than `LEAST` items, most first, then the lower number.

    Returns: how many they are: as many as `best` has room for, at most.
    """
    number = 0
    for node in range(expected.size):
        items = expected[node]
        if items <= LEAST or (number == best.size and items <= expected[best[number - 1]]):
            continue
        place = min(number, best.size - 1)
        while place > 0 and expected[best[place - 1]] < items:
            best[place] = best[place - 1]
            place -= 1
        best[place] = node
        number = min(number + 1, best.size)
    return number


@kernel
def _list_items(
    tracks: Tracks,
    expected: NDArray[np.float64],
    later: NDArray[np.int64],
    boundary: Boundary,
    sightings: NDArray[np.int64],
    hotspot: bool,
    e: int,
    now: int,
    items: Floating,
) -> None:
    """As `TargetValues.list_items`; sightings (row,) so far, `hotspot` as in the settings."""
    n = tracks.number[e]
    for i in range(n):
        items.row[i], items.col[i] = tracks.row[e, i], tracks.col[e, i]
        failed = later[e, tracks.node[e, i]] > now
        items.weight[i] = (FAILED if failed else 1.0) * tracks.real[e, i]
    if sightings[e] > 0 and hotspot:
        best = np.empty(PROBABLE, np.int64)
        for k in range(likeliest(expected[e], best)):
            node = best[k]
            items.row[n], items.col[n] = boundary.rows[node], boundary.cols[node]
            items.weight[n] = expected[e, node]
            n += 1
    items.number[0] = n


@kernel
def _worth_seeing(
    tracks: Tracks, expected: NDArray[np.float64], refresh: bool, seen: Observation, e: int
) -> NDArray[np.float64]:
    """As `TargetValues.worth_seeing`."""
    now = seen.step[e] - 1
    mass: NDArray[np.float64] = expected[e].copy()
    if not refresh:
        return mass
    again, tracked = np.zeros(mass.size), np.zeros(mass.size, np.bool_)
    for i in range(tracks.number[e]):
        again[tracks.node[e, i]] += AGE_SHARE * min(OLDEST, float(now - tracks.seen[e, i]))
        tracked[tracks.node[e, i]] = True
    mass += again
    for k in range(seen.n_known[e]):
        node = seen.known[e, k]
        if not tracked[node]:
            mass[node] += GHOST_SHARE * min(OLDEST, float(now - seen.last_seen[e, node]))
    return mass


class TargetValues:
    """Target values of the beliefs of a batch of rows."""

    def __init__(self, beliefs: Beliefs, settings: BeliefSettings, boundary: Boundary) -> None:
        believed = beliefs.tracks, beliefs.expected
        sightings = beliefs.spots.number
        about = *believed, beliefs.later, boundary, sightings, settings.hotspot
        self._list_items = BoundKernel(_list_items, *about)
        self._worth_seeing = BoundKernel(_worth_seeing, *believed, settings.refresh)

    def list_items(self, e: int, now: int, items: Floating) -> None:
        """Fill `items` with tracks, and with the nodes where most unseen items are expected.

        `e`: row of the beliefs; `now`: step that they are of.
        """
        self._list_items(e, now, items)

    def worth_seeing(self, seen: Observation, e: int) -> NDArray[np.float64]:
        """Worth (node,) of seeing each node to the fleet, in a row of a plain observation."""
        return self._worth_seeing(seen, e)
