from collections.abc import Callable

import mujoco
import numpy as np
import pytest

from mjforage.base.errors import UserError
from mjforage.runs.episode_recording import Recording
from mjforage.view.render.track import Track
from mjforage.view.render.viewer import check_display, put, scene_of, view_recording


@pytest.fixture
def dark(monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine without a display."""
    monkeypatch.setattr("sys.platform", "linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)


@pytest.fixture(scope="module")
def recording(build: Callable[..., Recording]) -> Recording:
    return build(np.ones((8, 8), np.bool_), steps=4, items=6)


@pytest.mark.usefixtures("dark")
def test_without_a_display_the_way_out_is_named(recording: Recording) -> None:
    with pytest.raises(UserError, match=r"no display here.*mjforage render writes"):
        check_display()
    with pytest.raises(UserError, match="speed -1: must be over 0"):
        view_recording(recording, -1.0)


def test_bodies_are_put_where_the_track_says(recording: Recording) -> None:
    scene, track = scene_of(recording), Track.of(recording)
    data = mujoco.MjData(scene.model)
    hulls, items = track.vessels_at(17.0), track.items_at(17.0)
    items[2, 2] = 0.0
    put(scene, data, hulls, items)
    for pose, name in zip(hulls, scene.names, strict=True):
        body = data.body(f"{name}/hull")
        np.testing.assert_allclose(body.xpos[:2], pose[:2], atol=1e-9)
        np.testing.assert_allclose(body.xmat[[0, 3]], [np.cos(pose[2]), np.sin(pose[2])], atol=1e-9)
    np.testing.assert_allclose(data.body("item-0/item").xpos[:2], items[0, :2], atol=1e-9)
    np.testing.assert_allclose(data.body("item-2/item").xpos[:2], scene.parking[2], atol=1e-9)
