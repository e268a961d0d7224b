"""Forces against hand cases and against the momentum that potential flow must keep."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from mjforage.physics.hydrodynamics.parameters import pack
from mjforage.physics.hydrodynamics.water_load import damping, hull_force, load_drag, load_mass
from mjforage.physics.vessels import Vessel, load_vessel

OTTER, SCOUT, FORAGER = (load_vessel(name) for name in ("otter", "scout", "forager"))
SPEED, RATE = st.floats(-2.0, 2.0), st.floats(-1.0, 1.0)
LOSSLESS = dataclasses.replace(
    OTTER, crossflow=None, linear_surge=0.0, linear_sway=0.0, linear_yaw=0.0
)


def turned(yaw: float) -> NDArray[np.float64]:
    return np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])


def test_yaw_damping_of_the_otter_grows_with_the_rate() -> None:
    bare = pack(dataclasses.replace(OTTER, crossflow=None))
    assert damping(bare, 0.0, 0.0, 0.3)[2] == pytest.approx(-40.05 * (1.0 + 3.0) * 0.3)
    assert damping(bare, 0.0, 0.0, -0.3)[2] == pytest.approx(40.05 * (1.0 + 3.0) * 0.3)


def test_scout_damping_by_hand() -> None:
    x, y, n = damping(pack(SCOUT), -2.0, 0.5, 0.5)
    assert x == pytest.approx(10.13 * 4.0)
    assert y == pytest.approx(-(70.0 + 100.0 * 0.5) * 0.5)
    assert n == pytest.approx(-(3.3 + 17.3 * 0.5) * 0.5)


@given(SPEED, SPEED, RATE)
@pytest.mark.parametrize("vessel", [OTTER, SCOUT, FORAGER], ids=lambda v: v.name)
def test_mirrored_motion_gives_mirrored_force(vessel: Vessel, u: float, v: float, r: float) -> None:
    p = pack(vessel)
    x, y, n = hull_force(p, u, v, r, 1.0)
    np.testing.assert_allclose(hull_force(p, u, -v, -r, 1.0), (x, -y, -n), rtol=1e-12, atol=1e-9)


@given(SPEED, SPEED, RATE, st.floats(-3.0, 3.0))
def test_inertial_form_keeps_it_where_accelerations_are_in_world_axes(
    u: float, v: float, r: float, yaw: float
) -> None:
    """(m + R M_A R^T) a = R F, solved as MuJoCo would: m v + R M_A R^T v is constant."""
    force = hull_force(pack(LOSSLESS), u, v, r, 1.0)
    added = np.diag([5.28, 82.5])

    def mass(angle: float) -> NDArray[np.float64]:
        return 80.0 * np.eye(2) + turned(angle) @ added @ turned(angle).T

    velocity = turned(yaw) @ (u, v)
    a = np.linalg.solve(mass(yaw), turned(yaw) @ force[:2])
    h = 1e-5
    after = mass(yaw + h * r) @ (velocity + h * a)
    before = mass(yaw - h * r) @ (velocity - h * a)
    np.testing.assert_allclose((after - before) / (2 * h), 0.0, atol=1e-5)
    assert force[2] == pytest.approx(-(82.5 - 5.28) * u * v)


def test_load_adds_weight_and_drag() -> None:
    p = pack(FORAGER)
    assert load_mass(p, 50.0) == pytest.approx(10.0)
    assert load_drag(p, 50.0, -2.0) == pytest.approx(15.0 * 4.0)
    assert load_drag(pack(OTTER), 50.0, 1.0) == 0.0
