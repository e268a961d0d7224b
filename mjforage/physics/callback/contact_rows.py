"""Contacts of hulls before MuJoCo solves them: gaps instead of margins, little drag while sliding.

MuJoCo holds the acceleration of a row of constraints at -b v - k d (gap - margin) or above. With a
margin it would keep hulls so far apart. With margin 0, b = 1/h and k = 1/h^2 this reads
"the velocity after the step h is -gap/h or above": a hull moves freely until the step in which it
would get through a face, and ends that step at the face (the velocity-level scheme of Anitescu and
Potra 2002, IJNME 55:753-784). Rows without margin, of the reference integrator and of items, stay.
"""

from typing import Final

from mjforage.base.compiled import inlined, kernel
from mjforage.physics.hydrodynamics.parameters import Float64Array

OUT_M: Final = 0.001  # deepest gap that one step closes: who starts deeper is not shot out
SLIDING_PER_S: Final = 1.0
"""Rate [1/s] at which friction stops a slide if a contact's force lets it.

MuJoCo's friction is convex: it lifts a sliding hull by friction x this rate x speed x h^2, which is
6 mm at 2 m/s. With b as the rate it would be a decimetre.
"""


@inlined
def closing_margin(gap: float) -> float:
    """Margin [m] of a row with one: what is left of the gap is closed by the end of the step."""
    return min(gap + OUT_M, 0.0)


@kernel
def prepare_rows(gap: Float64Array, margin: Float64Array, response: Float64Array) -> None:
    """Set margins and rates of the rows of constraints.

    Parameters
    ----------
    gap, margin : (row,) `efc_pos` and `efc_margin` [m]; margins are written
    response : (row * 4,) `efc_KBIP`; of each row k, b, and two that stay; k is 0 for friction alone
    """
    for i in range(margin.size):
        if margin[i] > 0.0:
            margin[i] = closing_margin(gap[i])
        if response[4 * i] == 0.0:
            response[4 * i + 1] = SLIDING_PER_S
