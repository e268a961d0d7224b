import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import episode_keys
from mjforage.physics.positioning import Measured, create_positioning
from mjforage.scenario.sensors import Sensors

KEYS = episode_keys(0, np.arange(2000))
POSE = np.tile(np.array([1.0, -2.0, 0.5]), (2000, 3, 1))
STILL = np.zeros_like(POSE)


def measured(sensors: Sensors, tick: int, rows: slice = slice(None)) -> Measured:
    keys, pose = KEYS[rows], POSE[rows]
    model = create_positioning(sensors, pose.shape[:2], 0.1)
    return model.measure(keys, np.full(keys.size, tick, np.int64), pose, STILL[rows])


def test_without_noise_all_is_as_it_is() -> None:
    seen = measured(Sensors(), 0)
    assert seen.fix.all()
    assert np.shares_memory(seen.pose, POSE) and np.shares_memory(seen.velocity, STILL)


def test_noise_has_its_size_and_is_independent() -> None:
    sensors = Sensors(position_noise_m=0.2, heading_noise_deg=3.0)
    noise, later = (measured(sensors, tick).pose - POSE for tick in (0, 1))
    expected = np.array([0.2, 0.2, np.radians(3.0)])
    limit = 4 / np.sqrt(2 * 2000)
    assert (np.abs(noise.std(axis=0) / expected - 1) < limit).all()
    assert (np.abs(noise.mean(axis=0) / expected) < 4 / np.sqrt(2000)).all()
    columns: NDArray[np.float64] = np.concatenate((noise, later), axis=1).reshape(2000, -1)
    between = np.corrcoef(columns.T) - np.eye(18)
    assert np.abs(between).max() < 5 / np.sqrt(2000)


def test_noise_does_not_depend_on_the_batch() -> None:
    sensors = Sensors(position_noise_m=0.2)
    whole, one = measured(sensors, 7), measured(sensors, 7, slice(3, 4))
    assert (one.pose == whole.pose[3:4]).all()
