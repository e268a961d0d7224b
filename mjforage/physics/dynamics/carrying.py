"""Velocity at which wind and water carry items: the truth for oracle bounds and central critics."""

import numpy as np
from numpy.typing import NDArray

from mjforage.graph_planner.graph.navigation import NavigationGraph
from mjforage.mission.initial_state import LEEWAY
from mjforage.physics.scene.debris import load_debris
from mjforage.physics.weather import Field

_DIGITS = 6  # of a leeway over the paper's, which the areas of a class give no better

FloatArray = NDArray[np.float64]


def carried(
    field: Field,
    graph: NavigationGraph,
    wind_rc: FloatArray,
    period_s: float,
    t_s: FloatArray,
    rc: FloatArray,
    leeway: FloatArray,
) -> FloatArray:
    """Steady velocity of items in the mean wind, weaker in the lee, and the current of the moment.

    An item that has share L of the wind in still water has L of the wind and 1 - L of a current.

    Parameters
    ----------
    wind_rc : (episode, 2) drift by the mean wind of an item of the paper's leeway [node/step]
    period_s, t_s : of a decision, and (episode,) now [s]
    rc : (episode, place, 2) where [node]
    leeway : (episode, place) share of the wind

    Returns
    -------
    (episode, place, 2) [node/step]
    """
    xy = graph.metres(rc)
    current, share = field.current(t_s, xy), field.sheltered(xy)
    current_rc = np.stack((-current[..., 1], current[..., 0]), axis=-1) * period_s / graph.pitch_m
    by_wind = (np.round(leeway / LEEWAY, _DIGITS) * share)[..., None] * wind_rc[:, None]
    result: FloatArray = by_wind + (1.0 - leeway)[..., None] * current_rc
    return result


def leeways(classes: FloatArray) -> FloatArray:
    """(episode, item) leeway of items of some classes, the paper's where an item is no more."""
    known = np.array([kind.leeway for kind in load_debris()] + [LEEWAY])
    found: FloatArray = known[np.where(classes < 0, len(known) - 1, classes).astype(np.int64)]
    return found
