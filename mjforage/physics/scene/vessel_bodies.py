"""The fleet in a scene: each vessel's hull from its MJCF part, its inertia from its parameters."""

from collections.abc import Sequence
from pathlib import Path

import mujoco

from mjforage.base.errors import UserError
from mjforage.physics.scene.hull_checks import check_hull
from mjforage.physics.scene.mjcf import read_part
from mjforage.physics.vessels import Vessel
from mjforage.scenario.assets import models_folder

DEFAULT_LOOK = "otter"  # of vessels without an MJCF part of their own
LEAST_OFFSET_M = 1e-6  # a centre of gravity exactly at midships would keep only the diagonal of M


def hull_part(vessel: Vessel, path: Path | None = None) -> mujoco.MjSpec:
    """MJCF part of a vessel: the given file, the shipped one of its name, or an Otter's looks.

    Raises
    ------
    UserError
        If it is malformed, or not a hull that moves and touches as ours do (see `check_hull`).
    """
    if path is None:
        path = models_folder() / f"{vessel.name}.xml"
        path = path if path.is_file() else models_folder() / f"{DEFAULT_LOOK}.xml"
    part = read_part(path)
    check_hull(part, f"model {path.name}")
    return part


def add_vessel(
    spec: mujoco.MjSpec, vessel: Vessel, name: str, part: mujoco.MjSpec, *, looks: bool
) -> None:
    """Attach one vessel with its two thrusters; its parts are named ``NAME/hull`` and so on."""
    body = spec.worldbody.add_frame().attach_body(part.copy().body("hull"), f"{name}/", "")
    offset = vessel.cog_x_m if abs(vessel.cog_x_m) >= LEAST_OFFSET_M else LEAST_OFFSET_M
    spin = vessel.inertia_z_kgm2 - vessel.mass_kg * vessel.cog_x_m**2  # about the centre of gravity
    body.explicitinertial = True
    body.mass, body.ipos, body.inertia = vessel.mass_kg, [offset, 0, 0], [spin, spin, spin]
    for geom in list(body.geoms):
        if geom.name == f"{name}/collider":
            height = geom.size[2]
            geom.size = [0.5 * vessel.length_m, 0.5 * vessel.beam_m, height]
        elif not looks:
            spec.delete(geom)
    low, high = vessel.thruster.command_range
    for side in ("port", "starboard"):
        actuator = spec.add_actuator(name=f"{name}/{side}", target=f"{name}/x")
        actuator.trntype = mujoco.mjtTrn.mjTRN_JOINT
        actuator.gainprm[0] = 0.0  # the callback makes the force; this is only the lag
        actuator.dyntype = mujoco.mjtDyn.mjDYN_FILTER
        actuator.dynprm[0] = vessel.lag_s
        actuator.ctrllimited, actuator.ctrlrange = True, [low, high]


def vessel_labels(vessels: Sequence[Vessel], names: Sequence[str] | None) -> tuple[str, ...]:
    """Names of the vessels in the scene; by default ``scout_0``, ``scout_1``, ...

    Raises
    ------
    UserError
        If there are not as many names as vessels, two are the same, or one is empty or has a slash.
    """
    if names is None:
        seen: dict[str, int] = {}
        numbers = [seen.update({v.name: seen.get(v.name, -1) + 1}) or seen[v.name] for v in vessels]
        return tuple(f"{v.name}_{n}" for v, n in zip(vessels, numbers, strict=True))
    if len(names) != len(vessels) or len(set(names)) != len(names):
        raise UserError(f"names {', '.join(names)}: give {len(vessels)} different ones")
    for name in names:
        if not name or "/" in name:
            raise UserError(f"name {name!r} of a vessel: give text without a slash")
    return tuple(names)
