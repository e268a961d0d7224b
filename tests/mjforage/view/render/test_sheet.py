"""Paint and foam on the water, in world coordinates; the shapes are those of `raster`."""

import numpy as np
import pytest

from mjforage.view.render.cameras import Area
from mjforage.view.render.sheet import FOAM, MOST_TEXELS, Sheet

AREA = Area(10.0, -20.0, 40.0, 0.0)
RED = (255.0, 0.0, 0.0)
LINE = np.array([[20.0, -10.0], [30.0, -10.0]])


def test_a_sheet_covers_its_area_and_does_not_swim() -> None:
    sheet = Sheet.blank(AREA, 0.1)
    height, width, _ = sheet.texels.shape
    assert (width, height) == (300, 200)
    moved = Sheet.blank(Area(10.03, -20.0, 40.03, 0.0), 0.1)
    assert moved.west == pytest.approx(sheet.west)
    large = Sheet.blank(Area(0.0, 0.0, 5000.0, 100.0), 0.1)
    assert max(large.texels.shape[:2]) <= MOST_TEXELS + 1


def test_paint_has_its_colour_times_cover_and_goes_over_paint() -> None:
    sheet = Sheet.blank(AREA, 0.1)
    sheet.stroke(LINE, np.full(2, 2.0), np.full(2, 0.5), RED)
    cover = sheet.texels[..., 3] / 255.0
    assert cover.sum() * 0.01 == pytest.approx(0.5 * (20.0 + np.pi), rel=0.02)
    np.testing.assert_array_equal(sheet.texels[..., 0], sheet.texels[..., 3])
    assert sheet.texels[..., 1].max() == 0
    sheet.stroke(LINE, np.full(2, 2.0), np.full(2, 0.5), (0.0, 255.0, 0.0))
    np.testing.assert_allclose(sheet.texels[100, 150], [64, 128, 0, 191, 0], atol=1)


def test_foam_fades_to_its_sides_and_paints_nothing_else() -> None:
    sheet = Sheet.blank(AREA, 0.1)
    sheet.foam(LINE, np.full(2, 4.0), np.full(2, 0.8))
    foam = sheet.texels[..., FOAM].astype(int)
    assert foam.max() == pytest.approx(0.8 * 255, abs=2)
    middle = foam[100:121, 150]
    assert (np.diff(middle) <= 0).all() and middle[10] < 150 and middle[-1] == 0
    assert not sheet.texels[..., :4].any()
