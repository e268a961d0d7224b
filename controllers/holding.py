"""Keeping position with two thrusters: the heading is free, so it follows the force needed."""

import math

from controllers._compiled import kernel
from controllers.angles import wrapped
from controllers.helm import HOLD_RADIUS, HOLD_TI, HOLD_W, M_SURGE, FloatArray
from controllers.loops import integrated
from controllers.state import DRIFT_X, DRIFT_Y, HOLD_FX, HOLD_FY, VX, VY, WANTED, YAW, X, Y

FARTHEST_M = 1.0  # a place farther away pulls no harder
LEAST_DRIFT_MPS = 0.06
SLOW_MPS = 0.3  # a hull faster than this brakes before it turns
SWITCH_RAD = 1.9  # bow and stern change roles beyond this


@kernel
def hold_force(s: FloatArray, p: FloatArray, x: float, y: float) -> tuple[float, float, float]:
    """Heading wanted [rad], surge force [N] and distance ahead [m] to stay at (x, y).

    A spring and a damper pull towards the place, an integral learns the steady force. Where the
    place is more than `HOLD_RADIUS` away, or a drift carries the hull off, bow or stern turn to
    where the hull must go through the water: towards the place and against the drift.
    """
    dx, dy = x - s[X], y - s[Y]
    far = math.sqrt(dx * dx + dy * dy)
    if far > FARTHEST_M:
        dx, dy = dx * FARTHEST_M / far, dy * FARTHEST_M / far
    w, mass = p[HOLD_W], p[M_SURGE]
    c, t = math.cos(s[YAW]), math.sin(s[YAW])
    speed = c * s[VX] + t * s[VY]
    drifting = s[DRIFT_X] ** 2 + s[DRIFT_Y] ** 2 > LEAST_DRIFT_MPS**2
    if drifting or (far > p[HOLD_RADIUS] and abs(speed) < SLOW_MPS):
        go_x, go_y = w * dx, w * dy
        if drifting:
            go_x, go_y = go_x - s[DRIFT_X], go_y - s[DRIFT_Y]
        if math.sqrt(go_x * go_x + go_y * go_y) > 0.5 * LEAST_DRIFT_MPS:
            towards = math.atan2(go_y, go_x)
            if abs(wrapped(towards - s[YAW])) > SWITCH_RAD:
                towards += math.pi
            s[WANTED] = towards
    fx, fy = mass * w * w * dx + s[HOLD_FX], mass * w * w * dy + s[HOLD_FY]
    surge = c * fx + t * fy - 2.0 * mass * w * speed
    return s[WANTED], surge, c * dx + t * dy


@kernel
def hold_windup(
    s: FloatArray, p: FloatArray, ahead: float, wanted: float, given: float, step_s: float
) -> None:
    """Move the integral on along the hull, knowing the force that the thrusters gave [N]."""
    pull = p[M_SURGE] * p[HOLD_W] * p[HOLD_W] * ahead / p[HOLD_TI]
    change = integrated(0.0, pull, wanted, given, step_s)
    s[HOLD_FX] += change * math.cos(s[YAW])
    s[HOLD_FY] += change * math.sin(s[YAW])
