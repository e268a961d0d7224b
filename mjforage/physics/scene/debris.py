"""Debris: classes of floating items with drag in air and water, and the pool of bodies for them."""

import math
from dataclasses import dataclass
from typing import Annotated

import mujoco
import numpy as np
from numpy.typing import NDArray

from mjforage.base.toml_files import read_toml
from mjforage.physics.hydrodynamics.parameters import AIR_DENSITY_KGPM3
from mjforage.physics.quantities import Quantity, positive
from mjforage.scenario.assets import models_folder
from mjforage.scenario.schema import NotInFile, check

WATER_DENSITY_KGPM3 = 1025.0  # sea water
PARKING_PITCH_M = 1.0  # distance between parked items
PARKING_OFF_M = 50.0  # of parked items, beyond the map's south-west corner


@dataclass(frozen=True)
class DebrisClass:
    """One class of `models/debris.toml`."""

    name: Annotated[str, NotInFile()]
    description: str
    """Kind of item, in one line."""
    mass_kg: Annotated[float, positive("kg", 1e4)]
    """Mass of an item."""
    added_mass_kg: Annotated[float, Quantity("kg", 0.0, 1e4)]
    """Mass of the water that moves with it."""
    area_air_m2: Annotated[float, positive("m2", 1e3)]
    """Area in the air, seen from the side."""
    area_water_m2: Annotated[float, positive("m2", 1e3)]
    """Area in the water, seen from the side."""
    drag_air: Annotated[float, positive("1", 10)]
    """Drag coefficient in the air."""
    drag_water: Annotated[float, positive("1", 10)]
    """Drag coefficient in the water."""
    leeway_low: Annotated[float, Quantity("1", 0.0, 1.0)]
    """Lower end of the published leeway of the class, over the wind."""
    leeway_high: Annotated[float, Quantity("1", 0.0, 1.0)]
    """Upper end of the published leeway of the class, over the wind."""

    @property
    def air(self) -> float:
        """Quadratic drag of the air, 1/2 rho Ca Aa [N s2/m2]."""
        return 0.5 * AIR_DENSITY_KGPM3 * self.drag_air * self.area_air_m2

    @property
    def water(self) -> float:
        """Quadratic drag of the water, 1/2 rho Cw Aw [N s2/m2]."""
        return 0.5 * WATER_DENSITY_KGPM3 * self.drag_water * self.area_water_m2

    @property
    def leeway(self) -> float:
        """Share of the wind at which it drifts in still water: k / (1 + k), k^2 = air / water."""
        k = math.sqrt(self.air / self.water)
        return k / (1.0 + k)


def load_debris() -> tuple[DebrisClass, ...]:
    """Read the debris classes that ship."""
    tree = read_toml(models_folder() / "debris.toml", "debris")
    return tuple(check(DebrisClass, tree[name], f"debris {name}", name=name) for name in tree)


def parking_xy(items: int) -> NDArray[np.float64]:
    """(item, 2) where items that are not on the water lie, apart from each other and all else."""
    x = -PARKING_OFF_M - PARKING_PITCH_M * np.arange(items)
    return np.stack((x, np.full(items, -PARKING_OFF_M)), axis=1)


def add_items(spec: mujoco.MjSpec, part: mujoco.MjSpec, looks: list[str | None]) -> None:
    """Add one body per entry of `looks`: the class it looks like, or None for a bare collider.

    Parameters
    ----------
    part : of `models/debris.xml`
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
