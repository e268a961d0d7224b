"""The end of a period for the vessels: what it leaves in the state of a mission, in nodes."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.device import Launch
from mjforage.controllers.effectiveness import is_lame
from mjforage.controllers.state import FleetArray
from mjforage.graph_planner.graph.navigation import Water
from mjforage.graph_planner.graph.walls import into_water
from mjforage.mission.dynamics import Transition
from mjforage.physics.dynamics.period_monitor import PeriodRecord

FloatArray = NDArray[np.float64]


class Ground(NamedTuple):
    """The map, and what vessels carry."""

    water: Water
    pitch_m: float
    capacity: NDArray[np.int64]  # (vessel,) items


@kernel
def settle(
    ground: Ground,
    active: NDArray[np.bool_],
    pose: FloatArray,
    record: PeriodRecord,
    pilots: FleetArray,
    state: Transition,
) -> None:
    """Write the period's end of the active episodes into the state, but for outcomes and items."""
    height = ground.water.framed.shape[0] - 2
    for e in range(active.size):
        if not active[e]:
            continue
        for v in range(pose.shape[1]):
            row, col = height - 1 - pose[e, v, 1] / ground.pitch_m, pose[e, v, 0] / ground.pitch_m
            state.agent_rc[e, v, 0], state.agent_rc[e, v, 1] = row, col
            _, _, state.agent_node[e, v] = into_water(ground.water, 0, row, col)
            way = record.travelled_m[e, v] / ground.pitch_m
            state.agent_yaw[e, v], state.agent_speed[e, v] = pose[e, v, 2], way
            state.distance[e, v] += way
            state.energy[e, v] += way
            state.collisions[e, v] = record.collisions[e, v]
            state.impact[e, v], state.work[e, v] = record.impact_mps[e, v], record.work_j[e, v]
            state.disabled[e, v] = is_lame(pilots[e, v])


@kernel
def load_vessels(
    ground: Ground, active: NDArray[np.bool_], room_left: NDArray[np.int64], load: FloatArray
) -> None:
    """Write what vessels of the active episodes carry (episode, vessel), of the room left."""
    for e in range(active.size):
        if active[e]:
            for v in range(load.shape[1]):
                load[e, v] = ground.capacity[v] - room_left[e, v]


SETTLE, LOAD_VESSELS = Launch(settle, shared="ground"), Launch(load_vessels, shared="ground")
