import math

import pytest

from mjforage.controllers.boxes import box_gap


def gap(dx: float, dy: float, yaw_a: float = 0.0, yaw_b: float = 0.0) -> float:
    """Gap of two boxes of 2 x 1 m."""
    ca, sa, cb, sb = math.cos(yaw_a), math.sin(yaw_a), math.cos(yaw_b), math.sin(yaw_b)
    return box_gap(dx, dy, ca, sa, 1.0, 0.5, cb, sb, 1.0, 0.5)


def test_side_by_side_and_bow_to_stern() -> None:
    assert gap(0.0, 1.4) == pytest.approx(0.4)
    assert gap(2.3, 0.0) == pytest.approx(0.3)
    assert gap(2.3, 0.0, 0.0, math.pi) == pytest.approx(0.3)


def test_a_corner_towards_a_side() -> None:
    """A box turned by 45 degrees reaches (1 + 0.5) / sqrt 2 from its centre."""
    assert gap(3.0, 0.0, 0.0, math.pi / 4.0) == pytest.approx(3.0 - 1.0 - 1.5 / math.sqrt(2.0))


def test_overlap_is_negative_also_without_a_corner_inside() -> None:
    assert gap(0.0, 0.0, 0.0, math.pi / 2.0) < 0.0  # a cross
    assert gap(1.9, 0.9) == pytest.approx(-0.1)


def test_between_corners_it_is_a_lower_bound() -> None:
    true = math.hypot(0.6, 0.6)
    assert true / math.sqrt(2.0) <= gap(2.6, 1.6) <= true


def test_it_turns_with_the_world() -> None:
    c, s = math.cos(0.7), math.sin(0.7)
    turned = gap(c * 2.6 - s * 1.2, s * 2.6 + c * 1.2, 0.7, 1.2)
    assert turned == pytest.approx(gap(2.6, 1.2, 0.0, 0.5))
