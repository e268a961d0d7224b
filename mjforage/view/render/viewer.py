"""MuJoCo's own viewer on a recorded episode, which it plays back in a loop."""

import os
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.physics.scene import Scene, build_scene
from mjforage.runs.episode_recording import Recording
from mjforage.view.render.track import Track
from mjforage.view.render.visual_scene import vessels_of

Floats = NDArray[np.float64]
_FRAME_S = 1.0 / 50.0  # of a screen
_CLOSING_S = 10.0  # how long a window may take to close


def check_display() -> None:
    """Check that there is a display.

    Raises
    ------
    UserError
        If there is none.
    """
    names = ("DISPLAY", "WAYLAND_DISPLAY")
    if sys.platform == "linux" and not any(os.environ.get(name) for name in names):
        raise UserError(
            "view: no display here (neither DISPLAY nor WAYLAND_DISPLAY is set); "
            "mjforage render writes pictures and films without one"
        )


def view_recording(recording: Recording, speed: float) -> None:
    """Play an episode back over and over, until the window closes.

    Parameters
    ----------
    speed : simulated seconds per second

    Raises
    ------
    UserError
        If `speed` is not above 0, or the window does not open.
    """
    if not 0.0 < speed < np.inf:
        raise UserError(f"speed {speed:g}: must be over 0")
    track, scene = Track.of(recording), scene_of(recording)
    data = mujoco.MjData(scene.model)
    with _window(scene.model, data, track.vessels_at(0.0)) as window:
        begin, before = time.monotonic(), track.vessels_at(0.0)
        while window.is_running():
            time_s = (time.monotonic() - begin) * speed % (track.end_s + _FRAME_S)
            vessels = track.vessels_at(time_s)
            with window.lock():
                put(scene, data, vessels, track.items_at(time_s))
                data.time = time_s
                window.cam.lookat[:2] += (vessels - before).mean(axis=0)[:2]  # goes with the fleet
            before = vessels
            window.sync()
            time.sleep(_FRAME_S)


def scene_of(recording: Recording) -> Scene:
    """The physical scene of a recording, with its appearance."""
    return build_scene(
        vessels_of(recording),
        navigable=recording.navigable,
        pitch_m=recording.pitch_m,
        items=len(recording.item_class),
        names=recording.labels,
        looks=np.maximum(recording.item_class, 0).tolist(),
    )


def put(scene: Scene, data: Any, vessels: Floats, items: Floats) -> None:
    """Put vessels (agent, 3) and items (item, 3: x, y, there or not) in their places; no forces."""
    there = items[:, 2:] > 0.0
    data.qpos[: vessels.size] = vessels.reshape(-1)
    data.qpos[vessels.size :] = np.where(there, items[:, :2], scene.parking).reshape(-1)
    mujoco.mj_kinematics(scene.model, data)
    mujoco.mj_camlight(scene.model, data)


@contextmanager
def _window(model: mujoco.MjModel, data: Any, vessels: Floats) -> Iterator[Any]:
    """MuJoCo's viewer over the fleet."""
    from mujoco import viewer

    others = set(threading.enumerate())
    try:
        window = viewer.launch_passive(model, data, show_left_ui=False, show_right_ui=False)
    except (RuntimeError, mujoco.FatalError) as error:
        reason = " ".join(str(error).split())
        raise UserError(f"view: the viewer does not open ({reason}); see DISPLAY") from error
    try:
        window.cam.lookat[:] = (*vessels[:, :2].mean(axis=0), 0.0)
        window.cam.distance, window.cam.elevation, window.cam.azimuth = 40.0, -35.0, 90.0
        yield window
    finally:
        window.close()
        for thread in set(threading.enumerate()) - others:
            thread.join(_CLOSING_S)  # the window's own, before its library ends under it
