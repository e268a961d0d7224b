import math

import numpy as np
import pytest

from mjforage.controllers.reference import heading_reference, speed_reference

STEP_S = 0.1


def turn(start: float, wanted: float, rate: float = 0.5, acceleration: float = 1.0) -> np.ndarray:
    """(tick, 2) heading and rate of a reference from rest."""
    state, rows = (start, 0.0), []
    for _ in range(150):
        state = heading_reference(*state, wanted, rate, acceleration, STEP_S)
        rows.append(state)
    return np.array(rows)


@pytest.mark.parametrize("angle", [0.02, 0.5, math.pi / 2, 3.0])
def test_heading_goes_there_without_overshoot_inside_its_limits(angle: float) -> None:
    heading, rate = turn(0.0, angle).T
    assert heading[-1] == pytest.approx(angle, abs=1e-3)
    assert heading.max() <= angle * 1.01 + 1e-3
    assert np.abs(rate).max() <= 0.5 + 1e-12
    assert np.abs(np.diff(rate, prepend=0.0)).max() <= 1.0 * STEP_S + 1e-12


def test_heading_takes_the_short_way() -> None:
    assert turn(3.0, -3.0)[-1, 0] == pytest.approx(2.0 * math.pi - 3.0, abs=1e-3)


def test_a_long_turn_takes_the_time_of_its_rate() -> None:
    heading = turn(0.0, 2.0, rate=0.4, acceleration=10.0)[:, 0]
    assert np.argmax(heading > 1.8) * STEP_S == pytest.approx(1.8 / 0.4, abs=0.3)


@pytest.mark.parametrize(
    ("speed", "wanted", "after"),
    [
        (0.0, 2.0, 0.1),  # 1 m/s2 away from rest
        (0.0, -2.0, -0.1),
        (1.0, 0.0, 0.8),  # 2 m/s2 towards it
        (-1.0, -0.5, -0.8),
        (0.05, -1.0, 0.0),  # through rest, no farther at once
        (1.95, 2.0, 2.0),
    ],
)
def test_speed(speed: float, wanted: float, after: float) -> None:
    assert speed_reference(speed, wanted, 1.0, 2.0, STEP_S) == pytest.approx(after)
