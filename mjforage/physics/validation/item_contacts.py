"""Items against quays and hulls, and what a collector's mouth takes."""

import numpy as np

from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.mission.dynamics import start_state
from mjforage.mission.initial_state import InitialState
from mjforage.physics.dynamics.picking import Reach, take_at_mouth
from mjforage.physics.dynamics.tracks import Water
from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Integrator, Simulation
from mjforage.physics.validation.finding import Float64Array, Line, Measure, Panel, near
from mjforage.physics.validation.known_checks import Parts, check
from mjforage.physics.validation.shared_runs import INTEGRATORS, SPEED_KIND, clock
from mjforage.physics.vessels import load_vessel

BASIN = np.ones((5, 9), np.bool_)
PITCH_M, RADIUS_M = 4.0, 0.1
NORTH_M, EAST_M = 18.0, 34.0  # edges of the basin
AHEAD = 60.0  # command of both sides [rad/s]
SECONDS = 12.0
STEP_M = 1e-3  # of the places that are tried
REACH_M, DEPTH_M = 0.12, 0.3  # of the mouth, before and behind the bow


@check("items", "16", "Items against quays and hulls")
def items() -> Parts:
    """A forager pushes one item before it, wind of 10 m/s blows others onto a quay, into a corner.

    Where they come to rest: their middles an item's radius, 0.1 m, off what they touch.
    """
    measures: list[Measure] = []
    lines: list[Line] = []
    for colour, integrator in enumerate(INTEGRATORS):
        bow, xy = _pushed(integrator)
        kind = SPEED_KIND[integrator]
        measures += [
            near(f"{kind}: before the bow", xy[-1, 0, 0] - bow[-1], RADIUS_M, 0.02, "m"),
            near(f"{kind}: off a quay", NORTH_M - xy[-1, 1, 1], RADIUS_M, 0.01, "m"),
            near(
                f"{kind}: in a corner, off the north", NORTH_M - xy[-1, 2, 1], RADIUS_M, 0.01, "m"
            ),
            near(f"{kind}: in a corner, off the east", EAST_M - xy[-1, 2, 0], RADIUS_M, 0.01, "m"),
        ]
        lines.append(Line(kind, clock(len(bow)), xy[:, 0, 0] - bow, colour))
    panel = Panel("Item before the bow", "time (s)", "m", tuple(lines))
    return tuple(measures), (panel,)


def _pushed(integrator: Integrator) -> tuple[Float64Array, Float64Array]:
    """(row,) x of the forager's bow and (row, item, 2) places of the items [m]."""
    scene = build_scene([load_vessel("forager")], navigable=BASIN, pitch_m=PITCH_M, items=4)
    simulation = Simulation(scene, integrator=integrator, step_s=0.1, items=3)
    simulation.place_vessels(np.array([3.0, 4.0, 0.0]))
    simulation.place_items(np.array([[6.0, 4.0], [20.0, 16.0], [32.0, 16.5]]), np.zeros(3, int))
    simulation.item_wind[0, 1:] = (0.0, 10.0), (8.0, 8.0)
    simulation.commands[:] = AHEAD
    bow, xy = [], []
    for _ in range(round(SECONDS / 0.1)):
        simulation.step()
        bow.append(simulation.vessel_pose[0, 0, 0] + 1.0)
        xy.append(simulation.item_xy[0])
    return np.array(bow), np.array(xy)


@check("mouth", "17", "What a collector's mouth takes")
def mouth() -> Parts:
    """A forager at an angle; items tried every millimetre along its middle line and its bow.

    The mouth is as wide as the hull and reaches from 0.3 m behind the bow to 0.12 m before it. With
    room for three it takes three; a scout takes none.
    """
    forager = load_vessel("forager")
    places = np.arange(-2.0, 2.0, STEP_M)
    zero = np.zeros(places.size)
    along = _taken(np.stack((places, zero), axis=-1))
    ahead = places[along] - 0.5 * forager.length_m
    across = places[_taken(np.stack((zero + 0.5 * forager.length_m, places), axis=-1))]
    slack = 2.0 * STEP_M
    few = int(_taken(np.stack((zero + 0.9, 0.1 * places), axis=-1), room=3).sum())
    none = int(_taken(np.stack((places, zero), axis=-1), collects=False).sum())
    return (
        near("reach before the bow", _end(ahead, 1.0), REACH_M, slack, "m"),
        near("reach behind the bow", _end(ahead, -1.0), DEPTH_M, slack, "m"),
        near("to port", _end(across, 1.0), 0.5 * forager.beam_m, slack, "m"),
        near("to starboard", _end(across, -1.0), 0.5 * forager.beam_m, slack, "m"),
        near("taken with room for three", few, 3, 0, "items"),
        near("taken by a scout", none, 0, 0, "items"),
    ), ()


def _end(taken: Float64Array, side: float) -> float:
    """How far the taken places reach to a side; NaN without any."""
    return float((side * taken).max()) if taken.size else np.nan


def _taken(
    places: Float64Array, room: int = 10_000, collects: bool = True
) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """(item,) which of the items at places in body axes [m] one hull takes."""
    forager, count, yaw = load_vessel("forager"), len(places), 0.7
    graph = navigation_graph(BASIN, PITCH_M, False)
    centres = np.stack((graph.rows, graph.cols), axis=1).astype(np.float64)
    node = np.zeros((1, count), np.int32)
    start = InitialState(
        np.array([count], np.int32),
        np.zeros((1, count, 2)),
        node,
        np.zeros((1, 2)),
        np.zeros((1, 1), np.int32),
    )
    state = start_state(start, centres)
    c, s = np.cos(yaw), np.sin(yaw)
    xy = places @ np.array([[c, s], [-s, c]]) + (5.0, -3.0)
    size = np.array([[0.5 * forager.length_m, 0.5 * forager.beam_m]])
    take_at_mouth(
        Reach(np.array([collects]), size, Water(np.zeros((0, 0), np.bool_), PITCH_M), False),
        np.ones(1, np.bool_),
        np.array([[[5.0, -3.0, yaw]]]),
        xy[None],
        np.array([[room]], np.int64),
        state,
    )
    return np.asarray(state.item_node[0] < 0)
