"""Classes of floating items, `models/debris.toml`: mass, drag in air and water, leeway."""

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.toml_files import read_toml
from mjforage.controllers.propulsion import WATER_DENSITY_KGPM3
from mjforage.scenario.assets import models_folder
from mjforage.scenario.quantities import Quantity, positive
from mjforage.scenario.scenario import Physics
from mjforage.scenario.schema import NotInFile, check

AIR_DENSITY_KGPM3 = 1.224  # Blendermann's tables, as in MSS


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


def item_choices(choice: Physics) -> NDArray[np.int64]:
    """Index of each of the scenario's item classes among those that ship.

    Raises `UserError` if a class is not known, or there is none.
    """
    known = [kind.name for kind in load_debris()]
    for name in choice.item_classes:
        if name not in known:
            raise UserError(f"physics.item_classes: {name!r}; choose from {', '.join(known)}")
    if not choice.item_classes:
        raise UserError(f"physics.item_classes is empty; choose from {', '.join(known)}")
    return np.array([known.index(name) for name in choice.item_classes], np.int64)
