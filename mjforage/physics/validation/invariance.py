"""What must not matter: where the bow points, and a steady current that carries everything."""

import math
from collections.abc import Sequence

import numpy as np

from mjforage.physics.simulation import Integrator
from mjforage.physics.validation.finding import Float64Array, Line, Measure, Panel, at_most
from mjforage.physics.validation.known_checks import Parts, check
from mjforage.physics.validation.shared_runs import (
    CASES,
    INTEGRATORS,
    SPEED_KIND,
    STEP_S,
    TURN,
    case_name,
    clock,
    ordered,
    scheduled,
)
from mjforage.physics.vessels import load_vessel

LIMIT = 1e-6  # on runs that are stable
SECONDS = 60.0
WIND = (3.0, -3.0)  # [m/s]
HEADINGS = (0.0, 0.5, 2.0, -2.5, 3.1)
CURRENTS = tuple((0.3 * math.cos(a), 0.3 * math.sin(a)) for a in (0.0, 1.0, 2.5, -2.0))


@check("galilean", "8", "Galilean invariance")
def galilean() -> Parts:
    """A turning circle in a current of 0.3 m/s, begun moving with it, is one carried along.

    In a wind that blows at 4.2 m/s over the water, the forager with 100 items too. Four directions
    of the current, 60 s; the largest difference in position and heading from the circle in still
    water and the current's way together.
    """
    measures: list[Measure] = []
    times = clock(round(SECONDS / STEP_S) + 1)
    way = np.zeros((times.size, len(CURRENTS), 3))
    way[..., :2] = times[:, None, None] * np.array(CURRENTS)
    for name, load in CASES:
        for integrator in INTEGRATORS:
            still = _turn(name, load, integrator)
            carried = [(WIND[0] + x, WIND[1] + y) for x, y in CURRENTS]
            moved = _turn(name, load, integrator, current=CURRENTS, wind=carried)
            off = float(np.abs(moved - way - still).max())
            label = f"{case_name(name, load)}, {SPEED_KIND[integrator]}: departure"
            measures.append(at_most(label, off, LIMIT, "m, rad"))
    return tuple(measures), (_carried_panel(moved, moved - way, still[:, 0]),)


def _carried_panel(ours: Float64Array, back: Float64Array, calm: Float64Array) -> Panel:
    over_ground = [
        Line("over ground" if not k else "", ours[:, k, 0], ours[:, k, 1]) for k in range(4)
    ]
    return Panel(
        "Turning circle of the scout in four currents",
        "x, east (m)",
        "y, north (m)",
        (
            *over_ground,
            Line("less the current", back[:, 0, 0], back[:, 0, 1], 1),
            Line("still water", calm[:, 0], calm[:, 1], expected=True),
        ),
        equal=True,
    )


@check("heading", "9", "Heading invariance")
def heading() -> Parts:
    """The same turning circle from five headings, turned back by the heading, is one circle.

    In a wind of 4.2 m/s that is turned with it, the forager with 100 items too. 60 s; the largest
    difference of position and heading.
    """
    measures = []
    turned = [
        (c * WIND[0] - s * WIND[1], s * WIND[0] + c * WIND[1])
        for c, s in ((math.cos(yaw), math.sin(yaw)) for yaw in HEADINGS)
    ]
    for name, load in CASES:
        for integrator in INTEGRATORS:
            rows = _turn(name, load, integrator, yaw=HEADINGS, wind=turned)
            back = _turned_back(rows)
            off = float(np.abs(back - back[:, :1]).max())
            label = f"{case_name(name, load)}, {SPEED_KIND[integrator]}: departure"
            measures.append(at_most(label, off, LIMIT, "m, rad"))
    return tuple(measures), (_turned_panel(rows, back),)


def _turned_panel(rows: Float64Array, back: Float64Array) -> Panel:
    as_it_ran = [
        Line("as it ran" if not k else "", rows[:, k, 0], rows[:, k, 1])
        for k in range(len(HEADINGS))
    ]
    return Panel(
        "Turning circle of the scout from five headings",
        "x, east (m)",
        "y, north (m)",
        (
            *as_it_ran,
            Line("all, turned back", back[:, -1, 0], back[:, -1, 1], 1),
            Line("heading 0", back[:, 0, 0], back[:, 0, 1], expected=True),
        ),
        equal=True,
    )


def _turn(
    name: str,
    load: float,
    integrator: Integrator,
    *,
    yaw: Sequence[float] = (0.0,),
    current: Sequence[tuple[float, float]] = ((0.0, 0.0),),
    wind: Sequence[tuple[float, float]] = (WIND,),
) -> Float64Array:
    """(row, run, 3) pose of a minute's turning circle."""
    vessel = load_vessel(name)
    rows = scheduled(
        vessel, ordered(vessel, TURN), integrator,
        yaw=yaw, current=current, wind=wind, load=load, seconds=SECONDS,
    )  # fmt: skip
    return rows[..., :3]


def _turned_back(rows: Float64Array) -> Float64Array:
    c, s = np.cos(HEADINGS), np.sin(HEADINGS)
    x, y, yaw = np.moveaxis(rows, -1, 0)
    return np.stack((c * x + s * y, c * y - s * x, yaw - np.array(HEADINGS)), axis=-1)
