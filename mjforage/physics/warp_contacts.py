"""Contacts of hulls in MuJoCo Warp: rows of constraints as `callback.contact_rows` has them.

MuJoCo Warp calls its callback after it has set the rows' accelerations, so they are set anew here.
"""

from typing import Any

import mujoco
import warp as wp
from mujoco_warp import OverflowType

from mjforage.base.errors import UserError
from mjforage.base.warped import warped
from mjforage.physics.callback.contact_rows import SLIDING_PER_S, closing_margin
from mjforage.physics.simulation.fenders import HULL

_NO_ROOM = (
    OverflowType.NEFC | OverflowType.NJMAX_NNZ | OverflowType.BROADPHASE | OverflowType.NARROWPHASE
)
_closing_margin = warped(closing_margin)


@wp.kernel(module="unique")  # type: ignore[untyped-decorator]
def _prepare(
    law: wp.vec2,
    rows: wp.array(dtype=int),  # type: ignore[valid-type]
    contact: wp.array2d(dtype=int),  # type: ignore[valid-type]
    row_of: wp.array2d(dtype=int),  # type: ignore[valid-type]
    gap: wp.array(dtype=float),  # type: ignore[valid-type]
    speed: wp.array2d(dtype=float),  # type: ignore[valid-type]
    least: wp.array2d(dtype=float),  # type: ignore[valid-type]
) -> None:
    """Least acceleration of row r of world w: -b v - k d (gap - margin), or friction's."""
    w, r = wp.tid()  # type: ignore[misc]
    if r >= rows[w]:
        return
    c = contact[w, r]
    if row_of[c, 0] == r:
        least[w, r] = -law[1] * speed[w, r] - law[0] * (gap[c] - _closing_margin(gap[c]))
    else:
        least[w, r] = -SLIDING_PER_S * speed[w, r]


class ContactRows:
    """The rows of a model's contacts; hulls and quays have one law (`simulation.fenders`)."""

    def __init__(self, model: mujoco.MjModel) -> None:
        """Read k d [1/s2] and b [1/s] as MuJoCo makes them of a geom's numbers."""
        hull = int((model.geom_contype == HULL).argmax())
        rigid = float(model.geom_solimp[hull, 1])
        stiffness, damping = -model.geom_solref[hull]
        self._law = wp.vec2(stiffness / rigid, damping / rigid)

    def prepare(self, data: Any) -> None:
        """Set the rows; of the callback."""
        contact, rows = data.contact, data.efc
        inputs = [self._law, data.nefc, rows.id, contact.efc_address, contact.dist, rows.vel]
        wp.launch(_prepare, rows.id.shape, [*inputs, rows.aref], device=data.qpos.device)


def check_room(data: Any, most: int) -> None:
    """Fail if contacts have been left out since the start.

    Raises `UserError` if so.

    `most`: contacts of a world for which there is room.
    """
    if (data.overflow.numpy() & int(_NO_ROOM)).any():
        raise UserError(f"warp: more than {most} contacts of a world's hulls; give more room")
