import math

import mujoco
import numpy as np
import pytest

from mjforage.base.errors import UserError
from mjforage.physics.callback import install, installation, native
from mjforage.physics.callback.model_layout import SCHEME, WATER
from mjforage.physics.callback.self_test import (
    ADDED_SURGE,
    ADDED_SWAY,
    DRAG,
    MASS,
    failure,
    toy_model,
)
from mjforage.physics.callback.structs import StructError, offsets

PENDULUM = """
<mujoco><custom><numeric name="mjforage" data="1 2 3 4 5 6 7 8"/></custom>
<worldbody><body pos="0 0 1"><joint type="hinge" axis="0 1 0"/>
<geom type="capsule" size=".05" fromto="0 0 0 .5 0 0"/></body></worldbody></mujoco>
"""


@pytest.fixture(autouse=True)
def fresh(monkeypatch: pytest.MonkeyPatch) -> object:
    mujoco.set_mjcb_passive(None)
    monkeypatch.setattr(installation, "_proved", False)
    yield
    mujoco.set_mjcb_passive(None)


@pytest.mark.parametrize("yaw", np.linspace(0.0, math.tau, 9))
def test_acceleration_from_rest_is_the_same_at_every_heading(yaw: float) -> None:
    model = toy_model()
    data = mujoco.MjData(model)
    data.qpos[2] = yaw
    for along, inertia in ((0.0, MASS + ADDED_SURGE), (0.5 * math.pi, MASS + ADDED_SWAY)):
        pushed = yaw + along
        data.userdata[WATER : WATER + 2] = math.cos(pushed), math.sin(pushed)
        install()
        mujoco.mj_forward(model, data)
        felt = data.qacc[0] * math.cos(pushed) + data.qacc[1] * math.sin(pushed)
        assert felt == pytest.approx(DRAG / inertia, abs=1e-9)
        assert math.hypot(data.qacc[0], data.qacc[1]) == pytest.approx(felt, abs=1e-9)


def test_calling_twice_on_one_state_does_not_add_mass_twice() -> None:
    model = toy_model()
    data = mujoco.MjData(model)
    data.userdata[WATER] = 1.0
    install()
    mujoco.mj_forward(model, data)
    once = data.qacc.copy()
    mujoco.mj_forwardSkip(model, data, mujoco.mjtStage.mjSTAGE_POS, 0)
    np.testing.assert_allclose(data.qacc, once, rtol=0, atol=1e-12)


def test_models_of_others_do_not_notice() -> None:
    model = mujoco.MjModel.from_xml_string(PENDULUM)
    alone, beside = mujoco.MjData(model), mujoco.MjData(model)
    mujoco.mj_step(model, alone, 100)
    install()
    mujoco.mj_step(model, beside, 100)
    np.testing.assert_array_equal(beside.qpos, alone.qpos)


def test_models_of_ours_can_take_turns() -> None:
    first, second = toy_model(), toy_model()
    second.numeric_data[SCHEME] = 1.0
    datas = mujoco.MjData(first), mujoco.MjData(second)
    install()
    for data in datas:
        data.userdata[WATER] = 1.0
    for _ in range(3):
        mujoco.mj_forward(first, datas[0])
        mujoco.mj_forward(second, datas[1])
    assert datas[0].qacc[0] == pytest.approx(DRAG / (MASS + ADDED_SURGE), abs=1e-9)
    assert datas[1].qacc[0] < datas[0].qacc[0]  # averaged over a step, drag has begun to fall


def test_self_test_notices_a_missing_callback() -> None:
    assert "off by" in str(failure(toy_model()))


def test_a_callback_cleared_by_others_is_put_back() -> None:
    install()
    mujoco.set_mjcb_passive(None)
    install()
    assert failure(toy_model()) is None


def test_another_callback_is_an_error_and_stays() -> None:
    def theirs(model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Someone else's."""

    mujoco.set_mjcb_passive(theirs)
    try:
        with pytest.raises(UserError, match="another passive callback"):
            install()
        assert mujoco.get_mjcb_passive() is theirs
    finally:
        mujoco.set_mjcb_passive(None)


def test_unknown_structs_are_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    def lost() -> object:
        raise StructError("qvel not found")

    monkeypatch.setattr(installation, "native_callback", lost)
    with pytest.raises(
        UserError, match=r"MuJoCo callback: qvel not found; MuJoCo .* not supported"
    ):
        install()
    assert mujoco.get_mjcb_passive() is None


def test_a_callback_that_reads_wrong_memory_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = offsets()._replace(qpos=offsets().qvel)  # every heading reads as 0
    monkeypatch.setattr(native, "offsets", lambda: wrong)
    native.native_callback.cache_clear()
    try:
        with pytest.raises(UserError, match="off by"):
            install()
    finally:
        native.native_callback.cache_clear()
