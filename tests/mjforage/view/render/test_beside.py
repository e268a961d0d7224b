"""Two episodes in one film: sizes, labels, the clock, and the end of the shorter one."""

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
from mjforage.view.render import render_replay
from mjforage.view.render.beside import BesideFrame

Build = Callable[..., Recording]
Image = NDArray[np.uint8]
SERIES = ("agent_rc", "item_rc", "item_present", "belief", "idleness", "in_view")


@pytest.fixture(scope="module")
def first(build: Build) -> Recording:
    water = np.ones((14, 18), np.bool_)
    water[0], water[:, 0], water[6:8, 5:14] = False, False, False
    return replace(build(water, steps=6, items=8), policy="greedy")


@pytest.fixture(scope="module")
def shorter(first: Recording) -> Recording:
    """The same, over after step 3."""
    cut: dict[str, Any] = {name: getattr(first, name)[:4] for name in SERIES}
    frames = 1 + (len(first.track_pose) - 1) * 3 // 6
    track = ("track_pose", "track_items", "track_present", "track_wind")
    cut |= {name: getattr(first, name)[:frames] for name in track}
    return replace(first, policy="levy", **cut)


def still(
    first: Recording, second: Recording, path: Path, step: float, size: tuple[int, int]
) -> Image:
    start_s = step * first.period_s
    options: dict[str, Any] = {"start_s": start_s, "size": size}
    assert render_replay(first, path / "a.png", beside=second, **options) == 1
    return np.asarray(PilImage.open(path / "a.png"))


@pytest.mark.parametrize("size", [(1281, 721), (960, 540), (480, 270), (720, 1280)])
def test_halves_are_of_one_size_and_share_the_frame_with_the_rest(size: tuple[int, int]) -> None:
    place = BesideFrame(*size)
    (left, right), (width, height) = place.pictures, size
    assert 0 <= right.width - left.width <= 1
    assert (left.left, right.right) == (0, width)
    assert left.right < right.left
    assert left.top == right.top >= 20
    assert left.bottom == right.bottom <= height
    assert 2 * left.width * left.height > 0.5 * width * height


def test_each_half_shows_its_own_episode(
    first: Recording, shorter: Recording, tmp_path: Path
) -> None:
    place, size = BesideFrame(640, 480), (640, 480)
    image = still(first, shorter, tmp_path, 2.0, size)
    gone = replace(shorter, item_present=np.zeros_like(shorter.item_present))
    other = still(first, gone, tmp_path, 2.0, size)
    left, right = (
        np.s_[int(b.top) : int(b.bottom), int(b.left) : int(b.right)] for b in place.pictures
    )
    np.testing.assert_array_equal(image[left], other[left])
    assert (image[right] != other[right]).any(axis=2).sum() > 20
    swapped = still(replace(shorter, policy="belief"), first, tmp_path, 2.0, size)
    assert (image[: place.head] != swapped[: place.head]).any(), "names stand above"


def test_beliefs_of_both_have_one_scale(
    first: Recording, shorter: Recording, tmp_path: Path
) -> None:
    """What the other believes at most changes how dark a count is drawn in both."""
    belief = np.zeros_like(first.belief)
    belief[:, 3, 4] = 3
    other = np.zeros_like(shorter.belief)
    plain, more = replace(first, belief=belief), other.copy()
    more[-1, 10, 10] = 60
    size = (960, 540)
    alike = still(plain, replace(shorter, belief=other), tmp_path, 0.0, size)
    darker = still(plain, replace(shorter, belief=more), tmp_path, 0.0, size)
    (left, _), changed = BesideFrame(*size).pictures, (alike != darker).any(axis=2)
    top, bottom = round(left.top), round(left.bottom)
    assert changed[top:bottom, : round(left.right)].any(), "the left map, by the right one's scale"


@pytest.mark.parametrize("order", ["longer first", "shorter first"])
def test_the_shorter_one_stays_at_its_end_while_the_other_goes_on(
    first: Recording, shorter: Recording, tmp_path: Path, order: str
) -> None:
    pair = (first, shorter) if order == "longer first" else (shorter, first)
    boxes = BesideFrame(800, 480).pictures
    at_end, later = (still(*pair, tmp_path, step, (800, 480)) for step in (3.0, 5.0))
    stands, goes = (boxes[1], boxes[0]) if order == "longer first" else boxes
    for box, same in ((stands, True), (goes, False)):
        part = np.s_[int(box.top) : int(box.bottom), int(box.left) : int(box.right)]
        assert np.array_equal(at_end[part], later[part]) == same
    strip = np.s_[int(boxes[0].bottom) :]
    assert (at_end[strip] != later[strip]).any(), "the clock goes on"


def test_films_of_odd_widths_gifs_and_series_are_written(
    first: Recording, shorter: Recording, tmp_path: Path
) -> None:
    options: dict[str, Any] = {"beside": shorter, "fps": 5.0, "speed": 10.0, "size": (321, 241)}
    lasts = round(6 * first.period_s / 10.0 * 5.0) + 1
    assert render_replay(first, tmp_path / "a.mp4", **options) == lasts
    with av.open(str(tmp_path / "a.mp4")) as film:
        frames = [frame.to_ndarray(format="rgb24") for frame in film.decode(video=0)]
    assert len(frames) == lasts
    assert frames[0].shape == (242, 322, 3)
    assert render_replay(first, tmp_path / "a.gif", **options) == lasts
    assert render_replay(first, tmp_path / "b-%02d.png", **options) == lasts


@pytest.mark.parametrize("camera", ["overview", "chase", "top"])
def test_mujoco_draws_both(
    opengl: str, first: Recording, shorter: Recording, refine: Build, tmp_path: Path, camera: str
) -> None:
    assert opengl
    pair, size = [refine(each) for each in (first, shorter)], (641, 361)
    path = tmp_path / "a.png"
    options: dict[str, Any] = {"camera": camera, "start_s": 2.0 * first.period_s, "size": size}
    assert render_replay(pair[0], path, beside=pair[1], **options) == 1
    image = np.asarray(PilImage.open(path))
    assert image.shape == (361, 641, 3)
    for box in BesideFrame(*size).pictures:
        part = image[int(box.top) : int(box.bottom), int(box.left) : int(box.right)]
        assert part.std() > 15.0


def test_what_cannot_share_a_clock_is_refused(
    first: Recording, shorter: Recording, tmp_path: Path
) -> None:
    with pytest.raises(UserError, match="beside greedy: is the film's own policy"):
        render_replay(first, tmp_path / "a.png", beside=replace(shorter, policy="greedy"))
    with pytest.raises(UserError, match="beside levy: is not the same episode"):
        render_replay(first, tmp_path / "a.png", beside=replace(shorter, episode=7))
    assert list(tmp_path.iterdir()) == []
