"""Steady flow on a map that no quay lets through: streams through its open border, a circulation.

A slope of the water's surface, or wind stress of uniform curl, drives the water; friction at the
bottom holds it, and exchange of momentum sideways (lateral eddy viscosity) makes it stand still at
quays, over a layer of width L:

    u - L^2 laplace(u) + grad(p) = force,    div(u) = 0,    u = 0 at quays,

the depth-averaged steady balance of Stommel and of Munk without the Earth's rotation (e.g.
Pedlosky, Geophysical Fluid Dynamics, chapter 5), and Brinkman's equation (1949). Of a uniform force
the vorticity obeys w = L^2 laplace(w), so that beyond the layer the streams are potential flow.
It is solved for the stream function, as the least of drag less work of the force:

- *streams*: a uniform force that moves open water at 1 m/s. At the border of the map water comes
  and goes as pressure lets it (p = 0 but for the layer's stress): psi is free there. It is one
  number along each piece of land, found with the rest, so that pressure is single-valued.
- *circulation*: a force of curl 1 between quays and rim, psi = dpsi/dn = 0 at both:
  -laplace(psi) + L^2 laplace(laplace(psi)) = 1.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage, sparse
from scipy.sparse.linalg import splu

from graph_planner.compiled import kernel
from graph_planner.navigation import NavigationGraph
from mjforage.physics.weather.stream_element import (
    EAST,
    NORTH,
    TURN,
    FloatArray,
    element_matrix,
    stream_velocity,
)

FINEST = 3  # elements along a cell
LAYER = 0.5  # L, width of the layer at quays [cell]; an estimate, half the narrowest corridor
_MANY = 12_000  # elements; beyond it they are larger
_SAMPLES = 5  # per element and axis, where the peak speed is looked for


@dataclass(frozen=True, eq=False)
class Flow:
    """Stream functions of a map, each of 1 m/s: to the east, to the north, and the circulation.

    Streams have the speed that the same slope gives to open water; the circulation, counter-
    clockwise, has its peak.

    Attributes
    ----------
    patches : (y vertex, x vertex, 4, 3) psi [m2/s], dpsi/dx, dpsi/dy [m/s], d2psi/dxdy [1/s]
    spacing_m : between vertices
    corner_m : x and y of the first vertex, the outer corner of the south-west cell
    """

    patches: FloatArray
    spacing_m: float
    corner_m: float


def has_open_border(graph: NavigationGraph) -> bool:
    """Whether there is water at the edge of the map, where streams come in and go out."""
    water = graph.navigable
    return bool(water[[0, -1]].any() or water[:, [0, -1]].any())


def _shore_unknowns(water: NDArray[np.bool_]) -> NDArray[np.int64]:
    """(y vertex, x vertex, 4) number of each unknown of the streams, -1 for those that are zero.

    At land slopes are zero and psi is one number per piece, which is zero for the largest; without
    land it is zero at one vertex.
    """
    pieces, count = ndimage.label(~water, np.ones((3, 3)))  # no water passes between corners
    framed = np.pad(pieces, 1)
    piece = np.max([framed[1:, 1:], framed[:-1, 1:], framed[1:, :-1], framed[:-1, :-1]], axis=0)
    unknown = np.full((*piece.shape, 4), -1)
    afloat = piece == 0
    unknown[afloat] = np.arange(4 * np.count_nonzero(afloat)).reshape(-1, 4)
    number = 4 * int(np.count_nonzero(afloat))
    largest = int(np.argmax(np.bincount(pieces.ravel())[1:])) + 1 if count else 0
    for n in range(1, count + 1):
        if n != largest:
            unknown[piece == n, 0] = number
            number += 1
    if not count:
        unknown[0, 0, 0] = -1
        unknown[unknown > 0] -= 1
    return unknown


def _still_unknowns(water: NDArray[np.bool_]) -> NDArray[np.int64]:
    """(y vertex, x vertex, 4) number of each unknown of the circulation, -1 at quays and rim."""
    framed = np.pad(water, 1)
    inner = framed[1:, 1:] & framed[:-1, 1:] & framed[1:, :-1] & framed[:-1, :-1]
    unknown = np.full((*inner.shape, 4), -1)
    unknown[inner] = np.arange(4 * np.count_nonzero(inner)).reshape(-1, 4)
    return unknown


def _stream_functions(
    water: NDArray[np.bool_], unknown: NDArray[np.int64], layer: float, forces: FloatArray
) -> FloatArray:
    """Solve on a grid of elements of side 1.

    Parameters
    ----------
    water : (y, x) bool elements
    unknown : (y vertex, x vertex, 4) number of each unknown, -1 for zero
    layer : L in sides
    forces : (16, force) work of each on the unknowns of an element

    Returns
    -------
    (y vertex, x vertex, 4, force) psi, dpsi/dx, dpsi/dy, d2psi/dxdy
    """
    count = int(unknown.max(initial=-1)) + 1
    y, x = np.nonzero(water)
    end, slope = np.divmod(np.arange(4), 2)  # of the 4 unknowns along one axis
    places = unknown[
        y[:, None, None] + end[:, None],
        x[:, None, None] + end,
        2 * slope[:, None] + slope,
    ].reshape(-1, 16)
    places = np.where(places < 0, count, places)  # those that are zero share one, to be dropped
    pairs = (np.repeat(places, 16, axis=1).ravel(), np.tile(places, (1, 16)).ravel())
    drag = np.tile(element_matrix(layer).ravel(), y.size)
    whole = sparse.coo_array((drag, pairs), shape=(count + 1,) * 2)
    work = np.zeros((count + 1, forces.shape[1]))
    np.add.at(work, places.ravel(), np.tile(forces, (y.size, 1)))
    solved = np.zeros_like(work)
    if count:
        matrix = whole.tocsc()[:count, :count]
        factors = splu(matrix, "MMD_AT_PLUS_A", 0.0, options={"SymmetricMode": True})
        solved[:count] = factors.solve(work[:count])
    return solved[unknown]  # -1 is the last, which is zero


@kernel
def _peak_speed(patches: FloatArray, spacing_m: float) -> float:
    """Highest speed of the circulation over a grid of points [m/s]."""
    peak = 0.0
    for j in range(_SAMPLES * (patches.shape[0] - 1)):
        for i in range(_SAMPLES * (patches.shape[1] - 1)):
            x, y = i * spacing_m / _SAMPLES, j * spacing_m / _SAMPLES
            u, v = stream_velocity(patches, spacing_m, 0.0, x, y, 0.0, 0.0, 1.0)
            peak = max(peak, u * u + v * v)
    return math.sqrt(peak)


@lru_cache(maxsize=8)
def flow_of(graph: NavigationGraph, streams: bool, circulation: bool) -> Flow:
    """The flow of a map, solved once and kept.

    Parameters
    ----------
    graph : the map; land cells are quays
    streams, circulation : which are wanted; the others are zero
    """
    fine = FINEST
    while fine > 2 and len(graph) * fine**2 > _MANY:
        fine -= 1
    spacing_m, layer = graph.pitch_m / fine, LAYER * fine
    water = np.kron(graph.navigable[::-1], np.ones((fine, fine), np.bool_))  # rows from the south
    patches = np.zeros((water.shape[0] + 1, water.shape[1] + 1, 4, 3))
    if streams:
        forces = np.stack((EAST, NORTH), axis=1)
        patches[..., :2] = _stream_functions(water, _shore_unknowns(water), layer, forces)
    if circulation:
        unknown = _still_unknowns(water)
        patches[..., 2:] = _stream_functions(water, unknown, layer, TURN[:, None])
    patches *= np.array([spacing_m, 1.0, 1.0, 1.0 / spacing_m])[:, None]
    if circulation:
        patches[..., 2] /= _peak_speed(patches, spacing_m)
    patches.setflags(write=False)
    return Flow(patches, spacing_m, -0.5 * graph.pitch_m)
