import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.view.render.cameras import Area, View, looking
from mjforage.view.render.sheet import Sheet
from mjforage.view.render.smoothing import smooth_edges
from mjforage.view.render.surface import Drawn
from mjforage.view.render.water import SHORE_M, Water, shore_of

Image = NDArray[np.uint8]
Field = NDArray[np.float32]
SIZE = (60, 80)
WATER = Water(shore_of(np.ones((6, 6), np.bool_), 4.0))
AHEAD = looking(np.array([10.0, 0.0, 3.0]), np.array([10.0, 20.0, 1.0]), np.radians(50.0))


def paint(
    view: View,
    image: Image | None = None,
    ahead: Field | None = None,
    sheet: Sheet | None = None,
    time_s: float = 0.0,
) -> Image:
    """An empty world, or one with something in it."""
    image = np.full((*SIZE, 3), 40, np.uint8) if image is None else image
    ahead = np.full(SIZE, np.inf, np.float32) if ahead is None else ahead
    sheet = sheet or Sheet.blank(Area(0.0, 0.0, 20.0, 20.0), 0.2)
    nothing = Drawn(np.zeros((1, 1, 3), np.uint8), np.full((1, 1), np.inf, np.float32))
    WATER.paint(Drawn(image, ahead), nothing, sheet, view, time_s)
    return image


def test_sky_above_the_horizon_and_water_below() -> None:
    image = paint(AHEAD).astype(int)
    sky, sea = image[0], image[-1]
    assert sky.mean() > 180
    assert (sea[:, 2] > sea[:, 0] + 40).all()
    assert np.abs(image[0] - image[0].mean(axis=0)).max() < 12


def test_what_stands_above_the_water_stays_and_what_lies_deep_vanishes() -> None:
    red = np.zeros((*SIZE, 3), np.uint8)
    red[..., 0] = 200
    near = np.full(SIZE, 1.5, np.float32)
    np.testing.assert_allclose(paint(AHEAD, red.copy(), near), red, atol=1)
    below = looking(np.array([10.0, 8.0, 5.0]), np.array([10.0, 10.0, 0.0]), np.radians(20.0))
    shallow, deep = (
        paint(below, red.copy(), np.full(SIZE, d, np.float32))[30, 40].astype(int)
        for d in (5.45, 9.0)
    )
    assert shallow[0] > deep[0] + 15
    np.testing.assert_allclose(deep, paint(below)[30, 40], atol=12)


def test_the_surface_moves_with_the_time_alone() -> None:
    still = paint(AHEAD)
    np.testing.assert_array_equal(still, paint(AHEAD))
    assert np.abs(paint(AHEAD, time_s=0.5)[40:].astype(int) - still[40:]).mean() > 1.0


def test_foam_and_paint_lie_where_they_were_laid() -> None:
    above = looking(np.array([10.0, 9.99, 12.0]), np.array([10.0, 10.0, 0.0]), np.radians(60.0))
    sheet = Sheet.blank(Area(0.0, 0.0, 20.0, 20.0), 0.1)
    sheet.foam(np.array([[10.0, 8.0], [10.0, 12.0]]), np.full(2, 3.0), np.ones(2))
    line = np.array([[6.0, 8.0], [6.0, 12.0]])
    sheet.stroke(line, np.full(2, 2.0), np.ones(2), (255.0, 0.0, 0.0))
    image = paint(above, sheet=sheet)
    x, y, _ = above.project(np.array([[10.0, 10.0, 0.0], [6.0, 10.0, 0.0]]), 80 / 60).T
    white, red = (image[int(30 * (1 - y[k])), int(40 * (1 + x[k]))] for k in (0, 1))
    assert white.min() > 150
    np.testing.assert_allclose(red, (255, 0, 0), atol=35)


def test_waves_finer_than_a_pixel_do_not_flicker() -> None:
    far = looking(np.array([10.0, -400.0, 300.0]), np.array([10.0, 10.0, 0.0]), np.radians(10.0))
    near = looking(np.array([10.0, 4.0, 5.0]), np.array([10.0, 10.0, 0.0]), np.radians(50.0))
    calm, rough = (paint(view)[20:40].astype(float).std(axis=(0, 1)).max() for view in (far, near))
    assert calm < 0.6 * rough


def test_water_near_land_knows_how_near() -> None:
    water = np.ones((9, 9), np.bool_)
    water[4, 4] = False
    shore = shore_of(water, 4.0)
    column = int((16.0 + 2.0 + 3.0 - shore.west) / shore.texel_m)
    row = int((16.0 - shore.south) / shore.texel_m)
    assert shore.values[row, column] == pytest.approx(3.0, abs=shore.texel_m)
    assert shore.values.max() == SHORE_M


def test_smoothing_softens_stairs_and_leaves_the_rest() -> None:
    flat = np.full((20, 30, 3), 90, np.uint8)
    result = np.empty_like(flat)
    smooth_edges(flat, result)
    np.testing.assert_array_equal(result, flat)
    row, column = np.indices((40, 60))
    stairs = np.where((column // 4 > row)[..., None], 230, 20).astype(np.uint8).repeat(3, axis=2)
    result = np.empty_like(stairs)
    smooth_edges(stairs, result)
    between = (result > 60) & (result < 190)
    assert between.sum() > 60
    assert abs(result.astype(float).mean() - stairs.mean()) < 3.0
    np.testing.assert_array_equal(result[20:, :4], stairs[20:, :4])
