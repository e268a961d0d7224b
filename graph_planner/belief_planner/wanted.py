"""What of all that is believed is wanted: items to collect, and nodes that are worth seeing."""

import numpy as np
from numpy.typing import NDArray

from graph_planner.belief_planner.beliefs import Beliefs
from graph_planner.belief_planner.stops import Floating
from graph_planner.belief_settings import BeliefSettings
from graph_planner.geodesics import Int32Array
from graph_planner.navigation import NavigationGraph
from graph_planner.task import Observation

PROBABLE = 40  # nodes of unseen items that foragers may go to
LEAST = 0.02  # unseen items worth a forager's thought
AGE_SHARE = 0.02  # what seeing a known item again is worth, per step unseen [item]
GHOST_SHARE = 0.02  # what seeing an outdated belief again is worth, per step unseen [item]
OLDEST = 30.0  # steps unseen after which those shares stop growing
FAILED = 0.2  # what an item counts where a hull gave it up a while ago


def summed(place: Int32Array, value: NDArray[np.float64], size: int) -> NDArray[np.float64]:
    """(size,) sum of the values at each place."""
    return np.bincount(place, value, minlength=size).astype(np.float64)


def list_items(
    beliefs: Beliefs,
    settings: BeliefSettings,
    graph: NavigationGraph,
    e: int,
    now: int,
    items: Floating,
) -> None:
    """Fill `items` with tracks, and with the nodes where most unseen items are expected.

    Parameters
    ----------
    e : row of the beliefs
    now : step that they are of
    """
    tracks, expected = beliefs.tracks, beliefs.expected[e]
    n = int(tracks.number[e])
    items.row[:n], items.col[:n] = tracks.row[e, :n], tracks.col[e, :n]
    failed = beliefs.later[e, tracks.node[e, :n]] > now
    items.weight[:n] = np.where(failed, FAILED, 1.0) * tracks.real[e, :n]
    if beliefs.spots.number[e] > 0 and settings.hotspot:
        best = np.argsort(-expected, kind="stable")[:PROBABLE]
        best = best[expected[best] > LEAST]
        m = best.size
        items.row[n : n + m] = graph.rows[best]
        items.col[n : n + m] = graph.cols[best]
        items.weight[n : n + m] = expected[best]
        n += m
    items.number[0] = n


def worth_seeing(
    beliefs: Beliefs, settings: BeliefSettings, seen: Observation, e: int
) -> NDArray[np.float64]:
    """What seeing each node (node,) is worth to the fleet in a row [item]."""
    now = int(seen.step[e]) - 1
    mass: NDArray[np.float64] = beliefs.expected[e].copy()
    if not settings.refresh:
        return mass
    tracks = beliefs.tracks
    n = int(tracks.number[e])
    age = np.minimum(OLDEST, now - tracks.seen[e, :n])
    mass += summed(tracks.node[e, :n], AGE_SHARE * age, mass.size)
    known = seen.known[e, : seen.n_known[e]]
    tracked = np.zeros(mass.size, np.bool_)
    tracked[tracks.node[e, :n]] = True
    age = np.minimum(OLDEST, now - seen.last_seen[e, known].astype(np.float64))
    mass[known] += np.where(tracked[known], 0.0, GHOST_SHARE * age)
    return mass
