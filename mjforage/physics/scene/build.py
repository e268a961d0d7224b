"""Putting a scene together: water, quays, fleet and debris as one MuJoCo model."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.controllers import Chart
from mjforage.physics.callback.model_layout import (
    CLASS_WIDTH,
    HEADER,
    HEADER_NAME,
    INPUT_WIDTH,
    INSTANT,
    ITEM_DOFS,
    MAGIC,
    VESSEL_DOFS,
    VESSEL_WIDTH,
)
from mjforage.physics.hydrodynamics.parameters import pack_fleet
from mjforage.physics.scene.debris import DebrisClass, add_items, load_debris, parking_xy
from mjforage.physics.scene.mjcf import compiled, shipped_part
from mjforage.physics.scene.quays import add_quays
from mjforage.physics.scene.rectangles import narrowest_passage
from mjforage.physics.scene.vessel_bodies import add_vessel, hull_part, vessel_labels
from mjforage.physics.vessels import Vessel


@dataclass(frozen=True, eq=False)
class Scene:
    """A compiled world and its parts.

    Attributes
    ----------
    model : its degrees of freedom are x, y, yaw of each vessel, then x, y of each item
    vessels, names : (vessel,) what floats, and what it is called in the model
    items : bodies for items, the pool
    classes : debris classes that an item can have
    parking : (item, 2) where bodies lie that no item has [m]
    land : (column + 2, row + 2) bool, as `controllers.Chart` has it; empty: open water
    pitch_m : side of a map cell [m]
    parts : MJCF file of a vessel's vessel by the vessel's name, instead of the shipped one
    """

    model: mujoco.MjModel
    vessels: tuple[Vessel, ...]
    names: tuple[str, ...]
    items: int
    classes: tuple[DebrisClass, ...]
    parking: NDArray[np.float64]
    land: NDArray[np.bool_]
    pitch_m: float
    parts: Mapping[str, Path]


def build_scene(
    vessels: Sequence[Vessel],
    *,
    navigable: NDArray[np.bool_] | None = None,
    pitch_m: float = 4.0,
    items: int = 0,
    names: Sequence[str] | None = None,
    classes: Sequence[DebrisClass] | None = None,
    parts: Mapping[str, Path] | None = None,
    looks: Sequence[int] | bool = False,
) -> Scene:
    """Build a scene.

    Parameters
    ----------
    vessels : at least one, in the order of the fleet
    navigable : (row, column) map, or None for open water
    pitch_m : side of a map cell [m]
    items : bodies for items
    names : of the vessels
    classes : debris classes, by default those that ship
    parts : MJCF file of a vessel's vessel by the vessel's name, instead of the shipped one
    looks : False leaves out everything that only looks; True, or the class index of each item,
        for rendering. Motion is the same to the bit.

    Raises
    ------
    UserError
        If a vessel cannot turn in the narrowest passage, a part is malformed, or a number or name
        is out of range.
    """
    if not vessels:
        raise UserError("scene: no vessel; give at least one")
    kinds = tuple(load_debris() if classes is None else classes)
    _check_pitch(pitch_m)
    _check_items(items, kinds)
    shown = _item_looks(items, kinds, looks)
    if navigable is not None:
        check_passages(vessels, navigable, pitch_m)
    labels = vessel_labels(vessels, names)
    spec = shipped_part("scene")
    _numbers(spec, vessels, items, kinds)
    hulls = {v.name: hull_part(v, (parts or {}).get(v.name)) for v in vessels}
    for vessel, label in zip(vessels, labels, strict=True):
        add_vessel(spec, vessel, label, hulls[vessel.name], looks=looks is not False)
    if items:
        add_items(spec, shipped_part("debris"), shown)
    if navigable is not None:
        add_quays(spec, navigable, pitch_m)
    model = compiled(spec, "scene")
    _check_layout(model, len(vessels), items)
    land = np.zeros((0, 0), np.bool_) if navigable is None else Chart(navigable, pitch_m).land
    parking, own = parking_xy(items), dict(parts or {})
    return Scene(model, tuple(vessels), labels, items, kinds, parking, land, pitch_m, own)


@lru_cache(maxsize=8)
def with_bodies(scene: Scene, items: int) -> Scene:
    """The same scene without visual parts, with another number of bodies for items."""
    return build_scene(
        scene.vessels,
        navigable=~scene.land[1:-1, 1:-1].T[::-1] if scene.land.size else None,
        pitch_m=scene.pitch_m,
        items=items,
        names=scene.names,
        classes=scene.classes,
        parts=scene.parts,
    )


def check_passages(vessels: Sequence[Vessel], navigable: NDArray[np.bool_], pitch_m: float) -> None:
    """Check that every vessel can turn about midships in the narrowest passage of the map.

    Raises
    ------
    UserError
        If one cannot, the map has no water, or the pitch is no length.
    """
    _check_pitch(pitch_m)
    if not navigable.any():
        raise UserError(
            f"map of {navigable.shape[0]} x {navigable.shape[1]} cells: no water; "
            "mark cells that vessels can use as navigable"
        )
    cells = narrowest_passage(navigable)
    for vessel in vessels:
        needed = float(np.hypot(vessel.length_m, vessel.beam_m))
        if needed > cells * pitch_m:
            raise UserError(
                f"vessel {vessel.name}: a vessel of {vessel.length_m:g} m x {vessel.beam_m:g} m "
                f"needs {needed:.2f} m to turn, the narrowest corridor is {cells * pitch_m:g} m "
                f"wide; raise the pitch above {needed / cells:.2f} m or take a smaller vessel"
            )


def _whole(number: object) -> bool:
    return isinstance(number, int | np.integer) and not isinstance(number, bool)


def _check_pitch(pitch_m: float) -> None:
    if not 0.0 < pitch_m < np.inf:  # also catches what is not a number
        raise UserError(f"scene: pitch {pitch_m:g} m; give a finite number above 0")


def _check_items(items: int, classes: Sequence[DebrisClass]) -> None:
    if not _whole(items) or items < 0:
        raise UserError(f"scene: {items} items; give a whole number, 0 or more")
    if items and not classes:
        raise UserError(f"scene: {items} items and no debris class; give a class")


def _numbers(
    spec: mujoco.MjSpec, vessels: Sequence[Vessel], items: int, classes: Sequence[DebrisClass]
) -> None:
    """Numerics of the callback, before any other numeric (see `callback.model_layout`)."""
    header = [MAGIC, len(vessels), items, len(classes), INSTANT]
    assert len(header) == HEADER
    table = [[c.mass_kg + c.added_mass_kg, c.air, c.water] for c in classes]
    spec.add_numeric(name=HEADER_NAME, data=np.array(header), size=HEADER)
    for i, hull in enumerate(pack_fleet(vessels).view(np.float64).reshape(-1, VESSEL_WIDTH)):
        spec.add_numeric(name=f"{HEADER_NAME}-vessel-{i}", data=hull, size=VESSEL_WIDTH)
    flat = np.array(table, np.float64).reshape(-1)
    if flat.size:
        spec.add_numeric(name=f"{HEADER_NAME}-items", data=flat, size=CLASS_WIDTH * len(classes))
    spec.nuserdata = INPUT_WIDTH * (len(vessels) + items)


def _item_looks(
    items: int, classes: Sequence[DebrisClass], looks: Sequence[int] | bool
) -> list[str | None]:
    if looks is False:
        return [None] * items
    if looks is True:
        return [classes[0].name if classes else None] * items
    if len(looks) != items:
        raise UserError(f"scene: {len(looks)} looks for {items} items; give one for each")
    for k in looks:
        if not _whole(k) or not 0 <= k < len(classes):
            raise UserError(f"scene: look {k}; give classes from 0 to {len(classes) - 1}")
    return [classes[k].name for k in looks]


def _check_layout(model: mujoco.MjModel, vessels: int, items: int) -> None:
    """The callback counts on this; MuJoCo shortens rows of M where it thinks it can."""
    expected = [1, 2, 3] * vessels + [1, 1] * items
    if model.nv != VESSEL_DOFS * vessels + ITEM_DOFS * items or model.na != 2 * vessels:
        raise UserError("scene: a hull part has joints or actuators of its own; remove them")
    assert model.M_rownnz.tolist() == expected, "mass matrix of another shape than the callback's"
    assert model.numeric_data[0] == MAGIC, "another numeric comes before ours"
