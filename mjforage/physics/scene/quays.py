"""Quays and the map's edge as static boxes of the world."""

import mujoco
import numpy as np
from numpy.typing import NDArray

from mjforage.physics.scene.rectangles import merged_rectangles

DEPTH_M, FREEBOARD_M = 1.0, 0.6  # of a quay, below and above the water
EDGE_M = 2.0  # thickness and half height of the invisible walls around the map


def add_quays(spec: mujoco.MjSpec, navigable: NDArray[np.bool_], pitch_m: float) -> None:
    """Add a box per merged rectangle of land and a wall along each edge of the map.

    Parameters
    ----------
    navigable : (row, column) bool, row 0 in the north
    pitch_m : side of a cell [m]; the centre of the south-west cell is the origin
    """
    rows, cols = navigable.shape
    for i, (top, left, bottom, right) in enumerate(merged_rectangles(~navigable)):
        low = (left - 0.5) * pitch_m, (rows - bottom - 0.5) * pitch_m
        high = (right - 0.5) * pitch_m, (rows - top - 0.5) * pitch_m
        _box(spec, f"quay-{i}", low, high, "quay")
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
) -> None:
    """One static box from corner `low` to corner `high` [m]."""
    bottom, top = (-DEPTH_M, FREEBOARD_M) if default == "quay" else (-EDGE_M, EDGE_M)
    half = [0.5 * (high[0] - low[0]), 0.5 * (high[1] - low[1]), 0.5 * (top - bottom)]
    centre = [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), 0.5 * (bottom + top)]
    box, look = mujoco.mjtGeom.mjGEOM_BOX, spec.find_default(default)
    spec.worldbody.add_geom(look, name=name, type=box, pos=centre, size=half)
