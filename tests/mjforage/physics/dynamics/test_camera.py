from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from mjforage.base.errors import UserError
from mjforage.base.randomness import episode_keys
from mjforage.physics.dynamics.camera import camera_of, sight_items, variance
from mjforage.physics.dynamics.tracks import ItemTracks
from mjforage.physics.worlds import create_mission
from mjforage.scenario.sensors import Sensors
from tests.mjforage.physics.dynamics.test_mujoco_dynamics import setup_of

EXACT = Sensors(camera_range_noise_per_m=0.0, camera_fov_deg=360.0, camera_range_m=1e4)
FRAMES = 4000
YAW = 0.7
HULLS = np.array([[9.0, 9.0, 0.0], [1.0, -2.0, YAW]])


def sightings(sensors: Sensors, polar: list[tuple[float, float]], episode: int = 0) -> np.ndarray:
    """(frame, item, 2) ahead and to port of the bow's course, of items at (m, deg)."""
    far, off = np.array(polar).T
    angle = YAW + np.radians(off)
    xy = HULLS[1, :2] + far[:, None] * np.stack((np.cos(angle), np.sin(angle)), axis=-1)
    node, key = np.zeros(len(far), np.int32), episode_keys(0, np.arange(9))[episode]
    seen, camera = np.empty((2, len(far), 2)), camera_of(sensors, 1, 0)
    found = []
    for tick in range(FRAMES):
        sight_items(camera, key, tick, 1, HULLS, HULLS, xy, node, seen)
        found.append(seen[1] - HULLS[1, :2])
    c, s = np.cos(YAW), np.sin(YAW)
    turned: np.ndarray = np.array(found) @ np.array([[c, -s], [s, c]])
    return turned


def test_errors_are_of_one_size_and_grow_with_the_square_of_the_range_in_the_line_of_sight() -> (
    None
):
    sensors = replace(EXACT, camera_noise_m=0.1, camera_range_noise_per_m=0.0065)
    seen = sightings(sensors, [(1.0, 0.0), (8.0, 0.0), (8.0, 90.0)])
    far = np.hypot(0.1, 0.0065 * 64.0)
    expected = [[np.hypot(0.1, 0.0065), 0.1], [far, 0.1], [0.1, far]]
    limit = 4 / np.sqrt(2 * FRAMES)
    assert (np.abs(seen.std(axis=0) / expected - 1) < limit).all()
    error = seen.mean(axis=0) - [[1.0, 0.0], [8.0, 0.0], [0.0, 8.0]]
    assert (np.abs(error / expected) < 4 / np.sqrt(FRAMES)).all()
    columns = seen.reshape(FRAMES, -1)
    between = np.corrcoef(np.concatenate((columns[1:], columns[:-1]), axis=1).T) - np.eye(12)
    assert np.abs(between).max() < 5 / np.sqrt(FRAMES)
    other = sightings(sensors, [(1.0, 0.0)], episode=1)[:, 0, 0]
    assert abs(np.corrcoef(other, seen[:, 0, 0])[0, 1]) < 5 / np.sqrt(FRAMES)


def test_the_variance_is_that_of_sightings() -> None:
    sensors = replace(EXACT, camera_noise_m=0.1, camera_range_noise_per_m=0.01)
    seen = sightings(sensors, [(6.0, 30.0)])[:, 0]
    whole = float(variance(camera_of(sensors, 1, 0), 6.0))
    assert abs(seen.var(axis=0).mean() / whole - 1) < 5 / np.sqrt(FRAMES)
    fixes = replace(sensors, position_noise_m=0.2, heading_noise_deg=3.0)
    more = float(variance(camera_of(fixes, 1, 0), 6.0)) - whole
    assert abs(more - (0.2**2 + 0.5 * (6.0 * np.radians(3.0)) ** 2)) < 1e-12


def test_an_item_out_of_view_or_range_or_off_the_water_is_not_seen() -> None:
    sensors = replace(EXACT, camera_fov_deg=120.0, camera_range_m=5.0)
    places = [(4.9, 59.0), (4.9, -59.0), (4.9, 61.0), (4.9, -61.0), (1.0, 180.0), (5.1, 0.0)]
    seen = np.isfinite(sightings(sensors, places)[0, :, 0])
    assert seen.tolist() == [True, True, False, False, False, False]
    out, xy = np.zeros((2, 1, 2)), HULLS[1:, :2] + 1.0
    key = episode_keys(0, np.arange(1))[0]
    gone = np.full(1, -1, np.int32)
    sight_items(camera_of(sensors, 1, 0), key, 0, 1, HULLS, HULLS, xy, gone, out)
    assert np.isnan(out[1]).all()


def test_a_place_is_told_from_the_pose_that_the_vessel_measures() -> None:
    measured = HULLS + np.array([0.3, -0.2, np.pi / 2])
    xy, out = HULLS[1:, :2] + 2.0 * np.array([np.cos(YAW), np.sin(YAW)]), np.empty((2, 1, 2))
    key = episode_keys(0, np.arange(1))[0]
    sight_items(camera_of(EXACT, 1, 0), key, 0, 1, HULLS, measured, xy, np.zeros(1, np.int32), out)
    ahead = 2.0 * np.array([-np.sin(YAW), np.cos(YAW)])
    np.testing.assert_allclose(out[1, 0], measured[1, :2] + ahead, atol=1e-12)


def test_vessels_hand_cameras_their_true_pose_and_the_one_that_they_measure() -> None:
    """They see the items as far off as they are, and take them to be as far off as themselves."""
    frames = ("camera_noise_m=1e-6", "camera_range_noise_per_m=0", "camera_latency_s=0")
    view = ("camera_fov_deg=360", "camera_range_m=100")
    setup = setup_of("comb-port-weather", *(f"sensors.{each}" for each in (*frames, *view)))
    mission, off = create_mission(setup, "physics"), np.array([0.5, -0.25, 0.0])
    mission.reset(0, np.arange(1))
    dynamics: Any = mission._dynamics
    ticks = dynamics._playing
    ticks._look(np.ones(1, np.bool_), dynamics._motion.pose + off)
    wrong = (ticks._known() - dynamics._simulation.item_xy[:, None]).reshape(-1, 2)
    np.testing.assert_allclose(np.nanmedian(wrong, axis=0), off[:2], atol=1e-4)


@pytest.mark.parametrize("key", ["camera_period_s", "camera_latency_s"])
def test_times_that_are_no_multiple_of_a_tick_are_refused(key: str) -> None:
    with pytest.raises(UserError, match=f"sensors.{key} = 0.25 s does not fit.* 0.1 s"):
        create_mission(setup_of("comb-port-weather", f"sensors.{key}=0.25"), "physics")


def test_frames_on_their_way_are_kept_until_they_are_known() -> None:
    items = np.zeros((1, 3), np.int32)
    for period, latency, frames in ((1, 0, 1), (2, 2, 2), (2, 3, 2), (5, 2, 1), (1, 4, 5)):
        tracks = ItemTracks.of(camera_of(EXACT, period, latency), 2, items)
        assert tracks.frames.shape[:2] == (1, frames)
