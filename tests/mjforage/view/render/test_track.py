from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from mjforage.runs.episode_recording import Recording
from mjforage.view.render.timeline import TURN_PART
from mjforage.view.render.track import FADE_PART, Track

Build = Callable[..., Recording]


@pytest.fixture
def two_frames(build: Build) -> Recording:
    """One hull that goes 8 m east and turns from 170 to -170 degrees; one item, then taken."""
    replay = build(np.ones((5, 5), np.bool_), steps=1, items=1, agents=(1, 0))
    pose = np.array([[[0, 0, np.radians(170)]], [[8, 4, np.radians(-170)]]], np.float32)
    items = np.array([[[1.0, 2.0]], [[3.0, 2.0]]], np.float32)
    present = np.array([[True], [False]])
    return replace(replay, track_pose=pose, track_items=items, track_present=present)


def test_hulls_glide_and_turn_the_short_way_early_in_a_step(two_frames: Recording) -> None:
    track = Track.of(two_frames)
    half = track.hulls_at(10.0 * TURN_PART / 2.0)[0]
    np.testing.assert_allclose(half[:2], [8 * TURN_PART / 2, 4 * TURN_PART / 2], rtol=1e-6)
    assert np.degrees(half[2]) == pytest.approx(180.0, abs=1e-4)
    assert np.degrees(track.hulls_at(10.0 * TURN_PART)[0, 2]) == pytest.approx(190.0, abs=1e-4)


def test_a_finer_track_turns_evenly(two_frames: Recording) -> None:
    track = Track.of(replace(two_frames, frame_s=0.5))
    assert np.degrees(track.hulls_at(0.25)[0, 2]) == pytest.approx(180.0, abs=1e-4)
    assert track.end_s == 0.5


def test_items_vanish_as_they_are_taken(two_frames: Recording) -> None:
    track = Track.of(two_frames)
    np.testing.assert_allclose(track.items_at(5.0), [[2.0, 2.0, 1.0]])
    fading = 10.0 * (1.0 - FADE_PART / 4.0)
    assert track.items_at(fading)[0, 2] == pytest.approx(0.25)
    assert track.items_at(10.0)[0, 2] == 0.0
    assert track.removed_s.tolist() == [10.0]


def test_a_way_is_the_hulls_place_at_every_time(build: Build) -> None:
    track = Track.of(build(np.ones((9, 9), np.bool_), steps=6, items=2))
    times = np.array([-3.0, 0.0, 1.7, 29.99, 30.0, 60.0, 99.0])
    for agent in range(4):
        expected = [track.hulls_at(t)[agent] for t in times.tolist()]
        np.testing.assert_allclose(track.way(agent, times), expected, rtol=1e-12)


def test_an_episode_without_moves_has_one_frame(build: Build) -> None:
    replay = build(np.ones((4, 4), np.bool_), steps=1, items=1)
    single = replace(
        replay,
        track_pose=replay.track_pose[:1],
        track_items=replay.track_items[:1],
        track_present=replay.track_present[:1],
    )
    track = Track.of(single)
    np.testing.assert_array_equal(track.hulls_at(3.0), track.poses[0])
    np.testing.assert_array_equal(track.way(0, np.array([3.0])), track.poses[:1, 0])
