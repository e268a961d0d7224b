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
from functools import lru_cache, partial
from importlib import import_module

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.errors import UserError
from mjforage.base.kept_arrays import kept_array
from mjforage.base.views import read_only
from mjforage.forcing.stream_element import EAST, NORTH, TURN, FloatArray, stream_velocity
from mjforage.forcing.stream_solver import shore_unknowns, still_unknowns, stream_functions
from mjforage.graph_planner.graph.navigation import NavigationGraph
from mjforage.scenario.scenario import Weather

FINEST = 3  # elements along a cell
LAYER = 0.5  # L, width of the layer at quays [cell]; an estimate, half the narrowest corridor
_MANY = 12_000  # elements; beyond it they are larger
_LONG = 10_000  # nodes from which on a flow, of a second and more, is kept for other processes
_SOLVERS = tuple(
    f"mjforage.forcing.{name}"
    for name in ("flow", "elimination", "stream_element", "stream_solver")
)
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


OPEN_SEA = Flow(np.empty((0, 0, 4, 3)), 1.0, 0.0)  # without a map: the free stream is everywhere


def has_open_border(graph: NavigationGraph) -> bool:
    """True if there is water at the edge of the map, where streams come in and go out."""
    water = graph.navigable
    return bool(water[[0, -1]].any() or water[:, [0, -1]].any())


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
    streams, circulation : parts to compute; the others are zero
    """
    fine = FINEST
    while fine > 2 and len(graph) * fine**2 > _MANY:
        fine -= 1
    spacing_m, layer = graph.pitch_m / fine, LAYER * fine
    water = np.kron(graph.navigable[::-1], np.ones((fine, fine), np.bool_))  # rows from the south
    shape = water.shape[0] + 1, water.shape[1] + 1, 4, 3
    solve = partial(_solved, water, shape, spacing_m, layer, streams, circulation)
    if len(graph) < _LONG:
        patches = solve()
    else:
        about = water, spacing_m, layer, streams, circulation
        patches = kept_array(shape, solve, about, map(import_module, _SOLVERS))
    return Flow(read_only(patches), spacing_m, -0.5 * graph.pitch_m)


def _solved(
    water: NDArray[np.bool_],
    shape: tuple[int, ...],
    spacing_m: float,
    layer: float,
    streams: bool,
    circulation: bool,
) -> FloatArray:
    """The patches (of `shape`) of elements (row from the south, column) that are water."""
    patches = np.zeros(shape)
    if streams:
        forces = np.stack((EAST, NORTH), axis=1)
        patches[..., :2] = stream_functions(water, shore_unknowns(water), layer, forces)
    if circulation:
        unknown = still_unknowns(water)
        patches[..., 2:] = stream_functions(water, unknown, layer, TURN[:, None])
    patches *= np.array([spacing_m, 1.0, 1.0, 1.0 / spacing_m])[:, None]
    if circulation:
        patches[..., 2] /= _peak_speed(patches, spacing_m)
    return patches


def flow_in(weather: Weather, graph: NavigationGraph | None, recorded: bool = False) -> Flow:
    """Flow of streams and circulation on a map.

    Raises `UserError` if there shall be a circulation without a map, or a stream on a map without
    water at its edge.

    Parameters
    ----------
    graph : the map; None: the open sea
    recorded : True if there is a recorded current
    """
    turning = weather.circulation_mps != 0.0
    if graph is None:
        if turning:
            raise UserError(
                f"weather: circulation_mps = {weather.circulation_mps:g} without a map; "
                "give a map, or 0"
            )
        return OPEN_SEA
    for name in ("current_speed_mps", "current_wander_mps"):
        speed = getattr(weather, name)
        if speed and not has_open_border(graph):
            raise UserError(
                f"weather: {name} = {speed:g} on a map without water at its edge, where a current "
                "would come in and go out; open the edge, or set weather.circulation_mps instead"
            )
    if recorded and not has_open_border(graph):
        raise UserError(
            f"weather.file = {weather.file}: has a current, and the map has no water at its edge, "
            "where it would come in and go out; open the edge, or give a record of wind"
        )
    streaming = recorded or weather.current_speed_mps > 0.0 or weather.current_wander_mps > 0.0
    return flow_of(graph, streaming, turning) if streaming or turning else OPEN_SEA
