"""A scenario by hand, in which metres are no nodes, seconds no decisions, and no side is another.

The map has 4 rows and 7 columns of 5 m and a decision takes 8 s, so that what takes one for the
other is off by a factor of its own.
"""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.mission.setup import Setup
from mjforage.scenario.roles import Role
from mjforage.scenario.scenario import Items, MapChoice, Scenario, Weather

PITCH_M, PERIOD_S = 5.0, 8.0
CORNER = ("1111111", "1101111", "1111110", "0111111")
NORTH, EAST, SOUTH, WEST = (0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)  # (x, y)
CALM = Weather(drift_node_per_step=0.0, noise_node_per_step=0.0)
SCENARIO = Scenario(
    name="by-hand",
    map=MapChoice(file="by-hand", pitch_m=PITCH_M, starts=((1, 5), (2, 1), (0, 3))),
    team={
        "scouts": Role(count=2, moves=2, radius=2.5, collects=False),
        "foragers": Role(count=1, moves=1, radius=1.5, collects=True),
    },
    horizon=20,
    period_s=PERIOD_S,
    items=Items(mean=1.0, std=0.0),
    weather=CALM,
)


def water(rows: tuple[str, ...] = CORNER) -> NDArray[np.bool_]:
    """Cells (row, column) of rows of 0 and 1, the northernmost first."""
    return np.array([[cell == "1" for cell in row] for row in rows])


def by_hand(cells: NDArray[np.bool_] | None = None, **tables: Any) -> Setup:
    """The scenario on these cells, with other tables in the place of its own."""
    return Setup.of(replace(SCENARIO, **tables), water() if cells is None else cells)
