"""Places made of outlines: what is water, where it lies, and what is told of it."""

import math
from pathlib import Path

import numpy as np
import pytest
import shapely

from mjforage.scenario.maps import GridMap
from tests.mjforage.scenario.placing.drawn import (
    LAT,
    LON,
    box_deg,
    geojson,
    made,
    on_globe,
    osm_pbf,
    place_of,
    written,
)

BASIN = shapely.box(-100, -60, 100, 60)
PIER = shapely.LineString([(0, -60), (0, 20)])
BAY = shapely.Point(0, 0).buffer(150, quad_segs=40).difference(shapely.Point(40, 60).buffer(30))


def told(grid: GridMap, words: str) -> list[str]:
    return [line for line in place_of(grid).remarks if words in line]


def test_a_basin_is_as_large_as_it_was_drawn(tmp_path: Path) -> None:
    grid = made(geojson(tmp_path / "basin.geojson", [(BASIN, {"natural": "water"})]))
    assert grid.navigable.shape == (32, 52)
    assert grid.navigable[1:-1, 1:-1].all() and grid.nodes == 30 * 50
    place = place_of(grid)
    assert (place.latitude_deg, place.longitude_deg) == pytest.approx((LAT, LON), abs=1e-7)
    corner = on_globe(shapely.Point(-98, 58)).coords[0][::-1]  # the middle of cell 1, 1
    np.testing.assert_allclose(place.latlon([1, 1]), corner, atol=1e-8)
    assert not told(grid, "open at its")


def test_a_map_that_is_open_at_its_border_says_where(tmp_path: Path) -> None:
    path = geojson(tmp_path / "basin.geojson", [(BASIN, {})])
    grid = made(path, crop=box_deg(80.0))
    assert grid.navigable.shape == (40, 40) and grid.nodes == 30 * 40
    lines = told(grid, "open at its")
    assert len(lines) == 2
    west = place_of(grid).latlon([[5, 0], [34, 0]])
    (first, last) = (f"{one[0]:.5f}N {-one[1]:.5f}W" for one in west)
    assert f"open at its left border, rows 5 to 34: from {first} to {last}" in lines


@pytest.mark.parametrize("rotation", [0.0, 17.0])
def test_the_area_is_that_of_the_polygons(tmp_path: Path, rotation: float) -> None:
    """Within 0.5 % at 1 m."""
    grid = made(geojson(tmp_path / "bay.geojson", [(BAY, {})]), pitch_m=1.0, rotation_deg=rotation)
    assert grid.nodes == pytest.approx(BAY.area, rel=0.005)


@pytest.mark.parametrize("name", ["bay.gpkg", "bay.shp"])
@pytest.mark.parametrize("crs", ["EPSG:4326", "EPSG:3857", "EPSG:32630"])
def test_other_projections_are_the_same_place(tmp_path: Path, name: str, crs: str) -> None:
    """Web Mercator would make it 1.5 times as large at this latitude."""
    features = [(BAY, {"natural": "water"}), (PIER, {"natural": ""})][:1]
    grid = made(written(tmp_path / name, features, crs, geometry_type="Polygon"), pitch_m=2.0)
    same = made(geojson(tmp_path / "bay.geojson", features), pitch_m=2.0)
    assert np.array_equal(grid.navigable, same.navigable)
    assert grid.nodes * 4.0 == pytest.approx(BAY.area, rel=0.01)
    assert 1.0 / math.cos(math.radians(LAT)) ** 2 > 1.5


def test_a_pier_is_as_wide_as_its_kind_or_as_given(tmp_path: Path) -> None:
    features = [(BASIN, {"natural": "water"}), (PIER, {"man_made": "breakwater"})]
    path = geojson(tmp_path / "pier.geojson", features)
    usual, wide = made(path, 1.0), made(path, 1.0, pier_width_m=10.0)
    assert 200 * 120 - usual.nodes == pytest.approx(6 * 80, abs=1)
    assert 200 * 120 - wide.nodes == pytest.approx(10 * 80, abs=1)
    assert told(usual, "1 lines of breakwater taken as 6 m wide")
    own = [(BASIN, {"natural": "water"}), (PIER, {"man_made": "pier", "width": "4 m"})]
    narrow = made(geojson(tmp_path / "own.geojson", own), 1.0)
    assert 200 * 120 - narrow.nodes == pytest.approx(4 * 80, abs=1)


def test_a_pontoon_thinner_than_a_cell_still_is_a_barrier(tmp_path: Path) -> None:
    across = shapely.LineString([(1.3, -60), (-1.7, 52)])  # 1 m of 4, slanted
    features = [(BASIN, {"natural": "water"}), (across, {"man_made": "pier"})]
    grid = made(geojson(tmp_path / "pontoon.geojson", features), pier_width_m=1.0)
    middle = grid.navigable[3:, 24:28]
    assert not middle.all(axis=1).any()
    assert grid.navigable[1:3, 1:-1].all() and grid.navigable[1:-1, 1:23].all()


def test_filters_take_the_place_of_the_usual_tags(tmp_path: Path) -> None:
    hole = shapely.box(-20, -20, 20, 20)
    features = [(BASIN, {"use": "dock"}), (hole, {"use": "raft"}), (PIER, {"man_made": "pier"})]
    path = geojson(tmp_path / "own.geojson", features)
    grid = made(path, water=("use=dock",), land=("use=raft",))
    assert grid.nodes == 30 * 50 - 10 * 10
    assert told(grid, "left out: 1 own (line)")


def test_land_alone_leaves_the_rest_of_the_crop(tmp_path: Path) -> None:
    features = [(shapely.box(-300, -300, -20, 300), {"kind": "shore"})]
    path = geojson(tmp_path / "land.geojson", features)
    grid = made(path, land=("kind=shore",), crop=box_deg(100.0))
    assert grid.nodes == 50 * 30
    assert told(grid, "all that is not land taken for water")


def test_two_basins_whose_channel_is_closed(tmp_path: Path) -> None:
    """The larger one stays; the channel is named with its place and its width."""
    west, east = shapely.box(-100, -50, -10, 50), shapely.box(20, -50, 90, 50)
    channel = shapely.box(-10, 0.45, 20, 3.55)
    path = geojson(tmp_path / "two.geojson", [(west | east | channel, {})])
    grid = made(path)
    assert grid.nodes == pytest.approx(90 * 100 / 16, rel=0.04)
    (line,) = told(grid, "the channel at")
    assert "is 3.1 m wide and closed at pitch 4" in line
    where = line.removeprefix("the channel at ").split(" is ")[0]
    north, west_of = (float(part[:-1]) for part in where.split())
    assert north == pytest.approx(LAT, abs=3e-5) and -west_of == pytest.approx(LON, abs=2e-4)
    assert not told(made(path, pitch_m=2.0), "the channel at")


def test_an_open_creek_is_no_closed_channel(tmp_path: Path) -> None:
    shape = shapely.box(-100, -50, 100, 0) | shapely.box(-6, 0, 6, 60)
    assert not told(made(geojson(tmp_path / "creek.geojson", [(shape, {})])), "the channel")


def test_auto_rotation_lies_along_the_quays(tmp_path: Path) -> None:
    turned = shapely.affinity.rotate(BASIN, -20.0, origin=(0, 0))  # clockwise
    grid = made(geojson(tmp_path / "turned.geojson", [(turned, {})]), rotation_deg=None)
    assert place_of(grid).rotation_deg == pytest.approx(20.0, abs=0.01)
    assert grid.nodes == pytest.approx(30 * 50, abs=80)
    assert grid.navigable[2:-2, 2:-2].all()


def test_a_crop_that_a_rotated_grid_reaches_beyond_is_told(tmp_path: Path) -> None:
    path = geojson(tmp_path / "basin.geojson", [(BASIN, {})])
    (line,) = told(made(path, crop=box_deg(40.0), rotation_deg=30.0), "crop: the grid")
    assert line == (
        "crop: the grid, turned by 30 degrees, is 112 x 112 m and holds all of the crop's 80 x 80 m"
        " and what is beside it"
    )
    for more in ({"rotation_deg": 90.0}, {"rotation_deg": 0.0}):
        assert not told(made(path, crop=box_deg(40.0), **more), "crop: the grid")
    assert not told(made(path, rotation_deg=30.0), "crop: the grid")


COAST = shapely.LineString([(-300, 30), (40, 30), (40, -10), (300, -10)])  # land to the left
ISLAND = shapely.LinearRing([(-60, -60), (-40, -60), (-40, -40), (-60, -40)])  # counter-clockwise
OSM = [
    (COAST, {"natural": "coastline"}),
    (shapely.LineString(ISLAND), {"natural": "coastline"}),
    (shapely.LineString([(0, 30), (0, -30)]), {"man_made": "pier", "width": "4"}),
    (shapely.LineString([(60, 40), (80, 60)]), {"highway": "service"}),
]


def test_an_extract_of_openstreetmap(tmp_path: Path) -> None:
    """Coastlines have the land to their left, closed ones are islands, piers are lines."""
    path = osm_pbf(tmp_path / "harbour.osm.pbf", OSM)
    grid = made(path, pitch_m=2.0, crop=box_deg(100.0))
    water = (200 * 90 + 140 * 40) - 20 * 20 - 4 * 60
    assert grid.nodes * 4 == pytest.approx(water, rel=0.005)
    place = place_of(grid)
    rows, columns = (
        np.rint(place.cells([on_globe(shapely.Point(xy)).coords[0][::-1] for xy in WET + DRY]))
        .astype(int)
        .T
    )
    assert grid.navigable[rows, columns].tolist() == [True] * len(WET) + [False] * len(DRY)
    assert "ODbL" in place.licence
    assert told(grid, "1 lines of pier taken as 4 m wide")
    assert told(grid, "left out: 1 lines (line)")


WET = [(-90, 20), (90, -20), (-50, -70), (10, 0)]
DRY = [(-90, 50), (90, 0), (-50, -50), (0, 0)]


def test_coastlines_of_both_senses_are_told(tmp_path: Path) -> None:
    lines = [[(-300, 0), (300, 0)], [(-300, 40), (300, 40)]]
    coast = [(shapely.LineString(line), {"natural": "coastline"}) for line in lines]
    path = osm_pbf(tmp_path / "torn.osm.pbf", coast)
    assert told(made(path, crop=box_deg(100.0)), "coastlines of both senses")
