"""The panel of a film: where it is, what it says and what its signs look like."""

from collections.abc import Callable
from dataclasses import replace
from unittest.mock import MagicMock

import numpy as np
import pytest

from mjforage.runs.episode_recording import Recording
from mjforage.view.render import map_film, palette
from mjforage.view.render.film_frame import FilmFrame
from mjforage.view.render.layout import Box, frame_layout
from mjforage.view.render.panel import (
    PanelState,
    mission_clock,
    paint_notes,
    paint_signs,
)
from mjforage.view.render.tags import Tags

COLOURS = palette.agent_colours([False, True])
SIZES = [(1280, 720), (960, 540), (640, 480), (3840, 2160), (720, 1280), (480, 270), (161, 121)]


@pytest.fixture(scope="module")
def recording(build: Callable[..., Recording]) -> Recording:
    water = np.zeros((20, 16), np.bool_)
    water[3:15, 2:14] = True
    return build(water, steps=8, items=10)


@pytest.fixture
def known(recording: Recording) -> Recording:
    """Of ten items seven are discovered and four collected by step 5; all in the end."""
    present = np.ones((9, 10), np.bool_)
    present[5:, :4] = present[8:, 4:] = False
    found = np.array([0, 1, 2, 3, 4, 5, 5, 8, 8, 8], np.int16)
    return replace(recording, item_present=present, t_discovered=found)


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("shape", [None, 0.5, 3.0])
@pytest.mark.parametrize("episodes", [1, 2])
def test_parts_of_a_frame_lie_inside_it_and_apart(
    size: tuple[int, int], shape: float | None, episodes: int
) -> None:
    width, height = size
    layout = frame_layout(*size, episodes, shape, 8, charted=True)
    parts = [*layout.pictures, layout.clock, layout.signs]
    parts += [part for score in layout.scores for part in score]
    boxes = [part for part in parts if part is not None]
    for number, box in enumerate(boxes):
        assert 0 <= box.left < box.right <= width and 0 <= box.top < box.bottom <= height
        for other in boxes[number + 1 :]:
            beside = box.right <= other.left or other.right <= box.left
            assert beside or box.bottom <= other.top or other.bottom <= box.top
    assert sum(box.width * box.height for box in layout.pictures) > 0.5 * width * height
    assert episodes == 1 or 0 <= layout.pictures[1].width - layout.pictures[0].width <= 1


def test_the_panel_is_where_it_leaves_the_picture_larger() -> None:
    def picture(width: int, height: int, shape: float | None) -> Box:
        return frame_layout(width, height, 1, shape, 4, charted=True).pictures[0]

    assert picture(1280, 720, 0.8).left > 200, "a column"
    assert picture(1280, 720, 3.0).bottom < 600 and picture(720, 1280, None).bottom < 1200
    assert picture(320, 240, 0.8) == (0, 23, 320, 240), "a line"


def test_score_and_clock_tell_what_is_known_then(known: Recording, said: list[str]) -> None:
    """At step 5.5 of steps of 10 s, each bar as long as its share."""
    image = map_film([known], (1280, 720)).frame(5.5)
    place = said.index("PTA_D")
    assert said[place : place + 3] == ["PTA_D", "7 of 10 discovered", "70 %"]
    assert said[place + 3 : place + 6] == ["PTA_C", "4 of 10 collected", "40 %"]
    place = said.index("00:55")
    assert said[place + 1] == f"step 5 of {known.horizon}"
    panel = image[:200, :286].astype(float)
    for colour, share in ((palette.SCOUT, 0.7), (palette.FORAGER, 0.4)):
        lengths = (np.abs(panel - np.array(colour)).max(axis=2) < 3).sum(axis=1)
        assert np.sort(lengths)[-3] == pytest.approx(share * 250.0, abs=8.0)


def test_one_line_tells_the_same_and_has_a_compass(known: Recording, said: list[str]) -> None:
    image = map_film([known], (480, 200)).frame(5.5)
    assert said == ["greedy   00:55   PTA_D 70 %   PTA_C 40 %"]
    assert image[:23, 450:].max() > 250


def test_the_chart_of_a_panel_marks_whom_the_camera_follows(recording: Recording) -> None:
    size, frames = (1280, 720), []
    layout = frame_layout(*size, 1, None, 4, charted=True)
    for agent in (None, 2):
        view = MagicMock(followed=agent)
        view.picture.return_value = np.zeros((8, 8, 3), np.uint8)
        view.state.return_value = PanelState()
        frames.append(FilmFrame([recording], [view], size, layout, drawn=False).frame(3.0))
    assert (frames[0] != frames[1]).any()


def test_signs_look_as_on_the_map(recording: Recording, said: list[str]) -> None:
    image = np.zeros((140, 260, 3), np.uint8)
    paint_signs(image, Box(0, 0, 260, 140), 1.0, recording, 9, drawn=True)
    words = ["item, discovered", "item, not yet", "believed: 1, 2, 9", "idleness 0–1"]
    assert said == [*words, "scout", "forager"]
    rows = [image[22 * n : 22 * n + 22, :36].astype(float) for n in range(6)]
    bright = [np.abs(row - palette.ITEM).max(axis=2).min() for row in rows[:2]]
    assert bright[0] < 2.0 < 10.0 < bright[1], "dim until it is discovered"
    shades = palette.belief_shades(np.array([1, 2, 9]), 9)
    for number, place in enumerate((6, 17, 28)):
        assert np.abs(rows[2][11, place] - shades).max(axis=1).argmin() == number
    assert tuple(rows[3][11, 0]) == palette.CLEAR_DEEP
    assert tuple(rows[3][11, 33]) == palette.HAZY_DEEP
    for row, colour in zip(rows[4:], (palette.SCOUT, palette.FORAGER), strict=True):
        assert np.abs(row - colour).max(axis=2).min() < 12.0


@pytest.mark.parametrize(
    ("seconds", "text"), [(0.0, "00:00"), (69.9, "01:09"), (1500.0, "25:00"), (3725.0, "1:02:05")]
)
def test_mission_clock(seconds: float, text: str) -> None:
    assert mission_clock(seconds) == text


def test_the_compass_turns_with_the_picture() -> None:
    images = []
    for north_rad in (0.0, 1.5):
        image = np.zeros((200, 300, 3), np.uint8)
        paint_notes(image, Box(0, 0, 300, 60), 1.0, PanelState("", north_rad))
        images.append(image)
    light = [np.argwhere(image.min(axis=2) > 250).mean(axis=0) for image in images]
    assert light[0][0] < light[1][0] - 2.0, "a northward needle is higher"
    assert light[1][1] > light[0][1] + 2.0, "and one to the right is further right"


def test_a_dart_comes_from_where_the_wind_does(said: list[str]) -> None:
    """In a picture whose north is right, a wind to the north comes from the left."""
    middles = []
    for north_rad in (0.0, 0.5 * np.pi):
        still, windy = (np.zeros((80, 300, 3), np.uint8) for _ in range(2))
        for image, wind in ((still, (0.0, 0.0)), (windy, (0.0, 6.04))):
            paint_notes(image, Box(0, 0, 300, 80), 1.0, PanelState("x", north_rad, wind))
        middles.append(np.argwhere((still != windy).any(axis=2)).mean(axis=0) - (40.0, 24.0))
    assert middles[0][0] > 15.0 and abs(middles[0][1]) < 1.0, "below"
    assert middles[1][1] < -15.0 and abs(middles[1][0]) < 1.0, "to the left"
    assert said.count("wind 6.0 m/s") == 2 and said.count("x") == 4


def test_tags_do_not_cover_each_other() -> None:
    tags = Tags(("a",), COLOURS, 1280, 1.0)
    taken: list[tuple[float, float, float, float]] = []
    for x, y in ((600.0, 300.0), (610.0, 302.0), (604.0, 306.0), (605.0, 296.0)):
        box = tags._free_box(x, y, "forager_0", taken)
        for other in taken:
            apart_x = box[0] >= other[2] or other[0] >= box[2]
            assert apart_x or box[1] >= other[3] or other[1] >= box[3]
        taken.append(box)
    for corner in ((-50.0, -20.0), (2000.0, 5.0)):
        left, top, right, _ = tags._free_box(*corner, "forager_0", [])
        assert left >= 0.0 and right <= 1280.0 and top >= 0.0


def test_tags_cover_no_vessel_and_what_floats_below_them_shows() -> None:
    """Of two vessels one above the other, the lower one's name goes above both."""
    names = Tags(("a", "b"), COLOURS, 400, 1.0)
    places, radius = np.array([[200.0, 100.0], [204.0, 125.0]]), np.array([12.0, 12.0])
    image = np.full((300, 400, 3), 100, np.uint8)
    image[60:88, 180:220] = 250  # afloat, where a name will be
    before = image.copy()
    names.paint(image, places, radius)
    for x, y in places.astype(int):
        hull = (slice(y - 11, y + 12), slice(x - 11, x + 12))
        np.testing.assert_array_equal(image[hull], before[hull])
    changed = (image != before).any(axis=2)
    assert changed.sum() > 500
    plate = changed & (before[..., 0] == 250)
    light, dark = image[plate].max(axis=1), image[changed & ~plate].max(axis=1)
    assert np.median(light) > np.median(dark) + 40
