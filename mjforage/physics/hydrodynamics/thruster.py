"""Thrusters: curve, dead zone and saturation of one side; both sides; the first-order lag.

A command is a propeller's speed [rad/s] or a force [N], as the vessel has it. The lag acts on the
command, the curve on what the lag lets through.
"""

import math

from graph_planner.compiled import kernel
from mjforage.physics.hydrodynamics.parameters import (
    COMMAND_MAX,
    COMMAND_MIN,
    DEAD_ZONE,
    K_AHEAD,
    K_ASTERN,
    LAG,
    LEVER,
    THRUST_KIND,
    THRUST_PROPELLER,
    Float64Array,
)


@kernel
def saturated(p: Float64Array, command: float) -> float:
    """The command inside the thruster's range."""
    return float(min(max(command, p[COMMAND_MIN]), p[COMMAND_MAX]))


@kernel
def thrust(p: Float64Array, command: float) -> float:
    """Steady thrust of one side [N], ahead positive: k n |n|, or the force outside the dead zone.

    Parameters
    ----------
    p : (SIZE,) of `pack`
    command : [rad/s] or [N]; beyond the range it counts as the range's end
    """
    c = saturated(p, command)
    if p[THRUST_KIND] == THRUST_PROPELLER:
        return float((p[K_AHEAD] if c > 0.0 else p[K_ASTERN]) * c * abs(c))
    return c if abs(c) >= p[DEAD_ZONE] else 0.0


@kernel
def command_for(p: Float64Array, force: float) -> float:
    """The command of one side whose steady thrust is `force` [N], or the nearest it can give."""
    if p[THRUST_KIND] != THRUST_PROPELLER:
        return saturated(p, force)
    if force > 0.0:
        return saturated(p, math.sqrt(force / p[K_AHEAD]))
    return saturated(p, -math.sqrt(-force / p[K_ASTERN]))


@kernel
def thruster_force(p: Float64Array, port: float, starboard: float) -> tuple[float, float]:
    """Surge force [N] and yaw moment [N m] of both sides; port, at +y, turns clockwise."""
    left, right = thrust(p, port), thrust(p, starboard)
    return left + right, p[LEVER] * (right - left)


@kernel
def lagged(p: Float64Array, state: float, command: float, step_s: float) -> float:
    """State of the first-order lag after `step_s` of a constant command, exactly."""
    c = saturated(p, command)
    return c + (state - c) * math.exp(-step_s / p[LAG])
