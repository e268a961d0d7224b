import numpy as np
import pytest

from mjforage.view.render.raster import (
    paint_box,
    paint_discs,
    paint_polygon,
    paint_rings,
    paint_stroke,
)
from mjforage.view.render.text import fit, width

WHITE = (255.0, 255.0, 255.0)


def black() -> np.ndarray[tuple[int, int, int], np.dtype[np.uint8]]:
    return np.zeros((60, 80, 3), np.uint8)


def area(image: np.ndarray[tuple[int, int, int], np.dtype[np.uint8]]) -> float:
    return float(image[..., 0].sum() / 255.0)


def test_areas_are_those_of_the_shapes() -> None:
    """Anti-aliasing keeps areas: disc, ring, square, box and a straight stroke with round ends."""
    one, at = np.ones(1), np.array([[40.3, 30.7]])
    disc, ring, polygon, box, stroke = (black() for _ in range(5))
    paint_discs(disc, at, 20 * one, one, WHITE)
    paint_rings(ring, at, 20 * one, 4 * one, one, WHITE)
    square = np.array([[10.5, 10.5], [30.5, 10.5], [30.5, 30.5], [10.5, 30.5]])
    paint_polygon(polygon, square, 0.0, 1.0, 1.0, WHITE)
    paint_box(box, (10.5, 10.5, 50.5, 30.5), 0.0, 0.0, 1.0, WHITE)
    line = np.array([[20.0, 30.0], [60.0, 30.0]])
    paint_stroke(stroke, line, np.full(2, 6.0), np.ones(2), WHITE)
    assert area(disc) == pytest.approx(np.pi * 400, rel=0.01)
    assert area(ring) == pytest.approx(2 * np.pi * 20 * 4, rel=0.01)
    assert area(polygon) == pytest.approx(400, rel=0.01)
    assert area(box) == pytest.approx(800, rel=0.01)
    assert area(stroke) == pytest.approx(40 * 6 + np.pi * 9, rel=0.01)


def test_alpha_blends_and_crossings_do_not_darken() -> None:
    image = black()
    points = np.array([[10.0, 30.0], [70.0, 30.0], [40.0, 10.0], [40.0, 50.0]])
    paint_stroke(image, points, np.full(4, 8.0), np.full(4, 0.5), WHITE)
    assert set(np.unique(image[28:32, 20:60])) == {128}


def test_shapes_beyond_the_edge_are_cut_off() -> None:
    image = black()
    far = np.array([[-5.0, 30.0], [500.0, 500.0], [80.0, 60.0]])
    paint_discs(image, far, np.full(3, 10.0), np.ones(3), WHITE)
    outside = np.array([[-50.0, -50.0], [-40.0, -50.0], [-45.0, -40.0]])
    paint_polygon(image, outside, 0.0, 1.0, 1.0, WHITE)
    paint_stroke(image, outside, np.full(3, 3.0), np.ones(3), WHITE)
    assert image[30, 0, 0] == 255
    assert image[30, 20:60].max() == 0


def test_text_is_shortened_to_its_room() -> None:
    name = "a-policy-with-a-very-long-name"
    assert fit(name, 20, 1000.0) == name
    short = fit(name, 20, 120.0)
    assert short.endswith("…")
    assert 0 < width(short, 20) <= 120
