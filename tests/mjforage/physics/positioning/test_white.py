import numpy as np

from mjforage.base.randomness import episode_keys
from mjforage.physics.dynamics.sensing import measured_poses
from mjforage.scenario.scenario import Sensors

KEYS = episode_keys(0, np.arange(2000))
POSE = np.tile(np.array([1.0, -2.0, 0.5]), (2000, 3, 1))


def test_without_noise_the_pose_is_the_pose() -> None:
    assert measured_poses(Sensors(), KEYS, np.zeros(2000, np.int64), POSE) is POSE


def test_noise_has_its_size_and_is_independent() -> None:
    sensors = Sensors(position_noise_m=0.2, heading_noise_deg=3.0)
    noise = measured_poses(sensors, KEYS, np.zeros(2000, np.int64), POSE) - POSE
    later = measured_poses(sensors, KEYS, np.ones(2000, np.int64), POSE) - POSE
    expected = np.array([0.2, 0.2, np.radians(3.0)])
    limit = 4 / np.sqrt(2 * 2000)
    assert (np.abs(noise.std(axis=0) / expected - 1) < limit).all()
    assert (np.abs(noise.mean(axis=0) / expected) < 4 / np.sqrt(2000)).all()
    columns = np.concatenate((noise, later), axis=1).reshape(2000, -1)
    between = np.corrcoef(columns.T) - np.eye(18)
    assert np.abs(between).max() < 5 / np.sqrt(2000)


def test_noise_does_not_depend_on_the_batch() -> None:
    sensors, tick = Sensors(position_noise_m=0.2), np.full(2000, 7, np.int64)
    whole = measured_poses(sensors, KEYS, tick, POSE)
    assert (measured_poses(sensors, KEYS[3:4], tick[3:4], POSE[3:4]) == whole[3:4]).all()
