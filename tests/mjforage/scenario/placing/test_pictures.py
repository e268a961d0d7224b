"""Images with two control points."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from mjforage.scenario.placing.pictures import Georeference, Point, control_point
from tests.mjforage.scenario.placing.drawn import LAT, LON, made, on_globe, place_of

SIDE_M = 1.5  # of a pixel


def control(turned_deg: float) -> list[Point]:
    """Two points of an image of 80 x 120 pixels whose upper edge points to a bearing."""
    import shapely

    found: list[Point] = []
    angle = np.radians(turned_deg)
    for row, column in ((5, 10), (70, 100)):
        right, up = (column - 59.5) * SIDE_M, (39.5 - row) * SIDE_M
        east = right * np.cos(angle) + up * np.sin(angle)
        north = up * np.cos(angle) - right * np.sin(angle)
        lon, lat = on_globe(shapely.Point(east, north)).coords[0]
        found.append((row, column, lat, lon))
    return found


def drawn(path: Path, light: str = "white", dark: str = "black") -> Path:
    image = Image.new("RGB", (120, 80), dark)
    image.paste(light, (20, 10, 100, 70))  # 80 x 60 pixels of water
    image.save(path)
    return path


@pytest.mark.parametrize("turned", [0.0, 25.0, -140.0])
def test_pixels_lie_where_the_control_points_say(tmp_path: Path, turned: float) -> None:
    grid = made(drawn(tmp_path / "a.png"), 3.0, rotation_deg=None, points=control(turned))
    place = place_of(grid)
    assert grid.navigable.shape == (40, 60) and grid.nodes == 40 * 30
    assert place.rotation_deg == pytest.approx(turned, abs=1e-3)
    assert (place.latitude_deg, place.longitude_deg) == pytest.approx((LAT, LON), abs=1e-7)
    north_up = made(tmp_path / "a.png", 3.0, points=control(turned))
    assert north_up.nodes == pytest.approx(40 * 30, rel=0.03)


def test_a_control_point_is_where_it_was_said_to_be() -> None:
    known = Georeference(control(33.0), (80, 120))
    np.testing.assert_allclose(known.corners.mean(axis=0), [LON, LAT], atol=1e-8)


def test_water_can_be_dark_or_of_a_colour(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    how = {"points": control(0.0), "rotation_deg": None}
    path = drawn(tmp_path / "dark.png", "black", "white")
    assert made(path, 3.0, water=("dark",), **how).nodes == 40 * 30
    chart = drawn(tmp_path / "chart.png", "#aad3df", "#f2efe9")
    assert made(chart, 3.0, water=("#a8d0e0",), **how).nodes == 40 * 30
    assert not caplog.records  # lightness is not asked for


def test_a_control_point_is_read() -> None:
    assert control_point("12, 340.5=-38.97,-76.48") == (12, 340.5, -38.97, -76.48)
