from collections.abc import Callable
from unittest.mock import MagicMock

import mujoco
import numpy as np
import pytest

from mjforage.base.errors import UserError
from mjforage.cli.drawing import view
from mjforage.mission.setup import Setup
from mjforage.runs.episode_recording import Recording
from mjforage.scenario.scenario_file import load_scenario
from mjforage.view.render.track import Track
from mjforage.view.render.viewer import put, scene_of, start_of, view_recording, view_scenario


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
        view_recording(recording, 10.0)
    with pytest.raises(UserError, match="no display here"):
        view_scenario(Setup.of(load_scenario("comb-port")), 0, 0)
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


def test_a_window_shows_the_episode_of_the_seed_that_is_asked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("DISPLAY", ":0")
    window, launched = MagicMock(), MagicMock()
    window.is_running.return_value = False
    launched.return_value = window
    monkeypatch.setattr("mujoco.viewer.launch_passive", launched)
    view("comb-port", seed=5, episode=2)
    scene, hulls, items = start_of(Setup.of(load_scenario("comb-port")), 5, 2)
    data = mujoco.MjData(scene.model)
    put(scene, data, hulls, items)
    np.testing.assert_array_equal(launched.call_args.args[1].qpos, data.qpos)


def test_a_scenario_starts_where_its_episode_does() -> None:
    setup = Setup.of(load_scenario("comb-port"))
    scene, hulls, items = start_of(setup, 0, 3)
    starts = setup.graph.metres(np.array(setup.start_cells, np.float64))
    assert {tuple(xy) for xy in hulls[:, :2].tolist()} == {tuple(xy) for xy in starts.tolist()}
    assert scene.items == len(items) > 10
    assert scene.model.ngeom > 300
