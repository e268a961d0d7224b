from collections.abc import Callable
from pathlib import Path

import av
import numpy as np
import pytest
from PIL import Image as PilImage

from mjforage.base.errors import UserError
from mjforage.runs.episode_recording import Recording
from mjforage.view.render import TopView, frame_times, render_replay


@pytest.fixture(scope="module")
def replay(build: Callable[..., Recording]) -> Recording:
    """Ten steps of ten seconds on a small map."""
    return build(np.ones((9, 12), np.bool_), steps=10, items=6)


def test_default_speed_shows_four_steps_a_second(replay: Recording) -> None:
    times = frame_times(replay, fps=8.0)
    np.testing.assert_allclose(times, np.arange(21) * 0.5)


def test_start_duration_and_speed_are_simulated_seconds(replay: Recording) -> None:
    times = frame_times(replay, start_s=25.0, duration_s=10.0, fps=2.0, speed=5.0)
    np.testing.assert_allclose(times, [2.5, 2.75, 3.0, 3.25, 3.5])


def test_last_frame_is_the_last_step_and_never_beyond(replay: Recording) -> None:
    for fps in (30.0, 29.97, 7.0):
        times = frame_times(replay, fps=fps)
        assert 10.0 - 4.0 / fps < times[-1] <= 10.0
    assert frame_times(replay, start_s=100.0).tolist() == [10.0]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"start_s": -1.0}, "start -1 s: the episode lasts from 0 to 100 s"),
        ({"start_s": 101.0}, "start 101 s"),
        ({"start_s": float("nan")}, "start nan s"),
        ({"duration_s": 0.0}, "duration 0 s: must be over 0"),
        ({"start_s": 60.0, "duration_s": 50.0}, "from 60 s on, at most 40 s are left"),
        ({"duration_s": float("inf")}, "duration inf s"),
        ({"speed": 0.0}, "speed 0: must be over 0"),
        ({"speed": -1.0}, "speed -1"),
        ({"fps": -5.0}, "fps -5: must be over 0"),
        ({"size": (10, None)}, "width 10: must be 320 to 7680"),
    ],
)
def test_bad_options_are_named(
    replay: Recording, tmp_path: Path, options: dict[str, float], message: str
) -> None:
    with pytest.raises(UserError, match=message):
        render_replay(replay, tmp_path / "film.mp4", **options)  # type: ignore[arg-type]
    assert list(tmp_path.iterdir()) == []


def test_film_has_the_promised_frames_and_reports_progress(
    replay: Recording, tmp_path: Path
) -> None:
    path, seen = tmp_path / "film.mp4", list[tuple[int, int]]()
    count = render_replay(
        replay,
        path,
        start_s=20.0,
        duration_s=20.0,
        fps=10.0,
        size=(480, None),
        progress=lambda done, total: seen.append((done, total)),
    )
    assert seen == [(done, 6) for done in range(1, 7)]
    with av.open(str(path)) as film:
        decoded = [frame.to_ndarray(format="rgb24") for frame in film.decode(video=0)]
    assert len(decoded) == count == 6
    for number, time in ((0, 2.0), (5, 4.0)):
        source = TopView(replay, 480).frame(time)
        assert np.abs(decoded[number].astype(float) - source).mean() < 4.0


def test_png_shows_the_start(replay: Recording, tmp_path: Path) -> None:
    path = tmp_path / "view.png"
    assert render_replay(replay, path, start_s=35.0, size=(480, None)) == 1
    shown = np.asarray(PilImage.open(path))
    np.testing.assert_array_equal(shown, TopView(replay, 480).frame(3.5))
