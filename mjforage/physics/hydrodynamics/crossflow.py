"""Cross-flow drag: strips of a slender vessel meet the water sideways at v + x r each."""

from mjforage.base.compiled import kernel
from mjforage.physics.hydrodynamics.parameters import CROSS_INTEGRATED, CROSS_NONE, VesselParameters

INTERVALS = 20  # of the Otter's strips: 21 of them, each 1/20 of the length wide


@kernel
def _strips(length: float, v: float, r: float) -> tuple[float, float]:
    """Sum of s|s| and of x s|s| over 21 strips, s = v + x r, times their width."""
    width = length / float(INTERVALS)
    force = moment = 0.0
    for i in range(INTERVALS + 1):
        x = float(i - INTERVALS // 2) * width
        s = v + x * r
        force += s * abs(s) * width
        moment += x * s * abs(s) * width
    return force, moment


@kernel
def _integrals(length: float, v: float, r: float) -> tuple[float, float]:
    """Integral of s|s| and of x s|s| over the length, s = v + x r, in closed form."""
    half = 0.5 * length
    if abs(v) >= abs(r) * half:  # all strips on one side: s|s| = +-s^2
        sign = 1.0 if v >= 0.0 else -1.0
        cubed = half * half * half
        return (
            sign * (2.0 * v * v * half + 2.0 / 3.0 * r * r * cubed),
            sign * 4.0 / 3.0 * v * r * cubed,
        )
    aft, fore = v - half * r, v + half * r
    first = (abs(fore) * fore * fore - abs(aft) * aft * aft) / 3.0  # integral of s|s| ds
    second = (abs(fore) * fore * fore * fore - abs(aft) * aft * aft * aft) / 4.0  # of s^2|s| ds
    return first / r, (second - v * first) / r / r  # r * r could underflow


@kernel
def cross_flow_slope(p: VesselParameters, v_r: float, r: float) -> tuple[float, float]:
    """Damping by cross-flow drag: -dY/dv [N s/m] and -dN/dr [N m s], never below 0.

    Twice 1/2 rho Cd T times the integrals of |v + x r| and of x^2 |v + x r| over the length, also
    for the Otter's strips, which have 5-10 % more.
    """
    if p.cross_kind == CROSS_NONE:
        return 0.0, 0.0
    half, double = 0.5 * p.cross_length, 2.0 * p.cross_factor
    if abs(v_r) >= abs(r) * half:  # all strips on one side
        side = 2.0 * half * abs(v_r)
        return double * side, double * side * half * half / 3.0
    aft, fore = v_r - half * r, v_r + half * r  # of opposite signs
    one = (abs(fore) * fore - abs(aft) * aft) / 2.0 / r  # integral of |s| dx, s = v + x r
    two = (abs(fore) * fore * fore - abs(aft) * aft * aft) / 3.0 / r  # of s |s|
    three = (abs(fore) * fore * fore * fore - abs(aft) * aft * aft * aft) / 4.0 / r  # of s^2 |s|
    return double * one, double * ((three - 2.0 * v_r * two + v_r * v_r * one) / r / r)


@kernel
def cross_flow(p: VesselParameters, v_r: float, r: float) -> tuple[float, float]:
    """Sway force and yaw moment of cross-flow drag.

    Y = -1/2 rho Cd T * integral of |v + x r| (v + x r) dx, N the same with x
    (Fossen 2021, section 6.7; Faltinsen 1990, chapter 6). The Otter's set sums strips instead.

    Returns: y [N] to port, N [N m].

    `v_r`: sway velocity relative to the water, to port [m/s]; `r`: yaw rate [rad/s].
    """
    if p.cross_kind == CROSS_NONE:
        return 0.0, 0.0
    if p.cross_kind == CROSS_INTEGRATED:
        force, moment = _integrals(p.cross_length, v_r, r)
    else:
        force, moment = _strips(p.cross_length, v_r, r)
    return -p.cross_factor * force, -p.cross_factor * moment
