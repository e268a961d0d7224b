import dataclasses

import numpy as np
import pytest

from mjforage.physics.vessels import load_vessel
from mjforage.view.render.track import Track
from mjforage.view.render.wakes import ARM_SLOPE, trail, wake
from tests.mjforage.view.render.conftest import track_of_poses

VESSEL = dataclasses.replace(load_vessel("otter"), length_m=2.0, beam_m=1.0)


def track_of(speed: float) -> Track:
    """East at `speed` m/s for 60 s, 20 m/s never being reached by a hull of ours."""
    t = np.arange(0.0, 60.5, 0.5)
    pose = np.column_stack((speed * t, 0 * t, 0 * t))[:, None]
    return track_of_poses(pose)


def test_a_still_hull_has_no_wake_and_a_first_moment_none() -> None:
    assert list(wake(track_of(0.0), 0, 30.0, VESSEL, 1.0)) == []
    assert list(wake(track_of(1.5), 0, 0.0, VESSEL, 1.0)) == []


def test_the_wake_of_a_straight_run_lies_behind_and_opens_at_19_degrees() -> None:
    core, left, right = list(wake(track_of(1.5), 0, 30.0, VESSEL, 1.0))
    assert core.xy[0] == pytest.approx([45.0 - 0.84, 0.0])
    assert (np.diff(core.xy[:, 0]) < 0.0).all()
    np.testing.assert_allclose(left.xy * [1, -1], right.xy)
    first_slope = (left.xy[1, 1] - left.xy[0, 1]) / (left.xy[0, 0] - left.xy[1, 0])
    assert first_slope == pytest.approx(ARM_SLOPE, rel=0.02)
    assert np.degrees(np.arctan(ARM_SLOPE)) == pytest.approx(19.47, abs=0.25)


def test_foam_fades_with_age_and_grows_with_speed() -> None:
    slow, fast = (next(iter(wake(track_of(v), 0, 30.0, VESSEL, 1.0))) for v in (0.3, 1.5))
    for line in (slow, fast):
        assert (np.diff(line.strength) < 0.0).all()
        assert line.strength[-1] == pytest.approx(0.0, abs=1e-9)
        assert (np.diff(line.width_m) > 0.0).all()
    assert slow.strength[0] < fast.strength[0] <= 1.0


def test_a_larger_hull_has_a_larger_wake() -> None:
    one, four = (next(iter(wake(track_of(1.0), 0, 55.0, VESSEL, scale))) for scale in (1.0, 4.0))
    assert np.ptp(four.xy[:, 0]) == pytest.approx(4.0 * np.ptp(one.xy[:, 0]), rel=0.05)
    assert four.width_m[0] == pytest.approx(4.0 * one.width_m[0])


def test_a_trail_goes_from_here_back_to_where_the_hull_was() -> None:
    line = trail(track_of(1.0), 0, 50.25, 30.0, 2.0)
    assert line.xy[0].tolist() == [50.25, 0.0]
    assert line.xy[-1].tolist() == [20.25, 0.0]
    assert line.strength[0] == 1.0
    assert line.strength[-1] == 0.0
    assert trail(track_of(1.0), 0, 10.0, 30.0, 2.0).xy[-1].tolist() == [0.0, 0.0]
