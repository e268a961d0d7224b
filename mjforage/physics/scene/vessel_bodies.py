"""The fleet in a scene: each vessel's hull from its MJCF part, its inertia from its parameters."""

import mujoco

from mjforage.physics.scene.mjcf import shipped_part
from mjforage.physics.vessels import Vessel

LOOKS = ("forager", "otter", "scout")  # vessels with an MJCF part; others look like an Otter
LEAST_OFFSET_M = 1e-6  # a centre of gravity exactly at midships would keep only the diagonal of M


def hull_part(vessel: Vessel) -> mujoco.MjSpec:
    """MJCF part of a vessel without its motors: the shipped one of its name, or an Otter's."""
    part = shipped_part(vessel.name if vessel.name in LOOKS else "otter")
    for motor in list(part.actuators):
        part.delete(motor)
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
