"""MJCF part of a hull: of any appearance, but with the joints and contacts of ours."""

import mujoco
import numpy as np

from mjforage.base.errors import UserError
from mjforage.physics.scene.mjcf import compiled

SLIDE, HINGE = mujoco.mjtJoint.mjJNT_SLIDE, mujoco.mjtJoint.mjJNT_HINGE
JOINTS = {"x": (SLIDE, 0), "y": (SLIDE, 1), "yaw": (HINGE, 2)}  # type and axis of each, in order
CONTYPE, CONAFFINITY = 2, 7  # of a hull's collider, see models/scene.xml
LEAST_TURN = 1e-9  # of a quaternion's vector part


def check_hull(part: mujoco.MjSpec, where: str) -> None:
    """Check a vessel's MJCF part.

    Parameters
    ----------
    where : start of error messages

    Raises
    ------
    UserError
        If it lacks the body `hull`, its joints x, y, yaw or its box `collider`; if body, joints or
        collider are moved, turned or limited, or touch other things than a hull does; or if
        anything else moves or touches.
    """
    body = part.body("hull")
    if body is None:
        raise UserError(f"{where}: no body named hull; name the vessel's body so")
    joints = tuple(joint.name for joint in body.joints)
    if joints != tuple(JOINTS):
        raise UserError(
            f"{where}: joints of hull are {', '.join(joints) or 'none'}; give x, y, yaw"
        )
    for joint in body.joints:
        _check_axis(joint, where)
    collider = part.geom("collider")
    if collider is None or collider.type != mujoco.mjtGeom.mjGEOM_BOX:
        raise UserError(f"{where}: no box named collider; add one for contacts")
    _check_compiled(part, where)


def _check_axis(joint: mujoco.MjsJoint, where: str) -> None:
    """Refuse joints that would turn the hull's axes or add forces of their own."""
    kind, axis = JOINTS[joint.name]
    if joint.type != kind or not np.array_equal(joint.axis, np.eye(3)[axis]):
        words = "slide" if kind == SLIDE else "hinge"
        raise UserError(
            f"{where}: joint {joint.name} is no {words} along {'xyz'[axis]}; "
            f'give type="{words}" and that axis'
        )
    if np.any(joint.damping) or np.any(joint.stiffness) or joint.armature or joint.frictionloss:
        raise UserError(
            f"{where}: joint {joint.name} has damping, stiffness, armature or friction; "
            "remove them, the water's forces come from the vessel's parameters"
        )


def _check_compiled(part: mujoco.MjSpec, where: str) -> None:
    """Check the compiled part, with its defaults, frames and angles worked in."""
    copy = part.copy()
    body = copy.body("hull")  # its inertia comes from the vessel's parameters later
    body.explicitinertial, body.mass, body.inertia = True, 1.0, [1.0, 1.0, 1.0]
    model = compiled(copy, where)
    if model.nu or model.ntendon or model.neq or model.npair:
        raise UserError(
            f"{where}: has actuators, tendons, equalities or contact pairs; remove them, "
            "the thrusters come from the vessel's parameters"
        )
    _check_body(model, where)
    for name in JOINTS:
        _check_joint(model, name, where)
    _check_geoms(model, where)


def _check_body(model: mujoco.MjModel, where: str) -> None:
    hull = model.body("hull").id
    if model.body_parentid[hull] != 0 or (model.body_parentid[1:] == hull).any():
        raise UserError(
            f"{where}: body hull holds bodies of its own or stands in another; put it into "
            "worldbody and its geoms into it"
        )
    if _moved(model.body_pos[hull], model.body_quat[hull]):
        raise UserError(f"{where}: body hull is moved or turned; remove its pos and its angles")


def _check_joint(model: mujoco.MjModel, name: str, where: str) -> None:
    joint = model.joint(name)
    if joint.pos.any() or joint.qpos0.any():
        raise UserError(f"{where}: joint {name} has a pos or ref; remove it, midships is at 0")
    if model.jnt_limited[joint.id]:
        raise UserError(f"{where}: joint {name} is limited; remove its range, quays are the limits")


def _check_geoms(model: mujoco.MjModel, where: str) -> None:
    hull, collider = model.body("hull").id, model.geom("collider").id
    if model.geom_bodyid[collider] != hull:
        raise UserError(f"{where}: collider is not part of body hull; put it there")
    if _moved(model.geom_pos[collider], model.geom_quat[collider]):
        raise UserError(f"{where}: collider is moved or turned; remove its pos and its angles")
    bits = int(model.geom_contype[collider]), int(model.geom_conaffinity[collider])
    if bits != (CONTYPE, CONAFFINITY):
        raise UserError(
            f"{where}: collider has contype {bits[0]} and conaffinity {bits[1]}; "
            f"give {CONTYPE} and {CONAFFINITY}"
        )
    touching = (model.geom_contype | model.geom_conaffinity) != 0
    touching[collider] = False
    for geom in np.flatnonzero(touching & (model.geom_bodyid == hull)).tolist():
        name = model.geom(geom).name or f"number {geom} (unnamed)"
        raise UserError(
            f'{where}: geom {name} touches things; give it contype="0" and conaffinity="0"'
        )


def _moved(pos: np.ndarray, quat: np.ndarray) -> bool:
    """True if a frame lies elsewhere than its parent or is turned."""
    return bool(pos.any() or np.abs(quat[1:]).max() > LEAST_TURN)
