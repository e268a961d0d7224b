"""Thrusters: curve, dead zone and saturation of one side; both sides.

A command is a propeller's speed [rad/s] or a force [N], as the vessel has it. The lag acts on the
command, the curve on what the lag lets through.
"""

import math

from mjforage.base.compiled import kernel
from mjforage.physics.hydrodynamics.parameters import THRUST_PROPELLER, VesselParameters


@kernel
def saturated(p: VesselParameters, command: float) -> float:
    """The command inside the thruster's range."""
    return float(min(max(command, p.command_min), p.command_max))


@kernel
def thrust(p: VesselParameters, command: float) -> float:
    """Steady thrust of one side [N], ahead positive: k n |n|, or the force outside the dead zone.

    Parameters
    ----------
    command : [rad/s] or [N]; beyond the range it counts as the range's end
    """
    c = saturated(p, command)
    if p.thrust_kind == THRUST_PROPELLER:
        return float((p.k_ahead if c > 0.0 else p.k_astern) * c * abs(c))
    return c if abs(c) >= p.dead_zone else 0.0


@kernel
def command_for(p: VesselParameters, force: float) -> float:
    """Command of one side whose steady thrust is nearest to `force` [N]."""
    if p.thrust_kind != THRUST_PROPELLER:
        return saturated(p, force)
    if force > 0.0:
        return saturated(p, math.sqrt(force / p.k_ahead))
    return saturated(p, -math.sqrt(-force / p.k_astern))


@kernel
def thruster_force(p: VesselParameters, port: float, starboard: float) -> tuple[float, float]:
    """Surge force [N] and yaw moment [N m] of both sides; port, at +y, turns clockwise."""
    left, right = thrust(p, port), thrust(p, starboard)
    return left + right, p.lever * (right - left)
