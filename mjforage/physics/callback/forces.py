"""Forces on all vessels and items in one MuJoCo state: the callback's work, on plain arrays.

`apply` may be called twice on one state, since it sets the vessels' rows of M and does not add to
them.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.physics.callback import vessel_motion
from mjforage.physics.callback.model_layout import (
    AVERAGED,
    CLASS_WIDTH,
    HEADER,
    INPUT_WIDTH,
    ITEM_AIR,
    ITEM_DOFS,
    ITEM_MASS,
    ITEM_WATER,
    LOAD,
    LOSS,
    N_CLASSES,
    N_ITEMS,
    N_VESSELS,
    SCHEME,
    SPREAD,
    VESSEL_DOFS,
    VESSEL_INPUTS,
    VESSEL_WIDTH,
    WATER,
    WIND,
)
from mjforage.physics.hydrodynamics.item_drag import item_load
from mjforage.physics.hydrodynamics.parameters import VESSEL, Float64Array, VesselParameters
from mjforage.physics.hydrodynamics.thruster import saturated, thrust_amid_step


class MujocoState(NamedTuple):
    """The fields of mjModel and mjData that matter, as views."""

    numeric: Float64Array  # (number,) model, see `model_layout`
    row: NDArray[np.int32]  # (dof,) start of each row of M
    qpos: Float64Array  # (dof,) [m], [rad]
    qvel: Float64Array  # (dof,) over ground, world axes [m/s], [rad/s]
    act: Float64Array  # (vessel * 2,) lagged commands
    ctrl: Float64Array  # (vessel * 2,) commands
    userdata: Float64Array  # (input,) see `model_layout`
    force: Float64Array  # (dof,) qfrc_passive, added to [N], [N m]
    mass: Float64Array  # (entry,) M, rows set
    step_s: float


@kernel
def _averaged(
    state: MujocoState,
    v: int,
    p: VesselParameters,
    around: vessel_motion.Surroundings,
    body: vessel_motion.Inertia,
) -> tuple[float, float, float, float, float, float]:
    """As `vessel_motion.averaged_load`, of vessel `v`."""
    i = v * VESSEL_DOFS
    command = state.ctrl[2 * v], state.ctrl[2 * v + 1]
    lagged = state.act[2 * v], state.act[2 * v + 1]
    pose_and_way = state.qpos[i + 2], state.qvel[i], state.qvel[i + 1], state.qvel[i + 2]
    return vessel_motion.averaged_load(
        p, body, *pose_and_way, command, lagged, around, state.step_s
    )


@kernel
def _instant(
    state: MujocoState,
    v: int,
    p: VesselParameters,
    around: vessel_motion.Surroundings,
    body: vessel_motion.Inertia,
) -> tuple[float, float, float, float, float, float]:
    """Loads on vessel `v` now, in body axes, and its inertia."""
    i = v * VESSEL_DOFS
    h, left, right = state.step_s, 2 * v, 2 * v + 1
    port = thrust_amid_step(p, saturated(p, state.ctrl[left]), state.act[left], h)
    starboard = thrust_amid_step(p, saturated(p, state.ctrl[right]), state.act[right], h)
    surge, sway, turn = vessel_motion.loads(
        p,
        state.qpos[i + 2],
        state.qvel[i],
        state.qvel[i + 1],
        state.qvel[i + 2],
        port,
        starboard,
        around,
    )
    r = state.qvel[i + 2]
    surge += (body.moment - p.mass * p.cog_x) * r * r  # MuJoCo turns the model's mass
    return surge, sway, turn, body.surge, body.sway, body.yaw


@kernel
def _vessel(state: MujocoState, v: int, p: VesselParameters, averaged: bool) -> None:
    """Force and rows of M of vessel `v`."""
    userdata, mass, force, row = state.userdata, state.mass, state.force, state.row
    i, at = v * VESSEL_DOFS, v * VESSEL_INPUTS
    left = 1.0 + userdata[at + SPREAD + 2]
    around = vessel_motion.Surroundings(
        userdata[at + WIND],
        userdata[at + WIND + 1],
        userdata[at + WATER],
        userdata[at + WATER + 1],
        userdata[at + LOAD],
        (1.0 - userdata[at + LOSS]) * left,
        (1.0 - userdata[at + LOSS + 1]) * left,
        1.0 + userdata[at + SPREAD],
        1.0 + userdata[at + SPREAD + 1],
    )
    body = vessel_motion.inertia(p, around.load, around.mass)
    if averaged:
        loads = _averaged(state, v, p, around, body)
    else:
        loads = _instant(state, v, p, around, body)
    surge, sway, turn, m_surge, m_sway, m_yaw = loads
    c, s = math.cos(state.qpos[i + 2]), math.sin(state.qpos[i + 2])
    force[i] += c * surge - s * sway
    force[i + 1] += s * surge + c * sway
    force[i + 2] += turn
    x, y, z = row[i], row[i + 1], row[i + 2]
    mass[x] = c * c * m_surge + s * s * m_sway
    mass[y] = c * s * (m_surge - m_sway)
    mass[y + 1] = s * s * m_surge + c * c * m_sway
    mass[z] = -s * body.moment
    mass[z + 1] = c * body.moment
    mass[z + 2] = m_yaw


@kernel
def _items(
    state: MujocoState, classes: Float64Array, first_dof: int, first_input: int, averaged: bool
) -> None:
    """Drag of air and water on every item on the water."""
    qvel, userdata, force, mass, row = (
        state.qvel,
        state.userdata,
        state.force,
        state.mass,
        state.row,
    )
    h, items = state.step_s, int(state.numeric[N_ITEMS])
    for k in range(items):
        i, at = first_dof + k * ITEM_DOFS, first_input + k * INPUT_WIDTH
        which = int(userdata[at + LOAD]) * CLASS_WIDTH
        if which < 0 or which >= classes.size:
            continue
        force_x, force_y, own = item_load(
            classes[which + ITEM_MASS],
            classes[which + ITEM_AIR],
            classes[which + ITEM_WATER],
            userdata[at + WIND] - qvel[i],
            userdata[at + WIND + 1] - qvel[i + 1],
            userdata[at + WATER] - qvel[i],
            userdata[at + WATER + 1] - qvel[i + 1],
            h,
            averaged,
        )
        force[i] += force_x
        force[i + 1] += force_y
        mass[row[i]] = own
        mass[row[i + 1]] = own


@kernel
def apply(state: MujocoState) -> None:
    """Add the forces of all vessels and items to `force` and set their rows of `mass`."""
    numeric, averaged = state.numeric, state.numeric[SCHEME] == AVERAGED
    vessels, items = int(numeric[N_VESSELS]), int(numeric[N_ITEMS])
    table = HEADER + vessels * VESSEL_WIDTH
    parameters = numeric[HEADER:table].view(VESSEL)
    for v in range(vessels):
        _vessel(state, v, parameters[v], averaged)
    if items:
        classes = numeric[table : table + int(numeric[N_CLASSES]) * CLASS_WIDTH]
        _items(state, classes, vessels * VESSEL_DOFS, vessels * VESSEL_INPUTS, averaged)
