"""A scene for MuJoCo without our callback: motors in newtons, items of their own mass."""

from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from mjforage.physics.scene.build import check_passages, scene_spec
from mjforage.physics.scene.debris import load_debris
from mjforage.physics.vessels import Vessel


def plain_spec(
    vessels: Sequence[Vessel],
    names: Sequence[str],
    navigable: NDArray[np.bool_],
    pitch_m: float,
    classes: Sequence[int],
    start: NDArray[np.float64],
) -> mujoco.MjSpec:
    """The scene of `build_scene` with its looks, as MuJoCo steps it alone.

    Parameters
    ----------
    vessels, names, navigable, pitch_m : as of `build_scene`
    classes : (item,) index of each item's class
    start : (dof,) x, y, yaw of each vessel, then x, y of each item: where bodies stand before a
        keyframe is taken [m, rad]; headings are 0 then

    Raises
    ------
    UserError
        If a vessel cannot turn in the narrowest passage.
    """
    check_passages(vessels, navigable, pitch_m)
    known = load_debris()
    kinds = [known[k] for k in classes]
    seen = [kind.name for kind in kinds]
    spec = scene_spec(vessels, names, navigable, pitch_m, seen, looks=True)
    for numeric in list(spec.numerics):  # by these the callback would know the scene
        spec.delete(numeric)
    spec.nuserdata = 0
    for vessel, name in zip(vessels, names, strict=True):
        for side, way in (("port", 1.0), ("starboard", -1.0)):
            site, motor = spec.site(f"{name}/{side}"), spec.actuator(f"{name}/{side}")
            site.pos = [site.pos[0], way * vessel.lever_m, site.pos[2]]
            motor.set_to_motor()
            motor.trntype, motor.target = mujoco.mjtTrn.mjTRN_SITE, site.name
            motor.ctrlrange = vessel.thruster.thrust_range
    for k, kind in enumerate(kinds):
        spec.geom(f"item-{k}/collider").mass = kind.mass_kg
    for joint, place in zip(spec.joints, start, strict=True):
        if joint.type == mujoco.mjtJoint.mjJNT_SLIDE:  # so that its coordinate is that of the world
            joint.ref, joint.parent.pos = place, joint.parent.pos + place * joint.axis
    return spec
