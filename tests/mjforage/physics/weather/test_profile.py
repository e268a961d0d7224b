import numpy as np
import pytest

from mjforage.physics.weather.profile import height_factor


def test_power_profile_by_hand() -> None:
    found = height_factor(np.array([0.0, 1.0, 16.0]), reference_m=16.0, exponent=0.25)
    np.testing.assert_allclose(found, [0.0, 0.5, 1.0], rtol=1e-14)


def test_a_record_is_measured_at_10_m() -> None:
    found = height_factor(np.array([10.0, 0.3]))
    np.testing.assert_allclose(found, [1.0, 0.03**0.11], rtol=1e-14)


@pytest.mark.parametrize("height_m", [-0.1, np.nan, np.inf])
def test_impossible_heights_are_refused(height_m: float) -> None:
    with pytest.raises(ValueError, match="height_m"):
        height_factor(np.array([1.0, height_m]))
