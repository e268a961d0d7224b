"""Quays and the map's edge as static geoms of the world.

Without outlines quays are rectangles of land cells. With them each edge is a wall; rectangles then
hold items alone, which stay in nodes.
"""

import math

import mujoco
import numpy as np
from numpy.typing import NDArray

from mjforage.controllers.chart import NO_WALLS, WALL_M
from mjforage.physics.scene.rectangles import merged_rectangles
from mjforage.scenario.place import Place

DEPTH_M, FREEBOARD_M = 1.0, 0.6  # of a quay, below and above the water
BANK, ITEM = 8, 4  # bits of contacts of a rectangle that holds items alone, and of items
CORNER_M = 0.08  # by which walls end before a corner: farther than a hull goes in a step
TURN = 0.01  # sine of a turn that is none
JOINT_M = 0.01  # between ends of walls that meet
PROBE_M = 0.005  # off an edge, for the side on which there is land
EDGE_M = 2.0  # thickness and half height of the invisible walls around the map


def walls_of(place: Place | None) -> NDArray[np.float64]:
    """(edge, 5) walls of a place's outlines, as of `controllers.Chart`, with land to their right.

    Those along its own border are left out.
    """
    if place is None or not place.quays:
        return NO_WALLS
    rings = [np.array(ring) for ring in place.quays]
    start, end = (np.concatenate([xy[cut] for xy in rings]) for cut in (np.s_[:-1], np.s_[1:]))
    way = end - start
    length = np.hypot(*way.T)
    way /= np.maximum(length, 1e-9)[:, None]
    beside = 0.5 * (start + end) + PROBE_M * np.stack((-way[:, 1], way[:, 0]), axis=1)
    way[_within(beside, start, end)] *= -1.0
    half = 0.5 * place.pitch_m
    far = place.pitch_m * np.array([place.columns, place.rows]) - half
    both = np.stack((start, end))
    border = [np.abs(both - side).max(axis=0) < WALL_M for side in (-half, far)]
    kept = (length > 0.0) & ~np.any(border, axis=(0, 2))
    walls = np.concatenate((0.5 * (start + end), way, 0.5 * length[:, None]), axis=1)
    return np.asarray(walls[kept])


def _within(
    points: NDArray[np.float64], start: NDArray[np.float64], end: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """(point,) whether it lies within an odd number of outlines, of which these are the edges."""
    inside = np.zeros(len(points), np.bool_)
    for (ax, ay), (bx, by) in zip(start, end, strict=True):
        across = (points[:, 1] < ay) != (points[:, 1] < by)
        share = (points[across, 1] - ay) / (by - ay) if across.any() else 0.0
        inside[across] ^= points[across, 0] < ax + share * (bx - ax)
    return inside


def add_quays(
    spec: mujoco.MjSpec,
    navigable: NDArray[np.bool_],
    pitch_m: float,
    walls: NDArray[np.float64] = NO_WALLS,
) -> None:
    """Add a box per merged rectangle of land and a wall along each edge of the map.

    Parameters
    ----------
    navigable : (row, column) bool, row 0 in the north
    pitch_m : side of a cell [m]; the centre of the south-west cell is the origin
    walls : (wall, 5) as of `controllers.Chart`, in the place of the rectangles for all but items
    """
    _add_walls(spec, walls)
    rows, cols = navigable.shape
    for i, (top, left, bottom, right) in enumerate(merged_rectangles(~navigable)):
        low = (left - 0.5) * pitch_m, (rows - bottom - 0.5) * pitch_m
        high = (right - 0.5) * pitch_m, (rows - top - 0.5) * pitch_m
        box = _box(spec, f"{'bank' if len(walls) else 'quay'}-{i}", low, high, "quay")
        if len(walls):
            box.contype, box.conaffinity, box.group = BANK, ITEM, 5
    west, south = -0.5 * pitch_m, -0.5 * pitch_m
    east, north = west + cols * pitch_m, south + rows * pitch_m
    t = EDGE_M
    _box(spec, "edge-west", (west - t, south - t), (west, north + t), "edge")
    _box(spec, "edge-east", (east, south - t), (east + t, north + t), "edge")
    _box(spec, "edge-south", (west, south - t), (east, south), "edge")
    _box(spec, "edge-north", (west, north), (east, north + t), "edge")


def _box(
    spec: mujoco.MjSpec,
    name: str,
    low: tuple[float, float],
    high: tuple[float, float],
    default: str,
) -> mujoco.MjsGeom:
    """One static box from corner `low` to corner `high` [m]."""
    bottom, top = (-DEPTH_M, FREEBOARD_M) if default == "quay" else (-EDGE_M, EDGE_M)
    half = [0.5 * (high[0] - low[0]), 0.5 * (high[1] - low[1]), 0.5 * (top - bottom)]
    centre = [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), 0.5 * (bottom + top)]
    box, look = mujoco.mjtGeom.mjGEOM_BOX, spec.find_default(default)
    return spec.worldbody.add_geom(look, name=name, type=box, pos=centre, size=half)


def _add_walls(spec: mujoco.MjSpec, walls: NDArray[np.float64]) -> None:
    """Add a thin box per wall. At a corner of the land it ends a little before the corner.

    The fast integrator lets a step end at the face that is ahead, so the end of the next box must
    not lie ahead of a hull that slides past the corner.
    """
    look, middle, high = spec.find_default("quay"), 0.5 * (FREEBOARD_M - DEPTH_M), 0.5
    high *= FREEBOARD_M + DEPTH_M
    start, end = (walls[:, :2] + side * walls[:, 4:] * walls[:, 2:4] for side in (-1, 1))
    for i, (x, y, c, s, half) in enumerate(walls):
        before = walls[np.abs(end - start[i]).max(axis=1) < JOINT_M]
        after = walls[np.abs(start - end[i]).max(axis=1) < JOINT_M]
        juts = [
            bool((sign * (one[:, 2] * s - one[:, 3] * c) < -TURN).any())
            for sign, one in ((1, before), (-1, after))
        ]
        size = [max(half - 0.5 * CORNER_M * sum(juts), JOINT_M), WALL_M, high]
        turned, off = 0.5 * math.atan2(s, c), 0.5 * CORNER_M * (juts[0] - juts[1])
        box = spec.worldbody.add_geom(look, name=f"quay-{i}", type=mujoco.mjtGeom.mjGEOM_BOX)
        box.pos, box.size = [x + off * c, y + off * s, middle], size
        box.quat = [math.cos(turned), 0.0, 0.0, math.sin(turned)]
