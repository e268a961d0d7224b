import mujoco
import numpy as np
import pytest

from mjforage.base.errors import UserError
from mjforage.view.render.opengl import Canvas, choose_backend

BOX = "<mujoco><worldbody><geom type='box' size='1 1 1' rgba='1 0 0 1'/></worldbody></mujoco>"


@pytest.mark.parametrize(
    ("asked", "chosen"), [("", "egl"), ("on", "egl"), (" EGL ", "egl"), ("osmesa", "osmesa")]
)
def test_egl_draws_unless_the_user_chooses(
    monkeypatch: pytest.MonkeyPatch, asked: str, chosen: str
) -> None:
    monkeypatch.setenv("MUJOCO_GL", asked)
    assert choose_backend() == chosen


def test_a_choice_that_needs_windows_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MUJOCO_GL", "glfw")
    with pytest.raises(UserError, match="MUJOCO_GL=glfw: draws no films; unset it, or set egl"):
        choose_backend()


@pytest.mark.usefixtures("opengl")
def test_a_canvas_draws_and_is_the_only_one() -> None:
    model = mujoco.MjModel.from_xml_string(BOX)
    data, camera = mujoco.MjData(model), mujoco.MjvCamera()
    mujoco.mj_forward(model, data)
    camera.distance = 6.0
    scene = mujoco.MjvScene(model, 10)
    everything = mujoco.mjtCatBit.mjCAT_ALL.value
    mujoco.mjv_updateScene(model, data, mujoco.MjvOption(), None, camera, everything, scene)
    rgb, depth = np.zeros((48, 64, 3), np.uint8), np.zeros((48, 64), np.float32)
    with Canvas(model, 64, 48) as canvas:
        with pytest.raises(RuntimeError, match="another canvas is open"):
            Canvas(model, 64, 48)
        canvas.draw(scene, rgb, depth)
    canvas.close()
    assert rgb[24, 32, 0] > 80
    assert rgb[24, 32, 1] < 20
    assert depth[24, 32] < depth[0, 0] == 1.0
    Canvas(model, 32, 32).close()
