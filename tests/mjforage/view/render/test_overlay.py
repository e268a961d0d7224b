from collections.abc import Callable

import numpy as np
import pytest

from mjforage.runs.episode_replay import Replay
from mjforage.view.render.inset import Inset
from mjforage.view.render.overlay import Overlay
from mjforage.view.render.palette import team_colours
from mjforage.view.render.timeline import timeline_of

COLOURS = team_colours([False, True])


@pytest.fixture(scope="module")
def replay(build: Callable[..., Replay]) -> Replay:
    water = np.zeros((20, 16), np.bool_)
    water[3:15, 2:14] = True
    return build(water, steps=8, items=10)


@pytest.mark.parametrize("size", [(1280, 720), (640, 480), (3840, 2160), (720, 1280), (480, 320)])
def test_words_stay_inside_the_frame_and_off_its_middle(
    replay: Replay, size: tuple[int, int]
) -> None:
    width, height = size
    overlay = Overlay(replay, timeline_of(replay), width, height)
    image = np.full((height, width, 3), 200, np.uint8)
    overlay.paint(image, 3.5, replay.agent_rc[3].astype(np.float64), "a note")
    changed = (image != 200).any(axis=2)
    assert changed[: height // 2, : width // 2].mean() > 0.03
    assert changed[height // 2 :, width // 2 :].mean() > 0.03
    edge = max(2, min(width, height) // 90)
    for border in (changed[:edge], changed[-edge:], changed[:, :edge], changed[:, -edge:]):
        assert not border.any()
    middle = changed[:, int(0.44 * width) : int(0.56 * width)]
    assert middle.mean() < 0.05


@pytest.mark.parametrize("size", [(64, 64), (160, 120), (320, 240)])
def test_small_frames_have_one_line_that_fits(replay: Replay, size: tuple[int, int]) -> None:
    width, height = size
    image = np.full((height, width, 3), 200, np.uint8)
    overlay = Overlay(replay, timeline_of(replay), width, height)
    overlay.paint(image, 3.5, replay.agent_rc[3].astype(np.float64), "a note")
    overlay.tags(image, np.array([[30.0, 50.0]] * 4), ("a", "b", "c", "d"))
    changed = (image != 200).any(axis=2)
    assert changed[:26].any()
    assert not changed[26:].any()
    assert not changed[:, -2:].any()


def test_figures_change_with_the_story(replay: Replay) -> None:
    overlay = Overlay(replay, timeline_of(replay), 640, 480)
    images = []
    for time in (0.0, 8.0):
        image = np.full((480, 640, 3), 200, np.uint8)
        overlay.paint(image, time, replay.agent_rc[0].astype(np.float64), "")
        images.append(image)
    assert (images[0][:180, :240] != images[1][:180, :240]).any()


def test_tags_do_not_cover_each_other(replay: Replay) -> None:
    overlay = Overlay(replay, timeline_of(replay), 1280, 720)
    taken: list[tuple[float, float, float, float]] = []
    for x, y in ((600.0, 300.0), (610.0, 302.0), (604.0, 306.0), (605.0, 296.0)):
        box = overlay._free_box(x, y, "forager-0", taken)
        for other in taken:
            apart_x = box[0] >= other[2] or other[0] >= box[2]
            assert apart_x or box[1] >= other[3] or other[1] >= box[3]
        taken.append(box)
    for corner in ((-50.0, -20.0), (2000.0, 5.0)):
        left, top, right, _ = overlay._free_box(*corner, "forager-0", [])
        assert left >= 0.0
        assert right <= 1280.0
        assert top >= 0.0


def test_the_inset_shows_belief_where_it_is_and_hulls_in_their_colours(replay: Replay) -> None:
    inset = Inset(replay, COLOURS, (200.0, 200.0))
    assert (inset.width, inset.height) == (200, 200)
    image = np.zeros((220, 220, 3), np.uint8)
    hulls = np.array([[4.0, 3.0], [4.0, 12.0], [13.0, 3.0], [13.0, 12.0]])
    inset.paint(image, 10, 10, 5.0, hulls)
    scale = 200 / 14
    for agent, (row, column) in enumerate(hulls):
        y, x = 10 + (row + 0.5 - 2) * scale, 10 + (column + 0.5 - 1) * scale
        np.testing.assert_array_equal(
            image[int(y), int(x)], np.array(COLOURS[int(replay.agent_collects[agent])], np.uint8)
        )
    believed = np.argwhere(replay.belief[5] > 0)
    away = [rc for rc in believed if np.abs(hulls - rc).max(axis=1).min() > 1.5]
    assert away
    for row, column in away:
        y, x = 10 + (row + 0.5 - 2) * scale, 10 + (column + 0.5 - 1) * scale
        assert image[int(y), int(x), 0] > 240
        assert image[int(y), int(x), 2] < 120
