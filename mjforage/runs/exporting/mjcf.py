"""An episode as a MuJoCo scene that opens without mjforage, with its tracks and a README."""

import numpy as np
import polars as pl
from numpy.typing import NDArray

from mjforage.mission.setup import Setup
from mjforage.physics.dynamics.fleet_scene import fleet_vessels
from mjforage.physics.scene import parking_xy
from mjforage.physics.scene.mjcf import compiled
from mjforage.physics.scene.plain import plain_spec
from mjforage.physics.simulation import Integrator
from mjforage.runs.episode_recording import Recording
from mjforage.runs.exporting.callback_forces import readme

Floats = NDArray[np.float64]


def mjcf_files(setup: Setup, recording: Recording) -> dict[str, bytes]:
    """`scene.xml` with a keyframe per decision, `tracks.csv` with every frame, `README.md`.

    Raises
    ------
    UserError
        If a vessel cannot turn in the narrowest passage, or no body can have its parameters.
    """
    names, vessels = recording.labels, fleet_vessels(setup.fleet, setup.scenario.physics)
    classes = np.maximum(recording.item_class, 0).tolist()
    frames = _positions(recording)
    spec = plain_spec(vessels, names, setup.grid.navigable, recording.pitch_m, classes, frames[0])
    spec.modelname = setup.scenario.name
    spec.option.timestep = Integrator.REFERENCE.step_s
    every = round(recording.period_s / recording.frame_s)
    for decision, place in enumerate(frames[::every]):
        time_s = decision * recording.period_s
        spec.add_key(name=f"decision-{decision}", time=time_s, qpos=place)
    compiled(spec, f"scenario {setup.scenario.name}")
    return {
        "scene.xml": spec.to_xml().encode(),
        "tracks.csv": _tracks(recording).write_csv().encode(),
        "README.md": readme(setup, recording, vessels).encode(),
    }


def _positions(recording: Recording) -> Floats:
    """(frame, dof) of the scene; an item that is not on the water lies at its parking place."""
    there = recording.track_present[..., None]
    items = np.where(there, recording.track_items, parking_xy(len(recording.item_class)))
    parts = recording.track_pose.astype(np.float64), items
    return np.concatenate([part.reshape(len(part), -1) for part in parts], axis=1)


def _tracks(recording: Recording) -> pl.DataFrame:
    """A row per frame and vessel."""
    frames, agents = recording.track_pose.shape[:2]
    x, y, yaw = recording.track_pose.reshape(-1, 3).T
    times = np.repeat(recording.frame_s * np.arange(frames), agents)
    names = [*recording.labels] * frames
    return pl.DataFrame({"t_s": times, "vessel": names, "x_m": x, "y_m": y, "yaw_rad": yaw})
