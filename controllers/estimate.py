"""Pose and drift from noisy measurements.

The pose is dead reckoning on the measured velocity, drawn to the fixes. The drift, how current and
wind together carry the hull, is what the measured velocity has over a model of the hull's own speed
through the water.
"""

import math

from controllers._compiled import kernel
from controllers.allocation import thrust_of
from controllers.angles import wrapped
from controllers.helm import (
    FILTER,
    LIN_SURGE,
    LIN_SWAY,
    M_SURGE,
    M_SWAY,
    QUAD_SURGE,
    QUAD_SWAY,
    FloatArray,
)
from controllers.state import (
    DRIFT_X,
    DRIFT_Y,
    HEADING_REF,
    KNOWN,
    PORT,
    RATE,
    STARBOARD,
    SURGE,
    SWAY,
    VX,
    VY,
    WANTED,
    YAW,
    X,
    Y,
)

LOST_M = 3.0  # a fix farther from the estimate is believed at once
DRIFT_S = 3.0  # time constant of the drift
SLOW_MPS = 0.4  # above this, the hull's unknown load spoils the drift along it


@kernel
def surge_after(p: FloatArray, surge: float, force: float, step_s: float) -> float:
    """Speed ahead through the water [m/s] after a step: m u' = T - d(u), drag taken implicitly."""
    drag = p[LIN_SURGE] + p[QUAD_SURGE] * abs(surge)
    return float((p[M_SURGE] * surge + step_s * force) / (p[M_SURGE] + step_s * drag))


@kernel
def sway_after(p: FloatArray, sway: float, surge: float, rate: float, step_s: float) -> float:
    """Speed to port through the water [m/s] that turning gives, after a step.

    m_sway v' = -m_surge u r - d(v) v, drag taken implicitly. Measured sway would not do: it has
    the current in it.
    """
    drag = p[LIN_SWAY] + p[QUAD_SWAY] * abs(sway)
    pushed = p[M_SWAY] * sway - step_s * p[M_SURGE] * surge * rate
    return float(pushed / (p[M_SWAY] + step_s * drag))


@kernel
def learn_drift(s: FloatArray, p: FloatArray, step_s: float) -> None:
    """Move the modelled speeds through the water and the drift on by a step."""
    c, t = math.cos(s[YAW]), math.sin(s[YAW])
    ahead, aside = c * s[VX] + t * s[VY], c * s[VY] - t * s[VX]
    force = thrust_of(p, s[PORT]) + thrust_of(p, s[STARBOARD])
    s[SURGE] = surge_after(p, s[SURGE], force, step_s)
    s[SWAY] = sway_after(p, s[SWAY], s[SURGE], s[RATE], step_s)
    share = step_s / (DRIFT_S + step_s)
    more_aside = share * (aside - s[SWAY] - (c * s[DRIFT_Y] - t * s[DRIFT_X]))
    more_ahead = 0.0
    if abs(s[SURGE]) < SLOW_MPS:
        more_ahead = share * (ahead - s[SURGE] - (c * s[DRIFT_X] + t * s[DRIFT_Y]))
    s[DRIFT_X] += c * more_ahead - t * more_aside
    s[DRIFT_Y] += t * more_ahead + c * more_aside


@kernel
def estimate(
    s: FloatArray, p: FloatArray, pose: FloatArray, velocity: FloatArray, step_s: float
) -> None:
    """Take in a pose x, y [m], yaw [rad] and a velocity over ground, world axes [m/s, rad/s]."""
    x = s[X] + 0.5 * step_s * (s[VX] + velocity[0])
    y = s[Y] + 0.5 * step_s * (s[VY] + velocity[1])
    yaw = s[YAW] + 0.5 * step_s * (s[RATE] + velocity[2])
    dx, dy = pose[0] - x, pose[1] - y
    s[VX], s[VY], s[RATE] = velocity[0], velocity[1], velocity[2]
    if s[KNOWN] == 0.0 or math.sqrt(dx * dx + dy * dy) > LOST_M:
        s[X], s[Y], s[YAW], s[KNOWN] = pose[0], pose[1], pose[2], 1.0
        s[HEADING_REF] = s[WANTED] = pose[2]
        return
    s[KNOWN] += 1.0
    share = max(step_s / (p[FILTER] + step_s), 1.0 / s[KNOWN])  # the first fixes count alike
    s[X], s[Y] = x + share * dx, y + share * dy
    s[YAW] = yaw + share * wrapped(pose[2] - yaw)
    learn_drift(s, p, step_s)
