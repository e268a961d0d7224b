"""Distance between oriented boxes in the plane, by their separating axes."""

import math

from mjforage.base.compiled import kernel


@kernel
def box_gap(
    dx: float,
    dy: float,
    ca: float,
    sa: float,
    half_length_a: float,
    half_beam_a: float,
    cb: float,
    sb: float,
    half_length_b: float,
    half_beam_b: float,
) -> float:
    """Largest separation of boxes A and B along any of their four axes [m]; negative: overlap.

    It is their distance where a side faces a corner, and at least 0.7 of it between two corners.

    Parameters
    ----------
    dx, dy : centre of B minus centre of A [m]
    ca, sa, cb, sb : cosine and sine of each heading
    """
    c, s = abs(ca * cb + sa * sb), abs(ca * sb - sa * cb)
    a = abs(ca * dx + sa * dy) - half_length_a - c * half_length_b - s * half_beam_b
    b = abs(ca * dy - sa * dx) - half_beam_a - s * half_length_b - c * half_beam_b
    d = abs(cb * dx + sb * dy) - half_length_b - c * half_length_a - s * half_beam_a
    e = abs(cb * dy - sb * dx) - half_beam_b - s * half_length_a - c * half_beam_a
    return max(max(a, b), max(d, e))


@kernel
def circle_radius(length: float, beam: float) -> float:
    """Radius of the circle that a vessel turning about its middle stays in [m]."""
    return 0.5 * math.sqrt(length * length + beam * beam)
