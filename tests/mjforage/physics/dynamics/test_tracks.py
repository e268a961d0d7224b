from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np

from mjforage.base.randomness import episode_keys
from mjforage.controllers import Chart
from mjforage.physics.dynamics.camera import camera_of
from mjforage.physics.dynamics.tracks import (
    FORGET_S,
    JERK_M2PS3,
    RADIUS_M,
    SPEED_MPS,
    ItemTracks,
    LandGrid,
    afloat,
    look_out,
    note_sighting,
    tracked,
)
from mjforage.scenario.sensors import Sensors

STEP_S = 0.1
OPEN = LandGrid(np.zeros((0, 0), np.bool_), 4.0)
BASIN = LandGrid(Chart(np.array([[1, 1, 1], [1, 0, 1], [1, 1, 1]], np.bool_), 4.0).land, 4.0)
REAL = Sensors(0.1, 1.0, 0.95, camera_noise_m=0.1)
EXACT = Sensors(camera_range_noise_per_m=0.0, camera_range_m=1e4)
COLLECTS = np.array([False, True])
Way = Callable[[float], tuple[float, float]]


class Watch:
    """Fleets of a scout and a collector at the origin, which head east; one item each."""

    def __init__(
        self,
        way: Way,
        sensors: Sensors = REAL,
        ticks: tuple[int, int] = (2, 2),
        water: LandGrid = OPEN,
        episodes: Iterable[int] = (0,),
    ) -> None:
        self.way, self.water, self.camera = way, water, camera_of(sensors, *ticks)
        self.keys = episode_keys(0, np.array(list(episodes)))
        self.node = np.zeros((self.keys.size, 1), np.int32)
        self.tracks = ItemTracks.of(self.camera, 2, self.node)
        self.tick = np.full(self.keys.size, -1)
        self.pose, self.off = np.zeros((self.keys.size, 2, 3)), np.zeros(3)
        self.sought = np.zeros((self.keys.size, 2), np.int64)

    def at(self, tick: int) -> np.ndarray:
        return np.tile(np.array(self.way(tick * STEP_S)), (self.keys.size, 1, 1))

    def until(self, tick: int) -> np.ndarray:
        """(episode, 2) where the collectors take it to be, just before they are told what to do."""
        on = np.ones(self.keys.size, np.bool_)
        while self.tick[0] < tick:
            self.tick += 1
            poses = self.pose, self.pose + self.off
            now = (on, self.tick, STEP_S, *poses, self.at(int(self.tick[0])), self.node)
            look_out(self.camera, self.water, self.keys, COLLECTS, self.tracks, *now, self.sought)
        out = np.empty((self.keys.size, 2, 1, 2))
        tracked(self.tracks, self.water, self.tick, STEP_S, out)
        assert np.isnan(out[:, 0]).all()  # the scout
        return out[:, 1, 0]


def resting(t: float) -> tuple[float, float]:
    return 3.0, 1.0


def drifting(t: float) -> tuple[float, float]:
    return 2.0 + 0.06 * t, 1.0 - 0.04 * t


def test_what_is_seen_is_known_after_the_latency_and_then_once_a_period() -> None:
    watch = Watch(lambda t: (3.0 + t, 0.0), EXACT, (3, 4))
    known = [bool(np.isfinite(watch.until(tick)).all()) for tick in range(6)]
    assert known == [False, False, False, False, True, True]
    last = []
    for tick in range(6, 15):
        watch.until(tick)
        last.append(int(watch.tracks.tick[0, 1, 0]))
    assert last == [0, 3, 3, 3, 6, 6, 6, 9, 9]


def test_the_error_falls_below_that_of_a_sighting_and_a_drift_is_learnt() -> None:
    for way in (resting, drifting):
        watch = Watch(way, episodes=range(300))
        first = watch.until(2) - watch.at(2)[:, 0]
        last = watch.until(100) - watch.at(100)[:, 0]
        assert 0.09 < np.sqrt(np.mean(first**2)) < 0.13
        assert np.sqrt(np.mean(last**2)) < 0.07
        assert np.abs(last.mean(axis=0)).max() < 0.02


def test_a_track_is_a_kalman_filter() -> None:
    """Against P = F P F' + Q, K = P H' / (H P H' + R) in matrices, over eight sightings."""
    tracks = ItemTracks.of(camera_of(REAL, 2, 2), 2, np.zeros((1, 1), np.int32))
    rng, state, p = np.random.default_rng(0), np.zeros((2, 2)), np.zeros((2, 2))
    tick = 0
    for k, ticks in enumerate((0, 2, 2, 8, 2, 30, 4, 2)):
        tick, t, var = tick + ticks, STEP_S * ticks, 0.01 * (1 + k % 3)
        seen = np.array(drifting(STEP_S * tick)) + rng.normal(0.0, np.sqrt(var), 2)
        note_sighting(tracks, OPEN, (0, 1, 0), tick, t, seen[0], seen[1], var)
        if k == 0:
            state[0], p = seen, np.diag([var, SPEED_MPS**2])
        else:
            f = np.array([[1.0, t], [0.0, 1.0]])
            q = JERK_M2PS3 * np.array([[t**3 / 3, t**2 / 2], [t**2 / 2, t]])
            state, p = f @ state, f @ p @ f.T + q
            gain = p[:, 0] / (p[0, 0] + var)
            state = state + np.outer(gain, seen - state[0])
            p = p - np.outer(gain, p[0])
        np.testing.assert_allclose(tracks.xy[0, 1, 0], state[0], rtol=1e-9)
        np.testing.assert_allclose(tracks.velocity[0, 1, 0], state[1], rtol=1e-9)
        np.testing.assert_allclose(tracks.spread[0, 1, 0], p[[0, 0, 1], [0, 1, 1]], rtol=1e-9)


def test_it_is_held_while_out_of_view_drifts_on_and_is_forgotten() -> None:
    watch = Watch(drifting, replace(REAL, camera_fov_deg=120.0), episodes=range(300))
    watch.until(100)
    watch.pose[..., 2] = np.pi
    last = watch.until(200) - watch.at(200)[:, 0]
    assert np.sqrt(np.mean(last**2)) < 0.35
    assert np.abs(last.mean(axis=0)).max() < 0.06  # 0.7 m without its drift
    unseen = 100 + round(FORGET_S / STEP_S)
    assert np.isfinite(watch.until(unseen)).all()
    assert np.isnan(watch.until(unseen + 3)).all()
    watch.pose[..., 2] = 0.0
    back = watch.until(unseen + 8) - watch.at(unseen + 8)[:, 0]
    assert np.sqrt(np.mean(back**2)) < 0.2


def test_an_item_that_is_pushed_is_believed_at_once() -> None:
    watch = Watch(lambda t: (3.0, 0.0) if t < 10.0 else (3.0, 1.0), episodes=range(100))
    watch.until(100)
    last = watch.until(104) - watch.at(104)[:, 0]
    assert np.sqrt(np.mean(last**2)) < 0.2


def test_no_episode_depends_on_its_batch_or_on_who_is_active() -> None:
    whole = Watch(drifting, episodes=range(5)).until(30)
    alone = Watch(drifting, episodes=[3]).until(30)
    assert (whole[3] == alone[0]).all()


def test_an_item_is_taken_to_be_in_the_water_off_the_quay() -> None:
    """Nine cells around (4, 4), which is land as all is around them."""
    least = 2.0 - RADIUS_M
    for place, expected in {
        (0.0, 0.5): (0.0, 0.5),
        (4.0, 1.95): (4.0, least),
        (4.0, 2.3): (4.0, least),
        (-2.2, 1.0): (-least, 1.0),
        (-2.2, -2.1): (-least, -least),
        (2.0, 0.0): (2.0, 0.0),
        (2.1, 3.0): (least, 3.0),
    }.items():
        np.testing.assert_allclose(afloat(BASIN, *place), expected, atol=1e-12)
        assert afloat(OPEN, *place) == place
    assert afloat(BASIN, 40.0, 0.0) == (40.0, 0.0)


def test_one_beside_a_quay_is_found_there() -> None:
    watch = Watch(lambda t: (4.0, 1.9), water=BASIN, episodes=range(300))
    last = watch.until(60)
    assert last[:, 1].max() <= 1.9 + 1e-12
    assert np.sqrt(np.mean((last - [4.0, 1.9]) ** 2)) < 0.07


def test_an_item_sought_that_appears_on_land_tells_how_far_the_position_is_off() -> None:
    """Its way to the water, smoothed, towards 0 once it is no longer sought."""
    for off, way, within in ((0.0, -0.01, 0.01), (0.3, -0.3, 0.01), (-0.3, 0.0, 1e-3)):
        watch = Watch(lambda t: (1.9, 4.0), water=BASIN, episodes=range(300))
        watch.pose[..., 1], watch.off[0] = 4.0, off
        watch.until(60)
        ashore = watch.tracks.ashore[:, 1]
        assert abs(ashore[:, 0].mean() - way) < within and ashore[:, 0].std() < 0.06
        assert not ashore[:, 1].any() and not watch.tracks.ashore[:, 0].any()
        watch.sought[:] = -1
        watch.until(120)
        assert np.abs(watch.tracks.ashore).max() < 0.01
