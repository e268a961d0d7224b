"""The pool of bodies for floating items, and what classes of them look like."""

import math

import mujoco
import numpy as np
from numpy.typing import NDArray

PARKING_PITCH_M = 1.0  # distance between parked items
PARKING_OFF_M = 50.0  # of parked items, beyond the map's south-west corner


def parking_xy(items: int) -> NDArray[np.float64]:
    """(item, 2) where items that are not on the water lie, apart from each other and all else."""
    x = -PARKING_OFF_M - PARKING_PITCH_M * np.arange(items)
    return np.stack((x, np.full(items, -PARKING_OFF_M)), axis=1)


def add_items(spec: mujoco.MjSpec, part: mujoco.MjSpec, looks: list[str | None]) -> None:
    """Add one body per entry of `looks`: the class it looks like, or None for a bare collider.

    `part`: of `models/debris.xml`.
    """
    parts = {look: _with_look(part, look) for look in set(looks)}
    for k, look in enumerate(looks):
        frame = spec.worldbody.add_frame()
        frame.attach_body(parts[look].copy().body("item"), f"item-{k}/", "")


def _with_look(part: mujoco.MjSpec, look: str | None) -> mujoco.MjSpec:
    """The part with what one class looks like alone: what is deleted later costs a whole scene."""
    bare = part.copy()
    bare.geom("collider").mass = math.nan  # of MuJoCo's density: the softness of contacts is set so
    for geom in list(bare.body("item").geoms):
        seen = look is not None and geom.name.startswith(look)
        if geom.classname.name == "item-look" and not seen:
            bare.delete(geom)
    return bare
