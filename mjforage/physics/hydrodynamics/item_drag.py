"""Drag of air and water on a floating item."""

import math

from mjforage.base.compiled import kernel

STIFF = 1.2  # drag rate times step above which Runge-Kutta (limit 2.78 on twice this) is tamed


@kernel
def item_load(
    mass_kg: float,
    air: float,
    water: float,
    ax: float,
    ay: float,
    wx: float,
    wy: float,
    step_s: float,
    averaged: bool,
) -> tuple[float, float, float]:
    """Drag k_a |a| a + k_w |w| w [N] on an item, x and y, and the mass [kg] that feels it.

    Linearly implicit where forces shall be `averaged` over the coming step: the slope
    (k_a |a| + k_w |w|) h is put into the mass. Else the mass grows only where Runge-Kutta could not
    take the step.

    Parameters
    ----------
    mass_kg, air, water : of the item with the water that moves with it [kg]; k_a, k_w [N s2/m2]
    ax, ay, wx, wy : velocity of air and of water past the item [m/s]
    """
    of_air = air * math.sqrt(ax * ax + ay * ay)
    of_water = water * math.sqrt(wx * wx + wy * wy)
    slope = step_s * (of_air + of_water)
    felt = mass_kg + slope if averaged else mass_kg * max(1.0, slope / (STIFF * mass_kg))
    return of_air * ax + of_water * wx, of_air * ay + of_water * wy, felt
