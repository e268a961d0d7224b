"""A steady harbour circulation that no quay lets through, from a stream function on the map.

Wind stress of uniform curl drives the water, friction at the bottom holds it, and exchange of
momentum sideways (lateral eddy viscosity) makes it stand still at quays, over a layer of width L:

    -laplace(psi) + L^2 laplace(laplace(psi)) = 1,    psi = dpsi/dn = 0 at quays and the map's rim,

the depth-averaged steady balance of Stommel and of Munk without the Earth's rotation (e.g.
Pedlosky, Geophysical Fluid Dynamics, chapter 5). It is solved with the bicubic Hermite element of
Bogner, Fox and Schmit (1965), so that the solution is a function of place, not numbers at vertices:
u = dpsi/dy, v = -dpsi/dx is continuous, free of divergence exactly, and zero at quays, through them
and along them.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import spsolve

from graph_planner.compiled import kernel
from graph_planner.navigation import NavigationGraph

FINEST = 3  # elements along a cell
LAYER = 0.5  # L, width of the layer at quays [cell]; an estimate, half the narrowest corridor
_MANY = 12_000  # elements; beyond it they are larger
_SAMPLES = 5  # per element and axis, where the peak speed is looked for

FloatArray = NDArray[np.float64]

# Integrals of products of the Hermite basis on [0, 1] (value and slope at 0, then at 1), of their
# first and second derivatives, and of the basis itself: the beam element's tables.
_VALUES: FloatArray = (
    np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]) / 420
)
_SLOPES: FloatArray = (
    np.array([[36, 3, -36, 3], [3, 4, -3, -1], [-36, -3, 36, -3], [3, -1, -3, 4]]) / 30
)
_BENDS: FloatArray = np.array(
    [[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]], np.float64
)
_LOADS: FloatArray = np.array([6, 1, 6, -1]) / 12


@dataclass(frozen=True, eq=False)
class Circulation:
    """Stream function of a map, scaled to a peak speed of 1 m/s, counter-clockwise.

    Attributes
    ----------
    patches : (y vertex, x vertex, 4) psi [m2/s], dpsi/dx, dpsi/dy [m/s], d2psi/dxdy [1/s]
    spacing_m : between vertices
    corner_m : x and y of the first vertex, the outer corner of the south-west cell
    """

    patches: FloatArray
    spacing_m: float
    corner_m: float


@kernel
def circulation_velocity(
    patches: FloatArray, spacing_m: float, corner_m: float, x: float, y: float
) -> tuple[float, float]:
    """Velocity (u, v) [m/s] at (x, y) [m]; zero outside the map, NaN where the position is NaN."""
    p, q = (x - corner_m) / spacing_m, (y - corner_m) / spacing_m
    if math.isnan(p + q):
        return math.nan, math.nan
    if not (0.0 <= p < patches.shape[1] - 1 and 0.0 <= q < patches.shape[0] - 1):
        return 0.0, 0.0
    i, j = int(p), int(q)
    p, q = p - i, q - j
    u = v = 0.0
    for di in range(2):
        value_x, slope_x, dvalue_x, dslope_x = _hermite(p, di)
        for dj in range(2):
            value_y, slope_y, dvalue_y, dslope_y = _hermite(q, dj)
            psi, along_x = patches[j + dj, i + di, 0] / spacing_m, patches[j + dj, i + di, 1]
            along_y, twist = patches[j + dj, i + di, 2], patches[j + dj, i + di, 3] * spacing_m
            u += value_x * (psi * dvalue_y + along_y * dslope_y)
            u += slope_x * (along_x * dvalue_y + twist * dslope_y)
            v -= value_y * (psi * dvalue_x + along_x * dslope_x)
            v -= slope_y * (along_y * dvalue_x + twist * dslope_x)
    return u, v


@kernel
def _hermite(s: float, end: int) -> tuple[float, float, float, float]:
    """Cubic Hermite basis of one end of [0, 1]: for value and slope, and their derivatives."""
    if end == 0:
        rest = 1.0 - s
        return (
            (1.0 + 2.0 * s) * rest * rest,
            s * rest * rest,
            -6.0 * s * rest,
            rest * (1.0 - 3.0 * s),
        )
    rest = 1.0 - s
    return s * s * (3.0 - 2.0 * s), -s * s * rest, 6.0 * s * rest, s * (3.0 * s - 2.0)


@kernel
def _peak_speed(patches: FloatArray, spacing_m: float) -> float:
    """Highest speed over a grid of points [m/s]."""
    peak = 0.0
    for j in range(_SAMPLES * (patches.shape[0] - 1)):
        for i in range(_SAMPLES * (patches.shape[1] - 1)):
            x, y = i * spacing_m / _SAMPLES, j * spacing_m / _SAMPLES
            u, v = circulation_velocity(patches, spacing_m, 0.0, x, y)
            peak = max(peak, u * u + v * v)
    return math.sqrt(peak)


def _element(layer: float) -> tuple[FloatArray, FloatArray]:
    """Matrix (16, 16) and load (16,) of an element of side 1; `layer` in sides.

    Unknowns: 4 along y by 4 along x. Integrating by parts with psi = dpsi/dn = 0 turns the mixed
    term of laplace(psi)^2 into that of first derivatives.
    """
    friction = np.kron(_VALUES, _SLOPES) + np.kron(_SLOPES, _VALUES)
    viscous = np.kron(_VALUES, _BENDS) + np.kron(_BENDS, _VALUES) + 2 * np.kron(_SLOPES, _SLOPES)
    matrix = (friction + layer**2 * viscous).astype(np.float64)
    return matrix, np.kron(_LOADS, _LOADS).astype(np.float64)


def _stream_function(water: NDArray[np.bool_], layer: float) -> FloatArray:
    """Solve on a grid of elements of side 1.

    Parameters
    ----------
    water : (y, x) bool elements
    layer : L in sides

    Returns
    -------
    (y vertex, x vertex, 4) psi, dpsi/dx, dpsi/dy, d2psi/dxdy; zero at vertices that touch land
    """
    framed = np.pad(water, 1)
    inner = framed[1:, 1:] & framed[:-1, 1:] & framed[1:, :-1] & framed[:-1, :-1]
    count = 4 * int(np.count_nonzero(inner))
    unknown = np.full((*inner.shape, 4), count)  # those at quays share one, to be dropped
    unknown[inner] = np.arange(count).reshape(-1, 4)
    y, x = np.nonzero(water)
    end, slope = np.divmod(np.arange(4), 2)  # of the 4 unknowns along one axis
    places = unknown[
        y[:, None, None] + end[:, None],
        x[:, None, None] + end,
        2 * slope[:, None] + slope,
    ].reshape(-1, 16)
    matrix, load = _element(layer)
    pairs = (np.repeat(places, 16, axis=1).ravel(), np.tile(places, (1, 16)).ravel())
    whole = sparse.coo_array((np.tile(matrix.ravel(), y.size), pairs), shape=(count + 1,) * 2)
    loads = np.bincount(places.ravel(), np.tile(load, y.size), minlength=count + 1)
    psi = np.zeros((*inner.shape, 4))
    psi[inner] = spsolve(
        whole.tocsc()[:count, :count], loads[:count], permc_spec="MMD_AT_PLUS_A"
    ).reshape(-1, 4)
    return psi


@lru_cache(maxsize=8)
def circulation(graph: NavigationGraph) -> Circulation:
    """The circulation of a map, solved once per map and kept.

    Parameters
    ----------
    graph : the map; land cells are quays, and so is everything outside
    """
    fine = FINEST
    while fine > 2 and len(graph) * fine**2 > _MANY:
        fine -= 1
    spacing_m = graph.pitch_m / fine
    water = np.kron(graph.navigable[::-1], np.ones((fine, fine), np.bool_))  # rows from the south
    patches = _stream_function(water, LAYER * fine)
    patches[..., 1:3] /= spacing_m
    patches[..., 3] /= spacing_m**2
    patches /= _peak_speed(patches, spacing_m)
    patches.setflags(write=False)
    return Circulation(patches, spacing_m, -0.5 * graph.pitch_m)
