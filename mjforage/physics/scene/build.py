"""Putting a scene together: water, quays, fleet and debris as one MuJoCo model."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import mujoco
import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.controllers.chart import NO_WALLS, OPEN_WATER, Chart, LandArray, cells_of
from mjforage.physics.callback.model_layout import (
    CLASS_WIDTH,
    HEADER,
    HEADER_NAME,
    INPUT_WIDTH,
    INSTANT,
    ITEM_DOFS,
    MAGIC,
    VESSEL_DOFS,
    VESSEL_INPUTS,
    VESSEL_WIDTH,
)
from mjforage.physics.hydrodynamics.parameters import pack_fleet
from mjforage.physics.scene.debris import add_items, parking_xy
from mjforage.physics.scene.mjcf import compiled, shipped_part
from mjforage.physics.scene.quays import add_quays
from mjforage.physics.scene.rectangles import narrowest_passage
from mjforage.physics.scene.vessel_bodies import add_vessel, hull_part
from mjforage.physics.vessels import Vessel
from mjforage.scenario.debris import DebrisClass, load_debris


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
    land : as `controllers.Chart` has it
    pitch_m : side of a map cell [m]
    walls : (wall, 5) outlines of its quays, as of `controllers.Chart`
    """

    model: mujoco.MjModel
    vessels: tuple[Vessel, ...]
    names: tuple[str, ...]
    items: int
    classes: tuple[DebrisClass, ...]
    parking: NDArray[np.float64]
    land: LandArray
    pitch_m: float
    walls: NDArray[np.float64]


def build_scene(
    vessels: Sequence[Vessel],
    *,
    navigable: NDArray[np.bool_] | None = None,
    pitch_m: float = 4.0,
    items: int = 0,
    names: Sequence[str] | None = None,
    looks: Sequence[int] | None = None,
    walls: NDArray[np.float64] = NO_WALLS,
) -> Scene:
    """Build a scene.

    Raises `UserError` if there is no vessel, or one cannot turn in the narrowest passage.

    Parameters
    ----------
    vessels : at least one, in the order of the fleet
    navigable : (row, column) map, or None for open water
    pitch_m : side of a map cell [m]
    items : bodies for items
    names : of the vessels, all different; by default ``scout_0``, ``forager_1``, ...
    looks : class index of each item, for rendering; None leaves out everything that only looks.
        Motion is the same to the bit.
    walls : (wall, 5) outlines of quays, as of `controllers.Chart`; by default quays are cells
    """
    if not vessels:
        raise UserError("scene: no vessel; give at least one")
    if navigable is not None:
        check_passages(vessels, navigable, pitch_m)
    classes = load_debris()
    labels = tuple(f"{v.name}_{i}" for i, v in enumerate(vessels)) if names is None else names
    seen = (None,) * items if looks is None else tuple(classes[k].name for k in looks)
    spec = scene_spec(
        vessels, labels, navigable, pitch_m, seen, looks=looks is not None, walls=walls
    )
    model = compiled(spec, "scene")
    _check_layout(model, len(vessels), items)
    land = OPEN_WATER if navigable is None else Chart(navigable, pitch_m, walls).land
    fleet, parking = (tuple(vessels), tuple(labels)), parking_xy(items)
    return Scene(model, *fleet, items, classes, parking, land, pitch_m, walls)


def scene_spec(
    vessels: Sequence[Vessel],
    labels: Sequence[str],
    navigable: NDArray[np.bool_] | None,
    pitch_m: float,
    seen: Sequence[str | None],
    *,
    looks: bool,
    walls: NDArray[np.float64] = NO_WALLS,
) -> mujoco.MjSpec:
    """A scene before MuJoCo compiles it; parameters as of `build_scene`.

    `seen`: of each item, the class that it looks like, or None.
    """
    spec = shipped_part("scene")
    _add_numerics(spec, vessels, len(seen), load_debris())
    parts = {vessel.name: hull_part(vessel) for vessel in vessels}
    for vessel, label in zip(vessels, labels, strict=True):
        add_vessel(spec, vessel, label, parts[vessel.name], looks=looks)
    if seen:
        add_items(spec, shipped_part("debris"), list(seen))
    if navigable is not None:
        add_quays(spec, navigable, pitch_m, walls)
    return spec


@lru_cache(maxsize=8)
def with_bodies(scene: Scene, items: int) -> Scene:
    """The same scene without visual parts, with another number of bodies for items."""
    return build_scene(
        scene.vessels,
        navigable=~cells_of(scene.land)[1:-1, 1:-1].T[::-1] if scene.land.size else None,
        pitch_m=scene.pitch_m,
        items=items,
        names=scene.names,
        walls=scene.walls,
    )


def check_passages(vessels: Sequence[Vessel], navigable: NDArray[np.bool_], pitch_m: float) -> None:
    """Check that every vessel can turn about midships in the narrowest passage of the map.

    Raises `UserError` if one cannot, or the map has no water.
    """
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


def _add_numerics(
    spec: mujoco.MjSpec, vessels: Sequence[Vessel], items: int, classes: Sequence[DebrisClass]
) -> None:
    """Add the callback's numerics, before any other numeric (see `callback.model_layout`)."""
    header = [MAGIC, len(vessels), items, len(classes), INSTANT]
    table = [[c.mass_kg + c.added_mass_kg, c.air, c.water] for c in classes]
    spec.add_numeric(name=HEADER_NAME, data=np.array(header), size=HEADER)
    for i, row in enumerate(pack_fleet(vessels).view(np.float64).reshape(-1, VESSEL_WIDTH)):
        spec.add_numeric(name=f"{HEADER_NAME}-vessel-{i}", data=row, size=VESSEL_WIDTH)
    flat = np.array(table, np.float64).reshape(-1)
    spec.add_numeric(name=f"{HEADER_NAME}-items", data=flat, size=CLASS_WIDTH * len(classes))
    spec.nuserdata = VESSEL_INPUTS * len(vessels) + INPUT_WIDTH * items


def _check_layout(model: mujoco.MjModel, vessels: int, items: int) -> None:
    """The callback counts on this; MuJoCo shortens rows of M where it thinks it can."""
    assert model.nv == VESSEL_DOFS * vessels + ITEM_DOFS * items and model.na == 2 * vessels
    expected = [1, 2, 3] * vessels + [1, 1] * items
    assert model.M_rownnz.tolist() == expected, "mass matrix of another shape than the callback's"
    assert model.numeric_data[0] == MAGIC, "another numeric comes before ours"
