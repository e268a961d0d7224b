"""Debris: classes of floating items with drag in air and water, and the pool of bodies for them."""

import math
import tomllib
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from mjforage.core.assets import models_folder
from mjforage.core.errors import UserError
from mjforage.physics.hydrodynamics.parameters import AIR_DENSITY_KGPM3
from mjforage.physics.vessel_file import positive, quantity, range_words

WATER_DENSITY_KGPM3 = 1025.0  # sea water
PARKING_PITCH_M = 1.0  # distance between parked items
PARKING_OFF_M = 50.0  # of parked items, beyond the map's south-west corner


@dataclass(frozen=True)
class DebrisClass:
    """One class of `models/debris.toml`."""

    name: str
    description: str
    mass_kg: float = field(metadata=positive("kg", 1e4))
    added_mass_kg: float = field(metadata=quantity("kg", 0.0, 1e4))
    area_air_m2: float = field(metadata=positive("m2", 1e3))
    area_water_m2: float = field(metadata=positive("m2", 1e3))
    drag_air: float = field(metadata=positive("1", 10))
    drag_water: float = field(metadata=positive("1", 10))
    leeway_low: float = field(metadata=quantity("1", 0.0, 1.0))  # published range of the class
    leeway_high: float = field(metadata=quantity("1", 0.0, 1.0))

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

    def response_s(self, wind_mps: float) -> float:
        """Time constant of small departures from steady drift in still water [s]."""
        drift = self.leeway * wind_mps
        slope = 2.0 * (self.air * (wind_mps - drift) + self.water * drift)
        return (self.mass_kg + self.added_mass_kg) / slope


def load_debris(path: str | Path | None = None) -> tuple[DebrisClass, ...]:
    """Read debris classes, those that ship by default.

    Raises
    ------
    UserError
        If the file is not readable, has no class, or a class is not as `DebrisClass` says or
        drifts outside its own published range.
    """
    file = models_folder() / "debris.toml" if path is None else Path(path)
    where = f"debris {file.name}"
    try:
        tree = tomllib.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise UserError(f"{where}: not readable as TOML ({error})") from error
    if not tree:
        raise UserError(f"{where}: no class; add a table such as [bottle]")
    return tuple(_read(name, entry, f"{where}: {name}") for name, entry in tree.items())


def _read(name: str, entry: object, where: str) -> DebrisClass:
    known = {f.name: f.metadata for f in fields(DebrisClass) if f.name != "name"}
    if not isinstance(entry, dict) or sorted(entry) != sorted(known):
        given = ", ".join(entry) if isinstance(entry, dict) else repr(entry)
        raise UserError(f"{where} has {given}; give {', '.join(known)}")
    if not isinstance(entry["description"], str):
        raise UserError(f"{where}.description = {entry['description']!r}, expected text")
    numbers = {
        key: _number(entry[key], about, f"{where}.{key}") for key, about in known.items() if about
    }
    kind = DebrisClass(name=name, description=entry["description"], **numbers)
    _check_leeway(kind, where)
    return kind


def _check_leeway(kind: DebrisClass, where: str) -> None:
    low, high = kind.leeway_low, kind.leeway_high
    if low > high:
        raise UserError(
            f"{where}.leeway_low = {low:g} is above leeway_high = {high:g}; exchange them"
        )
    if not low <= kind.leeway <= high:
        raise UserError(
            f"{where}: leeway {kind.leeway:.5f} of the wind lies outside {low:g} to {high:g}; "
            "change areas or drags, or the published range"
        )


def _number(entry: object, about: Any, where: str) -> float:
    if not isinstance(entry, dict) or sorted(entry) != ["source", "unit", "value"]:
        raise UserError(f"{where} = {entry!r}; give a table of value, unit and source")
    value, unit, source = entry["value"], entry["unit"], entry["source"]
    if unit != about["unit"] or not isinstance(source, str) or not source.strip():
        raise UserError(f'{where}: unit {unit!r}, expected "{about["unit"]}" and a source')
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise UserError(f"{where} = {value!r}, expected a number")
    if not about["low"] <= value <= about["high"]:
        raise UserError(f"{where} = {value!r}; give {range_words(about)}")
    return float(value)


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
    for k, look in enumerate(looks):
        frame = spec.worldbody.add_frame()
        body = frame.attach_body(part.copy().body("item"), f"item-{k}/", "")
        for geom in list(body.geoms):
            kept = look is not None and geom.name.startswith(f"item-{k}/{look}")
            if geom.classname.name.endswith("item-look") and not kept:
                spec.delete(geom)
