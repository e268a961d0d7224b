"""The drift that all items share, from how far tracks have come between two sightings.

Per axis a likelihood over a grid of drifts. A way of d nodes in s steps is known to within the
squares of its two nodes and the items' own noise, which together look like a triangle. Ways along
quays that hold items up say nothing.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.graph_planner.belief_planner.boundary import Boundary, at_boundary
from mjforage.graph_planner.belief_planner.settings import BeliefSettings
from mjforage.graph_planner.belief_planner.tracks import Ended, Tracks

POINTS = 49
REACH = 2.4  # the grid reaches so many times the largest drift expected
BEYOND = 4.0  # loss of log-probability at twice the largest drift expected
TRUST = 0.5  # of a way's log-likelihood, because ways are not quite independent
AT_WALL = 0.4  # what a start against a wall adds to the triangle [node]
MODEL = 0.005  # deviation of what the model leaves out [node/step]
MISTAKE = 0.03  # of a likelihood's height: for ways of mistaken tracks


class Wind(NamedTuple):
    """Estimate of the drift in a batch."""

    grid: NDArray[np.float64]  # (point,) drifts [node/step]
    prior: NDArray[np.float64]  # (point,) log
    settled: NDArray[np.float64]  # (episode, 2, point) log-likelihood of the ways that ended
    mean: NDArray[np.float64]  # (episode, 2) [node/step]
    deviation: NDArray[np.float64]  # (episode, 2) [node/step]
    chance: NDArray[np.float64]  # (episode, 2, point) posterior
    noise: float  # variance of an item's own drift per step [node^2]


def wind(episodes: int, settings: BeliefSettings) -> Wind:
    """Wind estimate before any observation."""
    largest = max(settings.drift_node_per_step, 1e-6)
    grid = np.linspace(-REACH * largest, REACH * largest, POINTS)
    prior = -BEYOND * np.maximum(0.0, np.abs(grid) / largest - 1.0)
    share = np.array([math.exp(x) for x in prior])
    chance = share / share.sum()
    return Wind(
        grid,
        prior,
        np.zeros((episodes, 2, POINTS)),
        np.zeros((episodes, 2)),
        np.full((episodes, 2), np.sqrt((chance * grid**2).sum())),
        np.tile(chance, (episodes, 2, 1)),
        settings.noise_node_per_step**2 / 3.0,
    )


@kernel
def log_likelihood(
    shift: float,
    steps: float,
    up: int,
    down: int,
    noise: float,
    grid: NDArray[np.float64],
    total: NDArray[np.float64],
) -> None:
    """Add the log-likelihood of a way under every drift of a grid (point,), up to a constant.

    A node's square has variance 1/12 at either end; a triangle of variance v reaches sqrt(6 v).
    Walls end a way, and what begins at a wall may have lain against it.

    Parameters
    ----------
    shift, steps : nodes come in so many steps
    up, down : free cells to the walls on the negative and the positive side
    noise : variance of an item's own drift per step [node^2]
    total : (point,) added to
    """
    reach = np.sqrt(1.0 + 6.0 * noise * steps) + (AT_WALL if min(up, down) == 0 else 0.0)
    for p in range(grid.size):
        way = min(max(grid[p] * steps, -float(up)), float(down))
        total[p] += TRUST * np.log(MISTAKE + max(0.0, 1.0 - abs(shift - way) / reach))


@kernel
def settle(wind: Wind, boundary: Boundary, e: int, ways: Ended) -> None:
    """Store the evidence of ended tracks for good, and empty the list."""
    for i in range(ways.number[0]):
        if at_boundary(boundary, ways.start[i], ways.axis[i]):
            continue
        axis, room = ways.axis[i], boundary.room[ways.start[i], ways.axis[i]]
        log_likelihood(
            ways.shift[i],
            ways.steps[i],
            room[0],
            room[1],
            wind.noise,
            wind.grid,
            wind.settled[e, axis],
        )
    ways.number[0] = 0


@kernel
def estimate(wind: Wind, tracks: Tracks, boundary: Boundary, e: int) -> None:
    """Posterior, mean and deviation per axis from the ended ways and the tracks' ways so far."""
    grid = wind.grid
    for axis in range(2):
        places = boundary.rows if axis == 0 else boundary.cols
        total = wind.prior + wind.settled[e, axis]
        for i in range(tracks.number[e]):
            start = tracks.base_node[e, i, axis]
            steps = float(tracks.seen[e, i] - tracks.base[e, i, axis])
            if steps < 1.0 or at_boundary(boundary, start, axis):
                continue
            shift = float(places[tracks.seen_node[e, i]] - places[start])
            room = boundary.room[start, axis]
            log_likelihood(shift, steps, room[0], room[1], wind.noise, grid, total)
        chance = np.exp(total - total.max())
        chance /= chance.sum()
        mean = (chance * grid).sum()
        wind.chance[e, axis] = chance
        wind.mean[e, axis] = mean
        wind.deviation[e, axis] = np.sqrt((chance * (grid - mean) ** 2).sum() + MODEL**2)
