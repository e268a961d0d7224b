"""Thrusters: curve, dead zone and saturation of one side; both sides under way.

A command is a propeller's speed [rad/s] or a force [N], as the vessel has it moored. Under way it
takes the same power and gives less thrust (`controllers.propulsion`). The lag acts on the command,
the curve on what the lag lets through.
"""

import math

from mjforage.base.compiled import kernel
from mjforage.controllers.propulsion import thrust_slope, thrust_under_way
from mjforage.physics.hydrodynamics.parameters import THRUST_PROPELLER, VesselParameters


@kernel
def saturated(p: VesselParameters, command: float) -> float:
    """The command inside the thruster's range."""
    return float(min(max(command, p.command_min), p.command_max))


@kernel
def thrust(p: VesselParameters, command: float) -> float:
    """Steady thrust of one side moored [N], ahead positive: k n |n|, or the force outside the dead
    zone.

    `command`: [rad/s] or [N]; beyond the range it counts as the range's end.
    """
    c = saturated(p, command)
    if p.thrust_kind == THRUST_PROPELLER:
        return float((p.k_ahead if c > 0.0 else p.k_astern) * c * abs(c))
    return c if abs(c) >= p.dead_zone else 0.0


@kernel
def command_for(p: VesselParameters, force: float) -> float:
    """Command of one side whose steady thrust moored is nearest to `force` [N]."""
    if p.thrust_kind != THRUST_PROPELLER:
        return saturated(p, force)
    if force > 0.0:
        return saturated(p, math.sqrt(force / p.k_ahead))
    return saturated(p, -math.sqrt(-force / p.k_astern))


@kernel
def crosses_dead_zone(p: VesselParameters, start: float, end: float) -> bool:
    """True if a lagged command that goes from `start` to `end` enters or leaves the dead zone."""
    low, high, zone = min(start, end), max(start, end), p.dead_zone
    outside, inside = low >= zone or high <= -zone, low > -zone and high < zone
    return zone > 0.0 and high > low and not (outside or inside)


@kernel
def lost_impulse(p: VesselParameters, command: float, start: float, end: float) -> float:
    """Impulse [N s] that the dead zone takes while the lagged command goes from `start` to `end`.

    c(t) = command + (start - command) exp(-t / lag) is monotonic, so that it is in the dead zone
    from one time to another; the impulse is the integral of c between the two.
    """
    first = min(max(start, -p.dead_zone), p.dead_zone)
    last = min(max(end, -p.dead_zone), p.dead_zone)
    inside_s = p.lag * math.log((first - command) / (last - command))
    return command * inside_s + p.lag * (first - last)


@kernel
def thrust_in_step(
    p: VesselParameters, command: float, start: float, step_s: float
) -> tuple[float, float, float]:
    """Thrust of one side [N] at the start, the middle and the end of a step, for Simpson's rule.

    Where the lagged command enters or leaves the dead zone within the step, the thrust jumps, which
    no such rule sees. The three are then those without a dead zone less the mean that it takes.

    `command`: within the thruster's range, [rad/s] or [N]; `start`: lagged command at the start.
    """
    half = math.exp(-0.5 * step_s / p.lag)
    middle, end = command + (start - command) * half, command + (start - command) * half * half
    if not crosses_dead_zone(p, start, end):
        return thrust(p, start), thrust(p, middle), thrust(p, end)
    lost = lost_impulse(p, command, start, end) / step_s
    return start - lost, middle - lost, end - lost


@kernel
def thrust_amid_step(p: VesselParameters, command: float, lagged: float, step_s: float) -> float:
    """Thrust of one side [N] for a stage of Runge-Kutta, where the dead zone's edge is a ramp.

    The dead zone takes its mean from half a step before to half a step after, so that stages a
    step apart share a jump instead of seeing it or not.
    """
    half, away = math.exp(-0.5 * step_s / p.lag), lagged - command
    start, end = command + away / half, command + away * half
    if not crosses_dead_zone(p, start, end):
        return thrust(p, lagged)
    return lagged - lost_impulse(p, command, start, end) / step_s


@kernel
def force_of_sides(
    p: VesselParameters, port: float, starboard: float, u_r: float, r: float
) -> tuple[float, float]:
    """Surge force [N] and yaw moment [N m] of both sides under way; port, at +y, turns clockwise.

    Parameters
    ----------
    port, starboard : thrusts moored [N]
    u_r, r : surge velocity through the water [m/s], yaw rate [rad/s]
    """
    left = thrust_under_way(port, u_r - p.lever * r, p.disc)
    right = thrust_under_way(starboard, u_r + p.lever * r, p.disc)
    return left + right, p.lever * (right - left)


@kernel
def thruster_force(
    p: VesselParameters, port: float, starboard: float, u_r: float, r: float
) -> tuple[float, float]:
    """`force_of_sides` of two lagged commands [rad/s or N]."""
    return force_of_sides(p, thrust(p, port), thrust(p, starboard), u_r, r)


@kernel
def thruster_slope(
    p: VesselParameters, port: float, starboard: float, u_r: float, r: float
) -> tuple[float, float]:
    """Fall of `force_of_sides` with surge velocity [N s/m] and yaw rate [N m s], each >= 0."""
    left = thrust_slope(port, u_r - p.lever * r, p.disc)
    right = thrust_slope(starboard, u_r + p.lever * r, p.disc)
    return left + right, p.lever * p.lever * (left + right)
