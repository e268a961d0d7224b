"""Films of one episode and of two side by side: options, sizes, times and files."""

import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import av
import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image as PilImage

from mjforage.base.errors import UserError
from mjforage.runs.episode_recording import Recording
from mjforage.view.render import map_film, render_recording
from mjforage.view.render.films import frame_times
from mjforage.view.render.layout import Box, frame_layout

Build = Callable[..., Recording]
Image = NDArray[np.uint8]
SERIES = ("agent_rc", "item_rc", "item_present", "belief", "idleness", "in_view")


@pytest.fixture(scope="module")
def recording(build: Build) -> Recording:
    """Ten steps of ten seconds on a small map."""
    return build(np.ones((9, 12), np.bool_), steps=10, items=6)


@pytest.fixture(scope="module")
def shorter(recording: Recording) -> Recording:
    """The same of another policy, over after step 3."""
    track = ("track_pose", "track_items", "track_present", "track_wind")
    cut: dict[str, Any] = {name: getattr(recording, name)[:4] for name in (*SERIES, *track)}
    return replace(recording, policy="levy", **cut)


def still(path: Path, *pair: Recording, step: float, size: tuple[int, int]) -> Image:
    options: dict[str, Any] = {"start_s": 10.0 * step, "size": size}
    beside = pair[1] if len(pair) > 1 else None
    assert render_recording(pair[0], path / "a.png", beside=beside, **options) == 1
    return np.asarray(PilImage.open(path / "a.png"))


def part(image: Image, box: Box) -> Image:
    left, top, right, bottom = (round(side) for side in box)
    return image[top:bottom, left:right]


def halves(size: tuple[int, int]) -> tuple[Box, ...]:
    return frame_layout(*size, 2, 14 / 11, 6, charted=False).pictures


def test_plain_drawing_needs_no_opengl_and_the_rest_says_so(
    recording: Recording, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "mujoco.egl", None)  # fails to import
    monkeypatch.setitem(sys.modules, "mujoco.osmesa", None)
    assert render_recording(recording, tmp_path / "a.png", size=(480, None)) == 1
    physics = replace(recording, world="physics")
    for one, camera in ((recording, "overview"), (physics, None), (physics, "top")):
        with pytest.raises(UserError, match=r"OpenGL: .* fails .* or libosmesa6 and set"):
            render_recording(one, tmp_path / "b.png", camera=camera)
    assert [path.name for path in tmp_path.iterdir()] == ["a.png"]


def test_times_are_simulated_seconds_and_end_with_the_episode(recording: Recording) -> None:
    times = frame_times(recording, start_s=25.0, duration_s=10.0, fps=2.0, speed=5.0)
    np.testing.assert_allclose(times, [2.5, 2.75, 3.0, 3.25, 3.5])
    for fps in (30.0, 29.97, 7.0):
        assert 10.0 - 4.0 / fps < frame_times(recording, fps=fps, speed=40.0)[-1] <= 10.0
    assert frame_times(recording, start_s=100.0, fps=30.0, speed=1.0).tolist() == [10.0]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"start_s": -1.0}, "start -1 s: the episode lasts from 0 to 100 s"),
        ({"start_s": float("nan")}, "start nan s"),
        ({"duration_s": 0.0}, "duration 0 s: must be over 0"),
        ({"start_s": 60.0, "duration_s": 50.0}, "from 60 s on, at most 40 s are left"),
        ({"speed": -1.0}, "speed -1: must be over 0"),
        ({"fps": -5.0}, "fps -5: must be over 0"),
        ({"camera": "front"}, "camera front: unknown; choose overview, chase, top, scout"),
        ({"follow": "scouts_0"}, "follow scouts_0: camera top follows nobody"),
        ({"size": (20, None)}, "width 20: must be 64 to 3840 pixels"),
        ({"size": (None, 9000)}, "height 9000: must be 64 to 2160 pixels"),
    ],
)
def test_bad_options_are_named(
    recording: Recording, tmp_path: Path, options: dict[str, Any], message: str
) -> None:
    with pytest.raises(UserError, match=message):
        render_recording(recording, tmp_path / "film.mp4", **options)
    assert list(tmp_path.iterdir()) == []


def test_a_film_shows_four_steps_a_second_and_reports_progress(
    recording: Recording, tmp_path: Path
) -> None:
    path, seen = tmp_path / "film.mp4", list[tuple[int, int]]()
    count = render_recording(
        recording,
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
        source = map_film([recording], (480, 270)).frame(time)
        assert np.abs(decoded[number].astype(float) - source).mean() < 4.0


def test_png_shows_the_start_and_one_length_gives_the_other(
    recording: Recording, tmp_path: Path
) -> None:
    assert render_recording(recording, tmp_path / "a.png", start_s=35.0, size=(None, 360)) == 1
    shown = np.asarray(PilImage.open(tmp_path / "a.png"))
    np.testing.assert_array_equal(shown, map_film([recording], (640, 360)).frame(3.5))


def test_each_half_shows_its_own_episode(
    recording: Recording, shorter: Recording, tmp_path: Path
) -> None:
    size = (640, 480)
    image = still(tmp_path, recording, shorter, step=2.0, size=size)
    gone = replace(shorter, item_present=np.zeros_like(shorter.item_present))
    other = still(tmp_path, recording, gone, step=2.0, size=size)
    left, right = halves(size)
    np.testing.assert_array_equal(part(image, left), part(other, left))
    assert (part(image, right) != part(other, right)).any(axis=2).sum() > 20
    swapped = still(tmp_path, replace(shorter, policy="belief"), recording, step=2.0, size=size)
    assert (image[: int(left.top)] != swapped[: int(left.top)]).any(), "names stand above"


def test_beliefs_of_both_have_one_scale(
    recording: Recording, shorter: Recording, tmp_path: Path
) -> None:
    """The largest count of either episode changes how dark a count is drawn in both."""
    belief, other = np.zeros_like(recording.belief), np.zeros_like(shorter.belief)
    belief[:, 3, 4] = 3
    more = other.copy()
    more[-1, 6, 10] = 60
    images = [
        still(
            tmp_path,
            replace(recording, belief=belief),
            replace(shorter, belief=one),
            step=0.0,
            size=(960, 540),
        )
        for one in (other, more)
    ]
    left, _ = halves((960, 540))
    assert (part(images[0], left) != part(images[1], left)).any()


@pytest.mark.parametrize("order", [1, -1])
def test_the_shorter_one_stays_at_its_end_while_the_other_goes_on(
    recording: Recording, shorter: Recording, tmp_path: Path, order: int
) -> None:
    pair, size = (recording, shorter)[::order], (800, 480)
    at_end, later = (still(tmp_path, *pair, step=step, size=size) for step in (3.0, 5.0))
    goes, stands = halves(size)[::order]
    assert np.array_equal(part(at_end, stands), part(later, stands))
    assert not np.array_equal(part(at_end, goes), part(later, goes))
    strip = np.s_[int(goes.bottom) :]
    assert (at_end[strip] != later[strip]).any(), "the clock goes on"


@pytest.mark.usefixtures("opengl")
@pytest.mark.parametrize("camera", ["overview", "chase", "top"])
def test_mujoco_draws_both(
    recording: Recording, shorter: Recording, tmp_path: Path, camera: str
) -> None:
    pair = [replace(one, world="physics") for one in (recording, shorter)]
    path, size = tmp_path / "a.png", (641, 361)
    options: dict[str, Any] = {"camera": camera, "start_s": 20.0, "size": size}
    assert render_recording(pair[0], path, beside=pair[1], **options) == 1
    image = np.asarray(PilImage.open(path))
    assert image.shape == (361, 641, 3)
    assert all(part(image, box).std() > 15.0 for box in halves(size))


def test_what_cannot_share_a_clock_is_refused(
    recording: Recording, shorter: Recording, tmp_path: Path
) -> None:
    with pytest.raises(UserError, match="beside greedy: is the film's own policy"):
        render_recording(recording, tmp_path / "a.png", beside=replace(shorter, policy="greedy"))
    with pytest.raises(UserError, match="beside levy: is not the same episode"):
        render_recording(recording, tmp_path / "a.png", beside=replace(shorter, episode=7))
    assert list(tmp_path.iterdir()) == []
