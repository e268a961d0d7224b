import pytest

from mjforage.physics.hydrodynamics.item_drag import item_load


def test_drag_by_hand() -> None:
    """Air at 5 m/s from the south-west, water at 0.5 m/s to the north: k |v| v of each."""
    x, y, mass = item_load(0.5, 0.01, 4.0, 3.0, 4.0, 0.0, 0.5, 0.02, False)
    assert (x, y) == pytest.approx((0.01 * 5.0 * 3.0, 0.01 * 5.0 * 4.0 + 4.0 * 0.5 * 0.5))
    assert mass == 0.5


def test_an_averaged_step_is_linearly_implicit() -> None:
    """(m + h (k_a |a| + k_w |w|)) dv/dt = F: no step, however long, makes it swing over."""
    _, y, mass = item_load(0.5, 0.01, 4.0, 3.0, 4.0, 0.0, 0.5, 0.1, True)
    assert mass == pytest.approx(0.5 + 0.1 * (0.01 * 5.0 + 4.0 * 0.5))
    _, y, mass = item_load(0.5, 0.0, 4.0, 0.0, 0.0, 0.0, 0.5, 1e6, True)
    assert 1e6 * y / mass == pytest.approx(0.5, rel=1e-6)
