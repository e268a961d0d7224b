"""Chance to detect an item in view, by its distance; and the number of items to expect after a scan
that may miss items or show false positives.

Distances are between the centres of nodes, so chances are listed by squared distance.
"""

import math

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined
from mjforage.mission.task import Task

Table = tuple[tuple[float, float], ...]


def squares_in_view(task: Task) -> int:
    """Number of squared distances, from 0, in any view of a fleet."""
    height, width = task.graph.shape
    radius = float(task.fleet.radius.max(initial=0.0))
    return int(min(radius * radius + 1e-9, height**2 + width**2)) + 1


def chances_by_square(
    squares: int, detection: float, half: float, slope: float, table: Table = ()
) -> NDArray[np.float64]:
    """Chance to detect an item, for squared distances from 0: (square,).

    Parameters
    ----------
    squares : how many, see `squares_in_view`
    detection, half, slope : p0 / (1 + exp((d - half) / slope)) at distance d [node]; p0 everywhere
        if `half` is 0
    table : (d, p) in its place, linear between them and constant beyond
    """
    distance = np.sqrt(np.arange(squares))
    if table:
        at, chance = np.array(table, np.float64).T
        return np.asarray(np.interp(distance, at, chance))
    if half == 0.0:
        return np.full(distance.size, detection)
    falling = np.minimum((distance - half) / slope, 700.0)  # beyond that exp overflows
    return np.array([detection / (1.0 + math.exp(x)) for x in falling])


@inlined
def corrected(density: float, chance: float, false_rate: float, seen: int) -> float:
    """Items expected in a node after a scan that showed some, from those expected before.

    (1 - p) D + c p D / (p D + f), the corrector of the probability hypothesis density filter
    (R. P. S. Mahler, IEEE Transactions on Aerospace and Electronic Systems 39, 2003); what is seen
    is there if there are no false positives.

    Parameters
    ----------
    density : D, items expected before
    chance : p, to detect one
    false_rate : f, items expected that are seen and are none
    seen : c, items
    """
    clutter = chance * density + false_rate
    real = chance * density / clutter if clutter > 0.0 else 1.0
    return (1.0 - chance) * density + seen * real


@inlined
def real_if_missed(real: float, chance: float) -> float:
    """Chance that an item is there that a scan has not shown, from the chance before.

    r (1 - p) / (1 - r p) (Musicki, Evans and Stankovic, IEEE Transactions on Automatic Control 39,
    1994).

    `real`: r; `chance`: p, to detect it.
    """
    return real * (1.0 - chance) / max(1e-12, 1.0 - real * chance)


@inlined
def real_if_seen(real: float, chance: float, false_rate: float) -> float:
    """The same of one that a scan has shown: r p / (r p + (1 - r) f)."""
    shows = real * chance
    return shows / (shows + (1.0 - real) * false_rate) if shows > 0.0 else 0.0


@inlined
def real_if_new(density: float, chance: float, false_rate: float) -> float:
    """Chance that a new sighting is an item: p D / (p D + f), 1 without false positives.

    `density`: D, unseen items expected there.
    """
    return chance * density / (chance * density + false_rate) if false_rate > 0.0 else 1.0
