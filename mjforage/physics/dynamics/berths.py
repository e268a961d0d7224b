"""Berths: places of vessels and items in nodes that outlines of quays reach into."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.wholes import floor
from mjforage.controllers.chart import (
    WALL_M,
    LandArray,
    grid_shape,
    has_walls,
    is_behind,
    is_cell_land,
    walls_at,
    way_to_cell,
    way_to_wall,
)
from mjforage.physics.dynamics.tracks import RADIUS_M

FloatArray = NDArray[np.float64]
BERTH_M = 0.2  # between quays and a vessel that turns in its node, or leaves it; an estimate
LONGEST = 3
PART_M = 0.5  # steps in which ways between berths are looked at
SIDES = ((1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1))
TRIES = 17  # places tried along a side of a node, and from an item to its node's middle


class Turn(NamedTuple):
    """Room that vessels need."""

    radius_m: float  # to turn about midships
    half_beam_m: float


def turn_of(half_sizes: FloatArray) -> Turn:
    """Room for the largest of (vessel, 2) half lengths and beams [m]."""
    reach = np.array((np.hypot(*half_sizes.T), half_sizes[:, 1]))
    return Turn(*(BERTH_M + reach.max(axis=1)))


@kernel
def room_of_walls(land: LandArray, i: int, j: int, x: float, y: float) -> float:
    """Way [m] from a point to the walls of cell (i, j)."""
    least = np.inf
    for k in walls_at(land, i + 1, j + 1):
        dx, dy, _ = way_to_wall(land, k, x, y)
        least = min(least, math.hypot(dx, dy) - WALL_M)
    return least


@kernel
def room_at(land: LandArray, pitch: float, x: float, y: float, far: float) -> float:
    """Way [m] from a point to quays in the nine cells around it, at most `far`."""
    i, j, least = floor(x / pitch + 0.5), floor(y / pitch + 0.5), far
    for m in range(i - 1, i + 2):
        for n in range(j - 1, j + 2):
            if is_cell_land(land, m, n):
                dx, dy = way_to_cell(pitch, x, y, m, n)
                least = min(least, math.hypot(dx, dy))
            else:
                least = min(least, room_of_walls(land, m, n, x, y))
    return least


@kernel
def room_about(
    land: LandArray, pitch: float, x: float, y: float, ends: FloatArray, turn: Turn, least: float
) -> float:
    """Room [m] at a berth, at most `turn.radius_m`; on the ways from there half a beam is enough.

    Parameters
    ----------
    ends : (way, 2) berths to which ways lead, NaN for none [m]
    least : less room is not worth measuring
    """
    room, spare = room_at(land, pitch, x, y, turn.radius_m), turn.radius_m - turn.half_beam_m
    for k in range(len(ends)):
        dx, dy = ends[k, 0] - x, ends[k, 1] - y
        parts = 0 if math.isnan(dx) else math.ceil(math.hypot(dx, dy) / PART_M)
        for part in range(1, parts):
            if room < least:
                return room
            at_x, at_y = x + part / parts * dx, y + part / parts * dy
            room = min(room, room_at(land, pitch, at_x, at_y, turn.radius_m) + spare)
    return room


@kernel
def _ways(nodes: NDArray[np.int64], i: int, j: int, found: FloatArray, ends: FloatArray) -> None:
    """Write the berths to which moves lead from cell (i, j), in straight lines over nodes."""
    ends[:] = np.nan
    for k in range(len(ends)):
        di, dj = SIDES[k % 8]
        m, n, free = i + 1, j + 1, True
        for _ in range(k // 8 + 1):
            m, n = m + di, n + dj
            free = free and min(nodes[m, n], nodes[m - di, n], nodes[m, n - dj]) >= 0
            if not free:
                break
        if free:
            ends[k] = found[nodes[m, n]]


@kernel
def _is_walled(land: LandArray, i: int, j: int, reach: int) -> bool:
    """True if there is a wall in the cells around cell (i, j) of the map, so many each way."""
    columns, rows = grid_shape(land)
    for m in range(max(i + 1 - reach, 0), min(i + 2 + reach, columns)):
        for n in range(max(j + 1 - reach, 0), min(j + 2 + reach, rows)):
            if len(walls_at(land, m, n)):
                return True
    return False


@kernel
def _berths(
    land: LandArray, pitch: float, centres: FloatArray, turn: Turn, tries: FloatArray, moves: int
) -> FloatArray:
    """As `berths`, trying places (try, 2) off the middle in their order [node]."""
    found, nodes = centres.copy(), np.full(grid_shape(land), -1)
    ends = np.empty((8 * moves, 2))
    for node in range(len(centres)):
        nodes[round(centres[node, 0] / pitch) + 1, round(centres[node, 1] / pitch) + 1] = node
    for count in range(2 * len(centres)):  # twice, for ways have two ends
        node = count % len(centres)
        x, y = centres[node]
        i, j, most = round(x / pitch), round(y / pitch), -np.inf
        if not _is_walled(land, i, j, moves + 1):
            continue
        _ways(nodes, i, j, found, ends)
        for off in pitch * tries:
            at_x, at_y = x + off[0], y + off[1]
            room = room_about(land, pitch, at_x, at_y, ends, turn, most)
            if room > most and not is_behind(land, pitch, i, j, at_x, at_y):
                most, found[node, 0], found[node, 1] = room, at_x, at_y
                if room >= turn.radius_m:
                    break
    return found


def berths(
    land: LandArray, pitch: float, centres: FloatArray, turn: Turn, moves: int = 1
) -> FloatArray:
    """(node, 2) where vessels lie in their nodes [m]: nearest to the middle with enough room.

    Without such a place it is that with the most room, and without walls always the middle.

    Parameters
    ----------
    centres : (node, 2) [m]
    moves : nodes of a decision, at most; longer ways than `LONGEST` nodes are not looked at
    """
    if not has_walls(land):
        return centres
    side = (np.arange(TRIES) - TRIES // 2) / TRIES
    tries = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
    nearest = np.argsort(np.hypot(*tries.T), kind="stable")
    return _berths(land, pitch, centres, turn, tries[nearest], min(moves, LONGEST))


@kernel
def clear_of_walls(land: LandArray, pitch: float, node_xy: FloatArray, xy: FloatArray) -> None:
    """Move items that lie on land or in a wall towards the middle of their node, until clear.

    `node_xy`: (item, 2) middles of their nodes [m]; `xy`: (item, 2) written [m].
    """
    for k in range(len(xy) if has_walls(land) else 0):
        i, j = round(node_xy[k, 0] / pitch), round(node_xy[k, 1] / pitch)
        x, y = xy[k]
        for part in range(TRIES + 1):
            xy[k] = np.array([x, y]) + part / TRIES * (node_xy[k] - np.array([x, y]))
            behind = is_behind(land, pitch, i, j, xy[k, 0], xy[k, 1])
            room = room_of_walls(land, i, j, xy[k, 0], xy[k, 1])
            if room > RADIUS_M and not behind:
                break
