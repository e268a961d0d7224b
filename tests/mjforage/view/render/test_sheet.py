import numpy as np
import pytest

from mjforage.view.render.cameras import Area
from mjforage.view.render.sheet import FOAM, MOST_TEXELS, blank_sheet

AREA = Area(10.0, -20.0, 40.0, 0.0)
RED = (255.0, 0.0, 0.0)


def test_a_sheet_covers_its_area_and_does_not_swim() -> None:
    sheet = blank_sheet(AREA, 0.1)
    height, width, _ = sheet.texels.shape
    assert (width, height) == (300, 200)
    moved = blank_sheet(Area(10.03, -20.0, 40.03, 0.0), 0.1)
    assert moved.west == pytest.approx(sheet.west)
    large = blank_sheet(Area(0.0, 0.0, 5000.0, 100.0), 0.1)
    assert max(large.texels.shape[:2]) <= MOST_TEXELS + 1


def test_a_stroke_has_its_area_and_its_colour_times_cover() -> None:
    sheet = blank_sheet(AREA, 0.1)
    line = np.array([[20.0, -10.0], [30.0, -10.0]])
    sheet.stroke(line, np.full(2, 2.0), np.full(2, 0.5), RED)
    cover = sheet.texels[..., 3]
    assert cover.sum() * 0.01 == pytest.approx(0.5 * (20.0 + np.pi), rel=0.01)
    np.testing.assert_allclose(sheet.texels[..., 0], 255.0 * cover, rtol=1e-5)
    assert sheet.texels[..., 1].max() == 0.0
    row, column = (int(v) for v in sheet.places(np.array([[25.0, -10.0]]))[0][::-1])
    assert cover[row, column] == 0.5


def test_paint_goes_over_paint() -> None:
    sheet = blank_sheet(AREA, 0.1)
    line = np.array([[20.0, -10.0], [30.0, -10.0]])
    for colour in (RED, (0.0, 255.0, 0.0)):
        sheet.stroke(line, np.full(2, 2.0), np.full(2, 0.5), colour)
    assert sheet.texels[100, 150].tolist() == pytest.approx([63.75, 127.5, 0.0, 0.75, 0.0])


def test_foam_keeps_the_stronger_and_fades_to_its_sides() -> None:
    sheet = blank_sheet(AREA, 0.1)
    line = np.array([[20.0, -10.0], [30.0, -10.0]])
    for strength in (0.4, 0.8, 0.2):
        sheet.foam(line, np.full(2, 4.0), np.full(2, strength))
    foam = sheet.texels[..., FOAM]
    assert foam.max() == pytest.approx(0.8, rel=0.01)
    middle = foam[100:121, 150]
    assert (np.diff(middle) <= 0.0).all()
    assert middle[-1] == 0.0
    assert not sheet.texels[..., :4].any()


def test_rings_are_rings_and_what_lies_outside_is_cut_off() -> None:
    sheet = blank_sheet(AREA, 0.1)
    at = np.array([[25.0, -10.0], [500.0, 500.0], [10.0, 0.0]])
    sheet.rings(at, np.full(3, 2.0), np.full(3, 0.4), np.ones(3), RED)
    cover = sheet.texels[..., 3]
    assert cover[100, 150] == 0.0
    one = cover[50:150, 100:200].sum() * 0.01
    assert one == pytest.approx(2.0 * np.pi * 2.0 * 0.4, rel=0.02)
    line = np.array([[-50.0, -50.0], [-40.0, -50.0]])
    before = sheet.texels.copy()
    sheet.stroke(line, np.full(2, 2.0), np.ones(2), RED)
    sheet.foam(line, np.full(2, 2.0), np.ones(2))
    np.testing.assert_array_equal(sheet.texels, before)
