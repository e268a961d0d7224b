"""An episode as a MuJoCo scene that opens without mjforage, with its tracks and a README."""

import mujoco
import numpy as np
from numpy.typing import NDArray

from mjforage.mission.setup import Setup
from mjforage.physics.dynamics.fleet_scene import fleet_vessels
from mjforage.physics.scene import parking_xy
from mjforage.physics.scene.build import check_passages, scene_spec
from mjforage.physics.scene.mjcf import compiled
from mjforage.physics.scene.quays import walls_of
from mjforage.physics.simulation import Integrator
from mjforage.physics.vessels import Vessel
from mjforage.runs.episode_recording import Recording
from mjforage.runs.exporting.callback_forces import readme
from mjforage.runs.exporting.charts import vessel_rows
from mjforage.runs.exporting.tracks import Tracks
from mjforage.scenario.debris import load_debris


def mjcf_files(setup: Setup, recording: Recording) -> dict[str, bytes]:
    """`scene.xml` with a keyframe per decision, `tracks.csv` with every frame, `README.md`.

    Raises `UserError` if a vessel cannot turn in the narrowest passage, or no body can have its
    parameters.
    """
    vessels = fleet_vessels(setup.fleet, setup.scenario.physics)
    frames, spec = _positions(recording), _plain_scene(setup, recording, vessels)
    for joint, place in zip(spec.joints, frames[0], strict=True):
        if joint.type == mujoco.mjtJoint.mjJNT_SLIDE:  # there at once, its coordinate the world's
            joint.ref, joint.parent.pos = place, joint.parent.pos + place * joint.axis
    for k, place in enumerate(frames[:: round(recording.period_s / recording.frame_s)]):
        spec.add_key(name=f"decision-{k}", time=k * recording.period_s, qpos=place)
    compiled(spec, f"scenario {setup.scenario.name}")
    return {
        "scene.xml": spec.to_xml().encode(),
        "tracks.csv": vessel_rows(Tracks(setup, recording)).write_csv().encode(),
        "README.md": readme(setup, recording, vessels).encode(),
    }


def _positions(recording: Recording) -> NDArray[np.float64]:
    """(frame, dof) of the scene; an item that is not on the water lies at its parking place."""
    there = recording.track_present[..., None]
    items = np.where(there, recording.track_items, parking_xy(len(recording.item_class)))
    parts = recording.track_pose.astype(np.float64), items
    return np.concatenate([part.reshape(len(part), -1) for part in parts], axis=1)


def _plain_scene(setup: Setup, recording: Recording, vessels: tuple[Vessel, ...]) -> mujoco.MjSpec:
    """The scene without the callback's numbers: motors in newtons, items of their own mass."""
    known, about = load_debris(), (setup.grid.navigable, recording.pitch_m)
    kinds = [known[k] for k in np.maximum(recording.item_class, 0)]
    check_passages(vessels, *about)
    seen = [kind.name for kind in kinds]
    walls = walls_of(setup.grid.place)
    spec = scene_spec(vessels, recording.labels, *about, seen, looks=True, walls=walls)
    for numeric in list(spec.numerics):  # by these the callback would know the scene
        spec.delete(numeric)
    spec.modelname, spec.nuserdata = setup.scenario.name, 0
    spec.option.timestep = Integrator.REFERENCE.step_s
    for vessel, name in zip(vessels, recording.labels, strict=True):
        for side, way in (("port", 1.0), ("starboard", -1.0)):
            site, motor = spec.site(f"{name}/{side}"), spec.actuator(f"{name}/{side}")
            site.pos = [site.pos[0], way * vessel.lever_m, site.pos[2]]
            motor.set_to_motor()
            motor.trntype, motor.target = mujoco.mjtTrn.mjTRN_SITE, site.name
            motor.ctrlrange = vessel.thruster.thrust_range
    for k, kind in enumerate(kinds):
        spec.geom(f"item-{k}/collider").mass = kind.mass_kg
    return spec
