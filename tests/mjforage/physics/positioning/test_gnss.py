"""Errors of satellite positioning, log and compass: sizes, closed forms and truth tables."""

from collections.abc import Iterator

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.randomness import episode_keys
from mjforage.physics.positioning import Measured, create_positioning
from mjforage.scenario.sensors import Sensors

TICK_S = 0.1
EXACT = 1e-12


def gnss(**keys: float) -> Sensors:
    return Sensors(positioning="gnss", **keys)  # type: ignore[arg-type]


def path_at(tick: int, vessels: int) -> NDArray[np.float64]:
    """(6,) pose and velocity of vessels that go on a circle, each at its own place."""
    angle = 0.02 * tick + np.arange(vessels)
    turn = np.full(vessels, 0.2)
    c, s = np.cos(angle), np.sin(angle)
    return np.stack((5 * c, 5 * s, angle, -s, c, turn), axis=-1)


def sail(
    sensors: Sensors, ticks: int, episodes: int = 1, vessels: int = 2, every: int = 1
) -> Iterator[tuple[NDArray[np.float64], Measured]]:
    """Truth (episode, vessel, 6) and measurements, tick after tick."""
    keys = episode_keys(0, np.arange(episodes))
    model = create_positioning(sensors, (episodes, vessels), TICK_S)
    for tick in range(0, ticks, every):
        true = np.tile(path_at(tick, vessels), (episodes, 1, 1))
        seen = model.measure(
            keys,
            np.full(episodes, tick),
            np.ascontiguousarray(true[..., :3]),
            np.ascontiguousarray(true[..., 3:]),
        )
        yield true, seen


def test_without_errors_all_is_as_it_is() -> None:
    for true, seen in sail(gnss(), 50):
        assert (seen.pose == true[..., :3]).all() and seen.fix.all()
        assert np.allclose(seen.velocity, true[..., 3:], atol=EXACT)


def test_the_slow_error_has_its_size_and_loses_its_correlation_with_time() -> None:
    """Gauss-Markov: variance s^2 and correlation exp(-lag / memory) per axis, axes independent."""
    sensors = gnss(position_wander_m=0.8, position_memory_s=20.0)
    run = list(sail(sensors, 401, 1500, 2, every=100))
    error = np.array([seen.pose[..., :2] - true[..., :2] for true, seen in run])
    assert np.abs(error.std(axis=(1, 2)) / 0.8 - 1).max() < 4 / np.sqrt(2 * 3000)
    for lag in (1, 2, 4):
        both = (error[lag] * error[0]).mean(axis=(0, 1)) / 0.8**2
        assert np.abs(both - np.exp(-lag * 10.0 / 20.0)).max() < 4 / np.sqrt(3000)
    east, north = error[0, ..., 0], error[0, ..., 1]
    assert abs((east * north).mean()) / 0.8**2 < 4 / np.sqrt(3000)
    assert abs((east[:, 0] * east[:, 1]).mean()) / 0.8**2 < 4 / np.sqrt(1500)


def test_an_outage_of_its_length_in_every_stretch_repeats_the_last_fix() -> None:
    sensors = gnss(outage_s=2.0, outage_every_s=10.0, position_noise_m=0.1)
    run = list(sail(sensors, 1000, episodes=6, vessels=3))
    fix = np.array([seen.fix for _, seen in run])
    xy = np.array([seen.pose[..., :2] for _, seen in run])
    begins = []
    for stretch in range(10):
        there = fix[100 * stretch : 100 * (stretch + 1)]
        assert ((~there).sum(axis=0) == 20).all()
        first = (~there).argmax(axis=0)
        begins.append(first)
        ticks = np.arange(100)[:, None, None]
        assert (~there == (ticks >= first) & (ticks < first + 20)).all()
    assert np.unique(begins).size > 60  # drawn for each vessel, episode and stretch
    held = np.flatnonzero(~fix[:, 2, 1])
    assert held[0] > 0 and (xy[held, 2, 1] == xy[held - 1, 2, 1]).all()
    fresh = np.flatnonzero(fix[1:, 2, 1]) + 1
    assert (xy[fresh, 2, 1] != xy[fresh - 1, 2, 1]).all()


@pytest.mark.parametrize("ticks", [1, 3])
def test_latency_shifts_all_by_its_ticks(ticks: int) -> None:
    errors = {"position_noise_m": 0.2, "position_wander_m": 0.5, "heading_noise_deg": 2.0}
    more = {"velocity_noise_mps": 0.1, "compass_bias_deg": 5.0}
    now = [seen for _, seen in sail(gnss(**errors, **more), 40)]
    late = [seen for _, seen in sail(gnss(**errors, **more, latency_s=ticks * TICK_S), 40)]
    for tick in range(40):
        for one, two in zip(now[max(tick - ticks, 0)][:2], late[tick][:2], strict=True):
            assert (one == two).all()
        assert late[tick].fix.all() == (tick == 0 or tick > ticks)


def test_the_compass_is_off_by_a_constant_which_turns_the_log_too() -> None:
    run = list(sail(gnss(compass_bias_deg=4.0), 30, episodes=1000, vessels=2))
    off = np.array([seen.pose[..., 2] - true[..., 2] for true, seen in run])
    assert np.abs(off - off[0]).max() < EXACT
    assert np.degrees(off[0]).std() == pytest.approx(4.0, rel=0.1)
    assert abs((off[0, :, 0] * off[0, :, 1]).mean()) < np.radians(4.0) ** 2 * 4 / np.sqrt(1000)
    true, seen = run[-1]
    c, s = np.cos(off[0]), np.sin(off[0])
    vx, vy = true[..., 3], true[..., 4]
    turned = np.stack((c * vx - s * vy, s * vx + c * vy, true[..., 5]), axis=-1)
    assert np.allclose(seen.velocity, turned, atol=EXACT)


def test_noise_of_the_log_has_its_size_and_the_gyro_none() -> None:
    run = list(sail(gnss(velocity_noise_mps=0.3), 2, episodes=2000))
    noise = np.array([seen.velocity - true[..., 3:] for true, seen in run])
    assert np.abs(noise[..., :2].std(axis=(1, 2)) / 0.3 - 1).max() < 4 / np.sqrt(2 * 4000)
    assert (noise[..., 2] == 0.0).all()
    columns = np.moveaxis(noise[..., :2], 1, 0).reshape(2000, -1)
    assert np.abs(np.corrcoef(columns.T) - np.eye(8)).max() < 5 / np.sqrt(2000)


BAD = [
    ({"latency_s": 0.25}, r"latency_s = 0.25: give a multiple of 0.1 s"),
    ({"outage_s": 9.9, "outage_every_s": 10.0}, r"outage_s = 9.9 every 10 s leaves no fix"),
]


@pytest.mark.parametrize(("keys", "words"), BAD)
def test_errors_that_do_not_fit_are_refused(keys: dict[str, float], words: str) -> None:
    with pytest.raises(UserError, match=words):
        create_positioning(gnss(**keys), (1, 1), TICK_S)
