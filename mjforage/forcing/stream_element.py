"""The bicubic Hermite element of Bogner, Fox and Schmit (1965) for a stream function psi.

Every vertex of a grid of squares has psi, dpsi/dx, dpsi/dy and d2psi/dxdy, so that the velocity
u = dpsi/dy, v = -dpsi/dx is a continuous function of place and free of divergence exactly.
"""

import math

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel

FloatArray = NDArray[np.float64]

# Integrals of products of the Hermite basis on [0, 1] (value and slope at 0, then at 1), of its
# first and second derivatives, of the basis and of its derivative: the beam element's tables.
_VALUES: FloatArray = (
    np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]) / 420
)
_SLOPES: FloatArray = (
    np.array([[36, 3, -36, 3], [3, 4, -3, -1], [-36, -3, 36, -3], [3, -1, -3, 4]]) / 30
)
_BENDS: FloatArray = np.array(
    [[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]], np.float64
)
_VALUE: FloatArray = np.array([6, 1, 6, -1]) / 12
_SLOPE: FloatArray = np.array([-1.0, 0.0, 1.0, 0.0])

EAST = np.kron(_SLOPE, _VALUE).astype(
    np.float64
)  # (16,) integral of u, the work of a force to the east
NORTH = -np.kron(_VALUE, _SLOPE).astype(np.float64)  # (16,) of v, to the north
TURN = np.kron(_VALUE, _VALUE).astype(np.float64)  # (16,) of psi, of a force of uniform curl


def element_matrix(layer: float) -> FloatArray:
    """(16, 16) drag on the water of an element of side 1: of u^2 + v^2 + layer^2 |grad (u, v)|^2.

    Unknowns: 4 along y by 4 along x; `layer` in sides.
    """
    friction = np.kron(_VALUES, _SLOPES) + np.kron(_SLOPES, _VALUES)
    viscous = np.kron(_VALUES, _BENDS) + np.kron(_BENDS, _VALUES) + 2 * np.kron(_SLOPES, _SLOPES)
    matrix: FloatArray = friction + layer**2 * viscous
    return matrix


@kernel
def stream_velocity(
    patches: FloatArray,
    spacing_m: float,
    corner_m: float,
    x: float,
    y: float,
    east: float,
    north: float,
    turn: float,
) -> tuple[float, float]:
    """Velocity (u, v) [m/s] at (x, y) [m]; zero outside the map, NaN where the position is NaN.

    Parameters
    ----------
    patches, spacing_m, corner_m : as in `flow.Flow`
    east, north, turn : factor of each stream function [m/s]
    """
    p, q = (x - corner_m) / spacing_m, (y - corner_m) / spacing_m
    if math.isnan(p + q):
        return math.nan, math.nan
    across, up = patches.shape[1] - 1, patches.shape[0] - 1
    if not (0.0 <= p <= across and 0.0 <= q <= up):
        return 0.0, 0.0
    i, j = min(int(p), across - 1), min(int(q), up - 1)
    p, q = p - i, q - j
    u = v = 0.0
    for di in range(2):
        value_x, slope_x, dvalue_x, dslope_x = _hermite(p, di)
        for dj in range(2):
            value_y, slope_y, dvalue_y, dslope_y = _hermite(q, dj)
            at = patches[j + dj, i + di]
            psi = (east * at[0, 0] + north * at[0, 1] + turn * at[0, 2]) / spacing_m
            along_x = east * at[1, 0] + north * at[1, 1] + turn * at[1, 2]
            along_y = east * at[2, 0] + north * at[2, 1] + turn * at[2, 2]
            twist = (east * at[3, 0] + north * at[3, 1] + turn * at[3, 2]) * spacing_m
            u += value_x * (psi * dvalue_y + along_y * dslope_y)
            u += slope_x * (along_x * dvalue_y + twist * dslope_y)
            v -= value_y * (psi * dvalue_x + along_x * dslope_x)
            v -= slope_y * (along_y * dvalue_x + twist * dslope_x)
    return u, v


@kernel
def _hermite(s: float, end: int) -> tuple[float, float, float, float]:
    """Cubic Hermite basis of one end of [0, 1]: for value and slope, and their derivatives."""
    rest = 1.0 - s
    if end == 0:
        return (
            (1.0 + 2.0 * s) * rest * rest,
            s * rest * rest,
            -6.0 * s * rest,
            rest * (1.0 - 3.0 * s),
        )
    return s * s * (3.0 - 2.0 * s), -s * s * rest, 6.0 * s * rest, s * (3.0 * s - 2.0)
