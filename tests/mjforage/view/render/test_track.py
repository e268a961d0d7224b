"""Places of vessels and items between frames, and the events of an episode."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from mjforage.runs.episode_recording import Recording
from mjforage.view.render.timeline import NEVER, Timeline
from mjforage.view.render.track import FADE_PART, TURN_PART, Track

Build = Callable[..., Recording]


@pytest.fixture
def two_frames(build: Build) -> Recording:
    """One vessel that goes 8 m east and turns from 170 to -170 degrees; one item, then taken."""
    recording = build(np.ones((5, 5), np.bool_), steps=1, items=1, agents=(1, 0))
    pose = np.array([[[0, 0, np.radians(170)]], [[8, 4, np.radians(-170)]]], np.float32)
    items = np.array([[[1.0, 2.0]], [[3.0, 2.0]]], np.float32)
    present = np.array([[True], [False]])
    return replace(recording, track_pose=pose, track_items=items, track_present=present)


def test_vessels_glide_and_turn_the_short_way_early_in_a_step(two_frames: Recording) -> None:
    track = Track.of(two_frames)
    half = track.vessels_at(10.0 * TURN_PART / 2.0)[0]
    np.testing.assert_allclose(half[:2], [8 * TURN_PART / 2, 4 * TURN_PART / 2], rtol=1e-6)
    assert np.degrees(half[2]) == pytest.approx(180.0, abs=1e-4)
    assert np.degrees(track.vessels_at(10.0 * TURN_PART)[0, 2]) == pytest.approx(190.0, abs=1e-4)


def test_a_finer_track_turns_evenly(two_frames: Recording) -> None:
    track = Track.of(replace(two_frames, frame_s=0.5))
    assert np.degrees(track.vessels_at(0.25)[0, 2]) == pytest.approx(180.0, abs=1e-4)
    assert track.end_s == 0.5


def test_items_vanish_as_they_are_taken(two_frames: Recording) -> None:
    track = Track.of(two_frames)
    np.testing.assert_allclose(track.items_at(5.0), [[2.0, 2.0, 1.0]])
    fading = 10.0 * (1.0 - FADE_PART / 4.0)
    assert track.items_at(fading)[0, 2] == pytest.approx(0.25)
    assert track.items_at(10.0)[0, 2] == 0.0
    assert track.removed_s.tolist() == [10.0]


def test_the_wind_blows_between_frames(two_frames: Recording) -> None:
    wind = np.array([[1.0, -2.0], [3.0, 0.0]], np.float32)
    assert Track.of(replace(two_frames, track_wind=wind)).wind_at(2.5) == (1.5, -1.5)


def test_a_way_is_the_vessels_place_at_every_time(build: Build) -> None:
    track = Track.of(build(np.ones((9, 9), np.bool_), steps=6, items=2))
    times = np.array([-3.0, 0.0, 1.7, 29.99, 30.0, 60.0, 99.0])
    for agent in range(4):
        expected = [track.vessels_at(t)[agent] for t in times.tolist()]
        np.testing.assert_allclose(track.way(agent, times), expected, rtol=1e-12)


def test_discoveries_as_logged_and_removals_give_pta(build: Build) -> None:
    """An item in view that was missed is not discovered: the log says, not the picture."""
    recording = build(np.ones((4, 4), np.bool_), steps=3, items=4, agents=(1, 1))
    present, view = np.ones((4, 4), np.bool_), np.ones_like(recording.in_view)
    present[3:, 0] = present[1:, 2] = False
    found = np.array([0, 2, 1, -1], np.int16)
    events = Timeline.of(replace(recording, in_view=view, item_present=present, t_discovered=found))
    assert events.discovered.tolist() == [0, 2, 1, NEVER]
    assert events.removed.tolist() == [3, NEVER, 1, NEVER]
    assert events.pta_d.tolist() == [25.0, 50.0, 75.0, 75.0]
    assert events.pta_c.tolist() == [0.0, 25.0, 25.0, 50.0]
