"""The fleet in a scene: each vessel's hull from its MJCF part, its inertia from its parameters."""

from collections.abc import Sequence
from pathlib import Path

import mujoco
import numpy as np

from mjforage.assets import models_folder
from mjforage.errors import UserError
from mjforage.scene.parts import read_part
from mjforage.vessels import Vessel

LEAST_OFFSET_M = 1e-6  # a centre of gravity exactly at midships would keep only the diagonal of M
SLIDE, HINGE = mujoco.mjtJoint.mjJNT_SLIDE, mujoco.mjtJoint.mjJNT_HINGE
JOINTS = {"x": (SLIDE, 0), "y": (SLIDE, 1), "yaw": (HINGE, 2)}  # type and axis of each, in order
DEFAULT_LOOK = "otter"  # of vessels without an MJCF part of their own


def hull_part(vessel: Vessel, path: Path | None = None) -> mujoco.MjSpec:
    """MJCF part of a vessel: the given file, the shipped one of its name, or an Otter's looks.

    Raises
    ------
    UserError
        If it is malformed, or lacks the body `hull`, its joints x, y, yaw or its box `collider`, or
        if a joint is of another kind, axis, or has forces of its own.
    """
    if path is None:
        path = models_folder() / f"{vessel.name}.xml"
        path = path if path.is_file() else models_folder() / f"{DEFAULT_LOOK}.xml"
    part = read_part(path)
    body = part.body("hull")
    if body is None:
        raise UserError(f"model {path.name}: no body named hull; name the vessel's body so")
    joints = tuple(joint.name for joint in body.joints)
    if joints != tuple(JOINTS):
        raise UserError(
            f"model {path.name}: joints of hull are {', '.join(joints) or 'none'}; give x, y, yaw"
        )
    for joint in body.joints:
        _check_joint(joint, path.name)
    collider = part.geom("collider")
    if collider is None or collider.type != mujoco.mjtGeom.mjGEOM_BOX:
        raise UserError(f"model {path.name}: no box named collider; add one for contacts")
    return part


def _check_joint(joint: mujoco.MjsJoint, name: str) -> None:
    """Refuse joints that would turn the hull's axes or add forces of their own."""
    kind, axis = JOINTS[joint.name]
    if joint.type != kind or not np.array_equal(joint.axis, np.eye(3)[axis]):
        words = "slide" if kind == SLIDE else "hinge"
        raise UserError(
            f"model {name}: joint {joint.name} is no {words} along {'xyz'[axis]}; "
            f'give type="{words}" and that axis'
        )
    if np.any(joint.damping) or np.any(joint.stiffness) or joint.armature or joint.frictionloss:
        raise UserError(
            f"model {name}: joint {joint.name} has damping, stiffness, armature or friction; "
            "remove them, the water's forces come from the vessel's parameters"
        )


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
    """Names of the vessels in the scene; by default ``scout-0``, ``scout-1``, ...

    Raises
    ------
    UserError
        If there are not as many names as vessels, two are the same, or one is empty or has a slash.
    """
    if names is None:
        seen: dict[str, int] = {}
        numbers = [seen.update({v.name: seen.get(v.name, -1) + 1}) or seen[v.name] for v in vessels]
        return tuple(f"{v.name}-{n}" for v, n in zip(vessels, numbers, strict=True))
    if len(names) != len(vessels) or len(set(names)) != len(names):
        raise UserError(f"names {', '.join(names)}: give {len(vessels)} different ones")
    for name in names:
        if not name or "/" in name:
            raise UserError(f"name {name!r} of a vessel: give text without a slash")
    return tuple(names)
