"""What must not matter: where the bow points, and a steady current that carries everything."""

import math

import numpy as np

from mjforage.physics.simulation import Integrator
from mjforage.physics.validation.finding import Float64Array, Line, Panel, at_most
from mjforage.physics.validation.known_checks import Parts, check
from mjforage.physics.validation.shared_runs import INTEGRATORS, SPEED_KIND, TURN, clock, scheduled
from mjforage.physics.vessels import load_vessel

LIMIT = 1e-6  # on runs that are stable
HEADINGS = (0.0, 0.5, 2.0, -2.5, 3.1)
CURRENTS = tuple((0.3 * math.cos(a), 0.3 * math.sin(a)) for a in (0.0, 1.0, 2.5, -2.0))


@check("galilean", "8", "Galilean invariance")
def galilean() -> Parts:
    """A turning circle in a current of 0.3 m/s, begun moving with it, is one carried along.

    Four directions of the current, 60 s; the largest difference in position and heading from the
    circle in still water and the current's way together.
    """
    still = {i: scheduled(load_vessel("otter"), TURN, i)[:, :, :3] for i in INTEGRATORS}
    moved = {
        i: scheduled(load_vessel("otter"), TURN, i, current=CURRENTS)[:, :, :3] for i in INTEGRATORS
    }
    times = clock(len(still[Integrator.FAST]))
    way = np.zeros((times.size, len(CURRENTS), 3))
    way[..., :2] = times[:, None, None] * np.array(CURRENTS)
    measures = [
        at_most(f"{SPEED_KIND[i]}: departure", _largest(moved[i] - way - still[i]), LIMIT, "m, rad")
        for i in INTEGRATORS
    ]
    ours, calm = moved[Integrator.REFERENCE], still[Integrator.REFERENCE][:, 0]
    back = ours - way
    panel = Panel(
        "Turning circle in four currents",
        "x, east (m)",
        "y, north (m)",
        (
            *(Line("over ground" if not k else "", ours[:, k, 0], ours[:, k, 1]) for k in range(4)),
            Line("less the current", back[:, 0, 0], back[:, 0, 1], 1),
            Line("still water", calm[:, 0], calm[:, 1], expected=True),
        ),
        equal=True,
    )
    return tuple(measures), (panel,)


@check("heading", "9", "Heading invariance")
def heading() -> Parts:
    """The same turning circle from five headings, turned back by the heading, is one circle.

    60 s; the largest difference of position and heading.
    """
    measures = []
    for integrator in INTEGRATORS:
        rows = scheduled(load_vessel("otter"), TURN, integrator, yaw=HEADINGS)[..., :3]
        back = _turned_back(rows)
        off = _largest(back - back[:, :1])
        measures.append(at_most(f"{SPEED_KIND[integrator]}: departure", off, LIMIT, "m, rad"))
    panel = Panel(
        "Turning circle from five headings",
        "x, east (m)",
        "y, north (m)",
        (
            *(
                Line("as it ran" if not k else "", rows[:, k, 0], rows[:, k, 1])
                for k in range(len(HEADINGS))
            ),
            Line("all, turned back", back[:, -1, 0], back[:, -1, 1], 1),
            Line("heading 0", back[:, 0, 0], back[:, 0, 1], expected=True),
        ),
        equal=True,
    )
    return tuple(measures), (panel,)


def _turned_back(rows: Float64Array) -> Float64Array:
    c, s = np.cos(HEADINGS), np.sin(HEADINGS)
    x, y, yaw = np.moveaxis(rows, -1, 0)
    return np.stack((c * x + s * y, c * y - s * x, yaw - np.array(HEADINGS)), axis=-1)


def _largest(difference: Float64Array) -> float:
    return float(np.abs(difference).max())
