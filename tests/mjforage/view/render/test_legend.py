"""Every sign of the legend looks as on the map, and says what it stands for."""

import numpy as np
import pytest

from mjforage.view.render import legend as module
from mjforage.view.render import palette
from mjforage.view.render.frame_layout import LEGEND_ROW, plan_layout
from mjforage.view.render.legend import Legend, round_length
from mjforage.view.render.palette import Colour
from mjforage.view.render.raster import Image

LAYOUT = plan_layout(20, 30, 2)
LEFT, TOP = 20, 20  # corner [pixel]; the unit is a pixel


@pytest.fixture
def said(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What is written, instead of its letters."""
    words: list[str] = []
    monkeypatch.setattr(module, "write", lambda image, text, *at, **how: words.append(text))
    return words


@pytest.fixture
def image() -> Image:
    return np.zeros((400, 400, 3), np.uint8)


def row(image: Image, number: int, wide: int = 34) -> Image:
    """Pixels of the sign in a row."""
    y = TOP + 13 + LEGEND_ROW * number
    return image[y - 10 : y + 11, LEFT : LEFT + wide]


def nearest(pixels: Image, colour: Colour) -> float:
    """How far the pixel that is most like a colour is from it."""
    return float(np.abs(pixels.astype(float) - np.array(colour)).max(axis=2).min())


@pytest.mark.parametrize(("pitch_m", "most_m"), [(4.0, 20.0), (1.0, 5.0), (50.0, 200.0)])
def test_the_scale_bar_is_as_long_as_it_says(
    image: Image, said: list[str], pitch_m: float, most_m: float
) -> None:
    """So many pixels as the map takes for that many metres, and at most 150 units."""
    Legend(image, (LEFT, TOP), LAYOUT).scale_bar(pitch_m)
    (words,) = said
    length_m = float(words.removesuffix(" m"))
    dark = np.argwhere((image[TOP + 13] > 0).any(axis=1))
    pixels = np.ptp(dark) + 1
    assert pixels == pytest.approx(length_m / pitch_m * LAYOUT.scale, abs=2.0)
    assert 60 < pixels <= 150
    assert length_m == most_m == round_length(150 * pitch_m / LAYOUT.scale)


def test_round_lengths_fit() -> None:
    assert [round_length(most) for most in (0.9, 1.0, 4.9, 7.0, 230.0)] == [0.5, 1, 2, 5, 200]


def test_idleness_is_clear_at_0_and_hazy_at_1(image: Image, said: list[str]) -> None:
    Legend(image, (LEFT, TOP), LAYOUT).idleness()
    scale = row(image, 0, 110)[10]
    assert tuple(scale[0]) == palette.CLEAR_DEEP and tuple(scale[-1]) == palette.HAZY_DEEP
    assert said == ["idleness 0 to 1"]


def test_items_and_beliefs_look_as_on_the_map(image: Image, said: list[str]) -> None:
    """A discovered item is brighter; the third belief has the shade of the most."""
    Legend(image, (LEFT, TOP), LAYOUT).items(9)
    words = ["item, discovered", "item, not yet discovered", "items believed here: 1, 2, 9"]
    assert said == [*words, "item just collected"]
    assert nearest(row(image, 0), palette.ITEM) < 2.0
    assert nearest(row(image, 1), palette.ITEM) > 10.0, "dim until it is discovered"
    shades = palette.belief_shades(np.array([1, 2, 9]), 9)
    middle = row(image, 2)[10]
    for number, place in enumerate((6, 17, 28)):
        away = np.abs(middle[place].astype(float) - shades).max(axis=1)
        assert away.argmin() == number


@pytest.mark.parametrize(("collects", "own"), [(False, palette.SCOUT), (True, palette.FORAGER)])
def test_a_team_has_its_hulls_and_the_colour_of_its_view(
    image: Image, said: list[str], collects: bool, own: Colour
) -> None:
    colours = [(250.0, 10.0, 10.0), (10.0, 250.0, 10.0), (10.0, 10.0, 250.0)]
    Legend(image, (LEFT, TOP), LAYOUT).team("ours", collects, colours)
    assert said == ["ours (3)", "in view of ours"]
    assert nearest(row(image, 0), colours[0]) < 30 and nearest(row(image, 0), colours[1]) < 30
    line = row(image, 1)[4].astype(float)
    away = {code: np.abs(line - np.array(code)).max(axis=1).min() for code in (own, _other(own))}
    assert away[own] < away[_other(own)]


def _other(colour: Colour) -> Colour:
    return palette.FORAGER if colour == palette.SCOUT else palette.SCOUT


def test_contacts_and_losses_have_their_lines(image: Image, said: list[str]) -> None:
    Legend(image, (LEFT, TOP), LAYOUT).links(True, (250.0, 10.0, 10.0))
    assert said[:2] == ["in contact", "looks lost in this step"]
    lost = [nearest(row(image, number), palette.LOST) for number in (0, 1)]
    assert lost[1] < 30.0 < lost[0]
