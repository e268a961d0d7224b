import dataclasses
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.runs.episode_recording import Recording
from mjforage.view.render import palette, side_panel
from mjforage.view.render.frame_split import Box, Kind, Split, split_frame
from mjforage.view.render.inset import Inset
from mjforage.view.render.raster import Image
from mjforage.view.render.side_panel import Moment, SidePanel, paint_head, paint_notes, paint_signs
from mjforage.view.render.tags import Tags
from mjforage.view.render.timeline import timeline_of

COLOURS = palette.agent_colours([False, True])


@pytest.fixture(scope="module")
def replay(build: Callable[..., Recording]) -> Recording:
    water = np.zeros((20, 16), np.bool_)
    water[3:15, 2:14] = True
    return build(water, steps=8, items=10)


SIZES = [(1280, 720), (960, 540), (640, 480), (3840, 2160), (720, 1280), (480, 270), (161, 121)]
NORTH = 0.0


def panel_of(replay: Recording, split: Split, followed: int | None = None) -> SidePanel:
    colours = palette.agent_colours(replay.agent_collects.tolist())
    return SidePanel(replay, timeline_of(replay), split, colours, followed)


def moment(replay: Recording, step: int) -> Moment:
    places = replay.agent_rc[step].astype(np.float64)
    return Moment(np.column_stack((places, np.zeros(len(places)))), "a note", NORTH)


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("shape", [None, 0.5, 3.0])
def test_the_panel_stays_off_the_picture_and_the_picture_is_most_of_the_frame(
    replay: Recording, size: tuple[int, int], shape: float | None
) -> None:
    width, height = size
    split = split_frame(width, height, shape)
    image = np.full((height, width, 3), 200, np.uint8)
    panel_of(replay, split).paint(image, 3.5, moment(replay, 3))
    left, top, right, bottom = (int(side) for side in split.view)
    assert (image[top:bottom, left:right] == 200).all()
    assert (bottom - top) * (right - left) > 0.5 * width * height
    assert (image != 200).any(axis=2).sum() + (bottom - top) * (right - left) == width * height


def test_the_panel_is_where_it_leaves_the_picture_larger() -> None:
    assert split_frame(1280, 720, 0.8).kind is Kind.COLUMN
    assert split_frame(1280, 720, 3.0).kind is Kind.ROW
    assert split_frame(720, 1280, None).kind is Kind.ROW
    assert split_frame(320, 240, 0.8).kind is Kind.LINE


def test_figures_change_with_the_story(replay: Recording) -> None:
    split = split_frame(640, 480, 1.0)
    images = []
    for time in (0.0, 8.0):
        image = np.full((480, 640, 3), 200, np.uint8)
        panel_of(replay, split).paint(image, time, moment(replay, 0))
        images.append(image)
    assert (images[0][:180, :200] != images[1][:180, :200]).any()


@pytest.fixture
def said(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What is written, instead of its letters."""
    words: list[str] = []
    monkeypatch.setattr(side_panel, "write", lambda image, text, *at, **how: words.append(text))
    return words


@pytest.fixture
def told(replay: Recording) -> Recording:
    """Of ten items seven are discovered and four collected by step 5; all in the end."""
    present = np.ones((9, 10), np.bool_)
    present[5:, :4] = present[8:, 4:] = False
    found = np.array([0, 1, 2, 3, 4, 5, 5, 8, 8, 8], np.int16)
    belief = np.zeros_like(replay.belief)
    belief[0, 8, 8], belief[5, 8, 8], belief[6, 8, 8] = 2, 3, 6
    return dataclasses.replace(replay, item_present=present, t_discovered=found, belief=belief)


def test_score_and_clock_tell_what_is_known_then(told: Recording, said: list[str]) -> None:
    """At step 5.5 of steps of 10 s, each bar as long as its share."""
    split, image = split_frame(1280, 720, 1.0), np.zeros((720, 1280, 3), np.uint8)
    panel_of(told, split).paint(image, 5.5, moment(told, 5))
    place = said.index("PTA_D")
    assert said[place : place + 3] == ["PTA_D", "7 of 10 discovered", "70 %"]
    assert said[place + 3 : place + 6] == ["PTA_C", "4 of 10 collected", "40 %"]
    assert said[place - 2 : place] == ["00:55", f"step 5 of {told.horizon}"]
    assert "3" in said, "believed items of then"
    bar = side_panel.SCORE_WIDTH * split.unit
    for colour, share in ((palette.SCOUT, 0.7), (palette.FORAGER, 0.4)):
        lengths = (np.abs(image.astype(float) - np.array(colour)).max(axis=2) < 3).sum(axis=1)
        assert np.sort(lengths)[-3] == pytest.approx(share * bar, abs=8.0)


def test_one_line_tells_the_same(told: Recording, said: list[str]) -> None:
    split = split_frame(480, 200, None)
    assert split.kind is Kind.LINE
    panel_of(told, split).paint(np.zeros((200, 480, 3), np.uint8), 5.5, moment(told, 5))
    assert said == ["00:55   PTA_D 70 %   PTA_C 40 %"]


def test_signs_of_items_and_idleness_are_as_on_the_map(replay: Recording, said: list[str]) -> None:
    image = np.zeros((140, 260, 3), np.uint8)
    paint_signs(image, Box(0, 0, 260, 140), 1.0, replay, 9, drawn=True)
    assert said[:4] == ["item, discovered", "item, not yet", "believed: 1, 2, 9", "idleness 0–1"]
    bright = [
        np.abs(image[22 * n : 22 * n + 22, :36].astype(float) - palette.ITEM).max(axis=2).min()
        for n in (0, 1)
    ]
    assert bright[0] < 2.0 < 10.0 < bright[1]
    scale = image[22 * 3 + 11, :34]
    assert tuple(scale[0]) == palette.CLEAR_DEEP and tuple(scale[-1]) == palette.HAZY_DEEP


@pytest.mark.parametrize(
    ("title", "shown"),
    [("my_policies:Homing(heading=4)", "Homing(heading=4)"), ("belief(items=30)",) * 2],
)
def test_a_class_of_a_user_is_named_without_its_module(
    replay: Recording, monkeypatch: pytest.MonkeyPatch, title: str, shown: str
) -> None:
    said: list[str] = []
    monkeypatch.setattr(side_panel, "write", lambda image, words, *at, **how: said.append(words))
    paint_head(np.zeros((60, 600, 3), np.uint8), Box(0, 0, 600, 60), 1.0, replay, title)
    assert said[0] == shown


def test_the_signs_of_a_drawing_show_scouts_and_foragers_in_their_colours(
    replay: Recording,
) -> None:
    image = np.zeros((140, 260, 3), np.uint8)
    paint_signs(image, Box(0, 0, 260, 140), 1.0, replay, 4, drawn=True)
    for row, colour in ((4, palette.SCOUT), (5, palette.FORAGER)):
        mark = image[row * 22 : row * 22 + 22, :36].reshape(-1, 3).astype(float)
        assert np.abs(mark - colour).max(axis=1).min() < 12.0


def test_the_compass_turns_with_the_picture(replay: Recording) -> None:
    images = []
    for north_rad in (0.0, 1.5):
        image = np.zeros((200, 300, 3), np.uint8)
        paint_notes(image, Box(0, 0, 300, 60), 1.0, Moment(np.zeros((0, 3)), "", north_rad))
        images.append(image)
    light = [np.argwhere(image.min(axis=2) > 250).mean(axis=0) for image in images]
    assert light[0][0] < light[1][0] - 2.0, "a northward needle is higher"
    assert light[1][1] > light[0][1] + 2.0, "and one to the right is further right"


def test_a_dart_comes_from_where_the_wind_does(
    replay: Recording, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In a picture whose north is right, a wind to the north comes from the left."""
    said: list[str] = []
    monkeypatch.setattr(side_panel, "write", lambda image, words, *at, **how: said.append(words))
    middles = []
    for north_rad in (0.0, 0.5 * np.pi):
        still, windy = (np.zeros((80, 300, 3), np.uint8) for _ in range(2))
        for image, wind in ((still, (0.0, 0.0)), (windy, (0.0, 6.04))):
            paint_notes(
                image, Box(0, 0, 300, 80), 1.0, Moment(np.zeros((0, 3)), "x", north_rad, wind)
            )
        middles.append(np.argwhere((still != windy).any(axis=2)).mean(axis=0) - (40.0, 24.0))
    assert middles[0][0] > 15.0 and abs(middles[0][1]) < 1.0, "below"
    assert middles[1][1] < -15.0 and abs(middles[1][0]) < 1.0, "to the left"
    assert said.count("wind 6.0 m/s") == 2 and said.count("x") == 4


def test_tags_do_not_cover_each_other(replay: Recording) -> None:
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
        assert left >= 0.0
        assert right <= 1280.0
        assert top >= 0.0


def test_tags_cover_no_vessel_and_what_floats_below_them_shows() -> None:
    """Two vessels beside each other to the north-south: the southern one's name goes above both."""
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
    nobody = before.copy()
    names.paint(nobody, np.full((2, 2), np.nan), radius)
    np.testing.assert_array_equal(nobody, before)


@pytest.mark.parametrize("width", [480, 240])
def test_a_line_of_words_has_a_compass_too(replay: Recording, width: int) -> None:
    split = split_frame(width, 200, None)
    images = []
    for north_rad in (0.0, 1.5):
        image = np.zeros((200, width, 3), np.uint8)
        now = moment(replay, 3)
        panel_of(replay, split).paint(image, 3.5, Moment(now.hulls, now.notes, north_rad))
        images.append(image)
    turned = np.argwhere((images[0] != images[1]).any(axis=2))
    assert len(turned) > 30
    assert turned[:, 0].max() < split.panel.bottom
    assert turned[:, 1].min() > width - 30, "at the end of the line, the words are the same"


def test_the_inset_shows_belief_where_it_is_and_hulls_in_their_colours(replay: Recording) -> None:
    colours = palette.agent_colours(replay.agent_collects.tolist())
    inset = Inset(replay, colours, (200.0, 200.0))
    assert (inset.width, inset.height) == (200, 200)
    hulls = np.array([[4.0, 3.0], [4.0, 12.0], [13.0, 3.0], [13.0, 12.0]])
    image = painted(inset, hulls, np.zeros(4))
    scale = 200 / 14

    def pixel(row: float, column: float) -> tuple[int, int]:
        return 10 + int((row + 0.5 - 2) * scale), 10 + int((column + 0.5 - 1) * scale)

    for agent, (row, column) in enumerate(hulls):
        y, x = pixel(row, column)
        near = image[y - 4 : y + 5, x - 4 : x + 5].reshape(-1, 3).astype(float)
        assert np.abs(near - colours[agent]).max(axis=1).min() < 12.0
    believed = np.argwhere(replay.belief[5] > 0)
    away = [rc for rc in believed if np.abs(hulls - rc).max(axis=1).min() > 1.5]
    assert away
    for row, column in away:
        count = replay.belief[5][row, column]
        shade = palette.belief_shades(np.array([count]), palette.most_believed(replay.belief))[0]
        np.testing.assert_allclose(image[pixel(row, column)], shade, atol=1.0)


def painted(inset: Inset, places: NDArray[np.float64], course: NDArray[np.float64]) -> Image:
    image = np.zeros((220, 220, 3), np.uint8)
    inset.paint(image, 10, 10, 5.0, np.column_stack((places, course)))
    return image


def test_the_inset_shows_headings_and_who_is_followed(replay: Recording) -> None:
    colours = palette.agent_colours(replay.agent_collects.tolist())
    places = np.array([[4.0, 3.0], [4.0, 12.0], [13.0, 3.0], [13.0, 12.0]])
    east, south = np.zeros(4), np.full(4, 0.5 * np.pi)
    plain = Inset(replay, colours, (200.0, 200.0))
    first, turned = painted(plain, places, east), painted(plain, places, south)
    assert (first != turned).any(axis=2).sum() > 40
    marked = painted(Inset(replay, colours, (200.0, 200.0), followed=2), places, east)
    changed = np.argwhere((marked != first).any(axis=2))
    scale = 200 / 14
    middle = 10 + np.array([(13.5 - 2) * scale, (3.5 - 1) * scale])
    assert len(changed) > 20
    assert np.abs(changed - middle).max() < 20.0, "around that vessel only"
