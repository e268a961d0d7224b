import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.scenario.maps import load_map
from mjforage.view.render import harbour, textures
from mjforage.view.render.harbour import BEYOND, PaddedLand, Shape
from mjforage.view.render.sheds import shed_boxes, shed_shape

PITCH = 4.0
PORT = load_map("comb_port").navigable


def area(shape: Shape) -> NDArray[np.float64]:
    """(face,) areas."""
    return np.asarray(0.5 * np.linalg.norm(normals(shape), axis=1), np.float64)


def normals(shape: Shape) -> NDArray[np.float64]:
    """(face, 3) outward, as long as the parallelogram."""
    a, b, c = (shape.vertices[shape.faces[:, k]] for k in range(3))
    return np.asarray(np.cross(b - a, c - a), np.float64)


@pytest.fixture(scope="module")
def island() -> PaddedLand:
    """One cell of land in the middle of a lake."""
    water = np.ones((5, 7), np.bool_)
    water[2, 3] = False
    return PaddedLand.of(water, PITCH)


def test_an_island_has_four_sides_with_water_on_the_right_hand(island: PaddedLand) -> None:
    ends, sides = harbour.shoreline(island)
    assert sorted(sides.tolist()) == [0, 1, 2, 3]
    centre = np.array([12.0, 8.0])
    along = ends[:, 1] - ends[:, 0]
    out = ends.mean(axis=1) - centre
    np.testing.assert_allclose(np.linalg.norm(out, axis=1), 2.0)
    right = np.column_stack((along[:, 1], -along[:, 0])) / PITCH
    np.testing.assert_allclose(right, out / 2.0)


def test_walls_face_the_water_and_tops_the_sky(island: PaddedLand) -> None:
    ends, _ = harbour.shoreline(island)
    wall = harbour.walls(ends, 4.0)
    middle = wall.vertices[wall.faces].mean(axis=1)[:, :2] - (12.0, 8.0)
    assert ((normals(wall)[:, :2] * middle).sum(axis=1) > 0.0).all()
    assert area(wall).sum() == pytest.approx(16.0 * (harbour.KERB_TOP_M - harbour.WALL_BOTTOM_M))
    top = harbour.tops(island, island.land, 4.0)
    assert (normals(top)[:, 2] > 0.0).all()
    assert area(top).sum() == pytest.approx(16.0)


def test_tops_lie_where_the_map_has_land() -> None:
    ground = PaddedLand.of(PORT, PITCH)
    pier, lawn = harbour.piers(ground), harbour.inland(ground)
    assert not (pier & ~ground.land).any()
    assert not (pier & lawn).any()
    rows, columns = PORT.shape
    top = harbour.tops(ground, ground.land, 4.0)
    assert area(top).sum() == pytest.approx(ground.land.sum() * PITCH**2)
    for row, column in np.ndindex(rows, columns):
        assert ground.land[row + BEYOND, column + BEYOND] != PORT[row, column]
    x, y = ground.x(np.array(BEYOND)), ground.y(np.array(BEYOND))
    assert (float(x), float(y)) == (-0.5 * PITCH, (rows - 0.5) * PITCH)


def test_kerbs_and_bollards_stand_on_land() -> None:
    ground = PaddedLand.of(PORT, PITCH)
    ends, _ = harbour.shoreline(ground)
    kerb = harbour.kerbs(ground, ends, 2.0)
    corners = kerb.vertices[kerb.faces].mean(axis=1)[:, :2]
    for places in (harbour.bollard_places(ends), corners):
        column = np.floor(places[:, 0] / PITCH + 0.5 + BEYOND + 1e-9).astype(np.int64)
        row = np.floor(ground.rows - 0.5 - places[:, 1] / PITCH + BEYOND + 1e-9).astype(np.int64)
        assert ground.is_land(row, column).mean() > 0.99


def test_sheds_keep_away_from_the_water() -> None:
    ground = PaddedLand.of(PORT, PITCH)
    boxes = shed_boxes(ground)
    assert len(boxes) > 10
    for west, south, east, north, _ in boxes.tolist():
        for x, y in ((west, south), (west, north), (east, south), (east, north)):
            column, row = round(x / PITCH), round(ground.rows - 1 - y / PITCH)
            if 0 <= row < PORT.shape[0] and 0 <= column < PORT.shape[1]:
                assert not PORT[row, column]
    shape = shed_shape(boxes, 4)
    walls = shape.uv[shape.faces[:, 0], 1] < 0.5
    up = normals(shape)[:, 2] / np.maximum(np.linalg.norm(normals(shape), axis=1), 1e-9)
    np.testing.assert_allclose(up[walls], 0.0, atol=1e-9)
    assert (up[~walls] > 0.5).all()


def test_buoys_mark_water_at_the_edge_of_the_map() -> None:
    assert len(harbour.buoy_places(np.zeros((4, 4), np.bool_), PITCH)) == 0
    places = harbour.buoy_places(np.ones((4, 6), np.bool_), PITCH)
    on_side = (places[:, 0] == -2.0) | (places[:, 0] == 22.0)
    on_end = (places[:, 1] == -2.0) | (places[:, 1] == 14.0)
    assert (on_side | on_end).all()
    assert len(places) == 2 * 3 + 2 * 2


def test_a_post_is_round_and_closed_above() -> None:
    post = harbour.posts(np.array([[3.0, 4.0]]), harbour.BOLLARD, (0.5, 0.5))
    radius = np.hypot(post.vertices[:, 0] - 3.0, post.vertices[:, 1] - 4.0)
    assert radius.max() == pytest.approx(0.2)
    assert radius[post.vertices[:, 2] == post.vertices[:, 2].max()].max() == 0.0


def test_textures_tile_and_stay_the_same() -> None:
    for make in (textures.planks, textures.concrete, textures.coping, textures.lawn, textures.wall):
        first = make()
        np.testing.assert_array_equal(first, make())
        assert first.dtype == np.uint8
        steps = np.abs(first.astype(int) - np.roll(first, 1, axis=1)).mean(axis=(0, 2))
        assert steps[0] <= steps[1:].max() + 1.0
