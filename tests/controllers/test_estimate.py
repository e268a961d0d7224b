import numpy as np
import pytest

from mjforage.controllers.estimate import estimate, surge_after, sway_after
from mjforage.controllers.state import VesselState
from tests.controllers.plant import FORAGER as P
from tests.controllers.plant import blank


def after(ticks: int, noise_m: float = 0.0, yaw: float = 0.0, **velocity: float) -> VesselState:
    """State after moving at a constant velocity, seen with noise."""
    s, rng = blank(), np.random.default_rng(0)
    v = np.array([velocity.get(axis, 0.0) for axis in ("x", "y", "turn")])
    for tick in range(ticks):
        fix = (0.0, 0.0, yaw) + 0.1 * tick * v + noise_m * rng.normal(size=3) * (1.0, 1.0, 0.1)
        estimate(s, P, fix, v, 0.1)
    return s


def test_without_noise_the_estimate_is_the_fix() -> None:
    s = after(50, x=0.7, y=-0.2, turn=0.3)
    assert s.x == pytest.approx(4.9 * 0.7)
    assert s.y == pytest.approx(4.9 * -0.2)
    assert s.yaw == pytest.approx(4.9 * 0.3)


def test_noise_is_averaged_away() -> None:
    errors = [after(ticks, noise_m=0.3).x for ticks in range(200, 400, 5)]
    assert np.std(errors) < 0.06
    assert abs(after(10, noise_m=0.3).x) < 0.3 / np.sqrt(10) * 3


def test_a_jump_is_believed_at_once() -> None:
    s = after(20)
    estimate(s, P, np.array([50.0, 9.0, 1.0]), np.zeros(3), 0.1)
    assert (s.x, s.y, s.yaw) == (50.0, 9.0, 1.0)


@pytest.mark.parametrize("degrees", [0, 60, 135, -90])
def test_an_unpowered_vessel_that_moves_shows_the_drift(degrees: int) -> None:
    """To the east and north, wherever the bow points."""
    s = after(300, x=0.2, y=0.1, yaw=np.radians(degrees))
    assert s.drift_x == pytest.approx(0.2, abs=0.01)
    assert s.drift_y == pytest.approx(0.1, abs=0.01)


def test_models_of_surge_and_sway() -> None:
    """First steps from rest: force over mass, and -m u r over the mass in sway."""
    assert surge_after(P, 0.0, 100.0, 1e-3) == pytest.approx(0.1 / P.mass_surge_kg, rel=1e-3)
    expected = -P.mass_surge_kg / P.mass_sway_kg * 1.2 * 0.3 * 1e-3
    assert sway_after(P, 0.0, 1.2, 0.3, 1e-3) == pytest.approx(expected, rel=1e-2)
