import logging

import mujoco
import numpy as np
import pytest

from mjforage.base.errors import UserError
from mjforage.view.render import opengl
from mjforage.view.render.opengl import Canvas, choose_backend

BOX = "<mujoco><worldbody><geom type='box' size='1 1 1' rgba='1 0 0 1'/></worldbody></mujoco>"


@pytest.fixture
def unset(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    """No choice of the user's."""
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    return monkeypatch


@pytest.mark.parametrize(
    ("egl", "osmesa", "chosen"),
    [(True, True, "egl"), (True, False, "egl"), (False, True, "osmesa")],
)
def test_egl_comes_first(unset: pytest.MonkeyPatch, egl: bool, osmesa: bool, chosen: str) -> None:
    unset.setattr(opengl, "egl_works", lambda: egl)
    unset.setattr(opengl, "osmesa_works", lambda: osmesa)
    assert choose_backend() == chosen


def test_without_a_driver_the_packages_are_named(unset: pytest.MonkeyPatch) -> None:
    unset.setattr(opengl, "_load", lambda name, file: None)
    with pytest.raises(UserError, match="neither EGL nor OSMesa works") as caught:
        choose_backend()
    assert "libegl1 libegl-mesa0 libgl1-mesa-dri, or libosmesa6" in str(caught.value)


@pytest.mark.parametrize("asked", ["egl", "osmesa", " EGL "])
def test_the_users_choice_stands(monkeypatch: pytest.MonkeyPatch, asked: str) -> None:
    monkeypatch.setenv("MUJOCO_GL", asked)
    assert choose_backend() == asked.strip().lower()


def test_a_choice_that_needs_windows_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MUJOCO_GL", "glfw")
    with pytest.raises(UserError, match="MUJOCO_GL=glfw: draws no films; unset it, or set egl"):
        choose_backend()


@pytest.mark.usefixtures("opengl")
def test_a_canvas_draws_says_with_what_and_is_the_only_one(
    caplog: pytest.LogCaptureFixture,
) -> None:
    model = mujoco.MjModel.from_xml_string(BOX)
    data, camera = mujoco.MjData(model), mujoco.MjvCamera()
    mujoco.mj_forward(model, data)
    camera.distance = 6.0
    scene = mujoco.MjvScene(model, 10)
    everything = mujoco.mjtCatBit.mjCAT_ALL.value
    mujoco.mjv_updateScene(model, data, mujoco.MjvOption(), None, camera, everything, scene)
    rgb, depth = np.zeros((48, 64, 3), np.uint8), np.zeros((48, 64), np.float32)
    with caplog.at_level(logging.INFO, "mjforage.view.render"), Canvas(model, 64, 48) as canvas:
        assert f"OpenGL: {canvas.about}" in caplog.text
        assert canvas.about.startswith(("EGL, ", "OSMesa, "))
        with pytest.raises(RuntimeError, match="another canvas is open"):
            Canvas(model, 64, 48)
        canvas.draw(scene, rgb, depth)
    canvas.close()
    assert rgb[24, 32, 0] > 80
    assert rgb[24, 32, 1] < 20
    assert depth[24, 32] < depth[0, 0] == 1.0
    Canvas(model, 32, 32).close()
