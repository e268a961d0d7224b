"""A drawn harbour with what real extracts of OpenStreetMap have, in XML and as GeoJSON."""

import itertools
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from mjforage.base.errors import UserError
from mjforage.scenario.maps import GridMap
from tests.mjforage.scenario.placing.drawn import (
    Features,
    box_deg,
    geojson,
    made,
    on_globe,
    osm_pbf,
    osm_xml,
    place_of,
)

HALF = 200.0
BOX = shapely.box(-HALF, -HALF, HALF, HALF)
X = np.arange(-700.0, 701.0, 20.0)
SHORE = np.stack((X, 60.0 + 6.0 * np.sin(X / 37.0) + 3.0 * np.cos(X / 7.0)), axis=1)
COAST = np.concatenate(  # to the east, with the land to its left, and round a basin
    (SHORE[X < -30], [(-20, 60), (-20, 160), (60, 160), (60, 60)], SHORE[X > 70])
)
LAND = shapely.Polygon([*COAST, (700, 900), (-700, 900)])
ISLE = shapely.Point(-120, -80).buffer(25, quad_segs=6).reverse()  # counter-clockwise, both
ROCKS = shapely.box(40, -130, 70, -100).exterior
DOCK = shapely.box(100, 90, 180, 150) - shapely.box(130, 110, 142, 122)
LOCK = shapely.box(110, 40, 122, 95)
QUAY = shapely.box(-10, 60, 0, 100)
RING = shapely.box(-170, 0, -130, 40) - shapely.box(-160, 10, -140, 30)
TWIST = shapely.Polygon([(100, -60), (120, -40), (120, -60), (100, -40)])
MOLE = shapely.LineString([(-100, 70), (-100, -20), (-60, -30)])
PONTOONS = [shapely.LineString([(x, 161), (x, 110)]) for x in (10, 25, 40)]
WATER_TAGS = {"natural": "water", "name": "Østre havn 港"}


def pieces(line: Any, count: int, tags: dict[str, str]) -> Features:
    """A line in so many ways, the last first."""
    cuts = np.linspace(0, len(line) - 1, count + 1).astype(int)
    ways = [shapely.LineString(line[a : b + 1]) for a, b in itertools.pairwise(cuts)]
    return [(one, tags) for one in ways[::-1]]


def features() -> Features:
    coast = {"natural": "coastline"}
    return [
        *pieces(COAST, 7, coast | {"source": ""}),
        (shapely.LineString(ISLE.exterior), coast),
        *pieces(np.array(ROCKS.coords), 2, coast),
        (LAND, {"place": "island", "name": "Ærø"}),
        (shapely.box(-500, -500, 500, 300), {"natural": "bay"}),
        (DOCK, WATER_TAGS),
        (LOCK, {"waterway": "dock"}),
        (LOCK, {"waterway": "dock"}),
        (shapely.box(-50, -150, 0, -100), {"natural": "water"}),
        (QUAY, {"man_made": "pier"}),
        (RING, {"man_made": "pier"}),
        (TWIST, {"man_made": "pier", "area": "yes"}),
        (MOLE, {"man_made": "breakwater"}),
        *((one, {"man_made": "pier", "layer": "1", "width": "2.5 m"}) for one in PONTOONS),
        (shapely.LineString([(-90, 0), (100, 0)]), {"highway": "footway", "bridge": "yes"}),
        (shapely.box(105, 60, 127, 70), {"man_made": "bridge", "layer": "1"}),
        (shapely.box(-25, 90, 65, 165), {"leisure": "marina"}),
        (shapely.LineString([(116, 92), (116, 140)]), {"waterway": "river"}),
    ]


def truth() -> Any:
    """The water that can be sailed from the sea."""
    sea = BOX - LAND - ISLE - shapely.Polygon(ROCKS)
    solid = [QUAY, RING, shapely.make_valid(TWIST), MOLE.buffer(3, cap_style="flat")]
    solid += [one.buffer(1.25, cap_style="flat") for one in PONTOONS]
    water = (sea | DOCK | LOCK) - shapely.union_all(solid)
    parts = shapely.get_parts(water)
    return parts[shapely.area(parts).argmax()]


def wet(grid: GridMap, points: Sequence[tuple[float, float]]) -> list[bool]:
    where = [on_globe(shapely.Point(xy)).coords[0][::-1] for xy in points]
    rows, columns = np.rint(place_of(grid).cells(where)).astype(int).T
    return [bool(one) for one in grid.navigable[rows, columns]]


MISSING = """<relation id="900001"><member type="way" ref="9999" role="outer"/>
<tag k="type" v="multipolygon"/><tag k="natural" v="water"/></relation>"""


@pytest.mark.parametrize("kind", ["whole", "cut", "geojson"])
def test_the_water_of_an_extract_is_that_of_its_shapes(tmp_path: Path, kind: str) -> None:
    """Within 0.5 % at 1 m: ways that leave the box, ways that it cuts, and GeoJSON of the same."""
    if kind == "geojson":
        path = geojson(tmp_path / "harbour.geojson", features())
    else:
        within = BOX.buffer(-15.0) if kind == "cut" else None
        path = osm_xml(tmp_path / "harbour.osm", features(), within, MISSING)
    grid = made(path, pitch_m=1.0, crop=box_deg(HALF))
    assert grid.nodes == pytest.approx(truth().area, rel=0.005)
    places = [(0, 0), (20, 120), (116, 60), (160, 140), (-150, 20), (-120, -80), (136, 116)]
    assert wet(grid, places) == [True] * 4 + [False] * 3
    lines = [line for line in place_of(grid).remarks if "gaps in coastlines" in line]
    assert len(lines) == (kind == "cut")


def coast_of(*lines: Any) -> Features:
    return [(shapely.LineString(line), {"natural": "coastline"}) for line in lines]


@pytest.mark.parametrize(
    ("lines", "area"),
    [
        ([[(-300, 0), (300, 0)]], 200 * 100),  # to the east: land in the north
        ([[(300, 0), (-300, 0)]], 200 * 100),
        ([[(-300, 40), (0, 40)], [(300, -40), (-300, -40)], [(0, 40), (300, 40)]], 200 * 80),
        ([[(-300, 0), (-70, 0)], [(70, 0), (300, 0)]], 200 * 100),  # a way of it is missing
        ([[(-75, 0), (75, 0)]], 200 * 100),  # both ends were cut off
        ([[(300, 0), (-85, 0)], [(-85, 60), (300, 60)]], 200 * 60),  # a channel, cut off
        ([[(0, 0), (0, 50), (50, 50), (50, 0), (0, 0)]], 50 * 50),  # clockwise: a lagoon
        ([[(0, 0), (50, 0), (50, 50), (0, 50), (0, 0)]], 200 * 200 - 50 * 50),
        ([[(0, 0), (50, 0), (50, 50)], [(0, 50), (0, 0)]], 200 * 200 - 50 * 50),
    ],
)
def test_coastlines_in_pieces(tmp_path: Path, lines: Any, area: float) -> None:
    path = osm_xml(tmp_path / "coast.osm", coast_of(*lines))
    grid = made(path, pitch_m=1.0, crop=box_deg(100.0))
    assert grid.nodes == pytest.approx(area, rel=0.01)


def test_a_box_within_a_ring_of_coastline_is_on_one_side_of_it(tmp_path: Path) -> None:
    """The ring is one way that leaves the box out: clockwise around water, the other way land."""
    ring = shapely.box(-300, -300, 300, 300).exterior  # counter-clockwise
    for rings, water_m2 in (
        ([ring.reverse()], 200 * 200),
        ([ring], 0),
        ([ring, shapely.box(-150, -150, 150, 150).exterior.reverse()], 200 * 200),  # on an island
        ([ring.reverse(), shapely.box(-150, -150, 150, 150).exterior], 0),
    ):
        path = osm_xml(tmp_path / "ring.osm", coast_of(*(one.coords for one in rings)))
        if water_m2:
            assert made(path, pitch_m=2.0, crop=box_deg(100.0)).nodes * 4 == water_m2
        else:
            with pytest.raises(UserError, match="has no water there"):
                made(path, pitch_m=2.0, crop=box_deg(100.0))


def test_a_bay_that_is_drawn_over_land_and_a_lake_on_an_island(tmp_path: Path) -> None:
    """A coastline knows better than a bay; without one the bay is water, and a lake on land."""
    bay = (shapely.box(-90, -90, 90, 90), {"natural": "bay"})
    isle = (shapely.box(-50, -50, 50, 50), {"place": "island"})
    lake = (shapely.box(-45, -45, 45, 45), {"natural": "water"})
    coast = coast_of([(-300, 0), (300, 0)])
    for shown, area in (
        ([bay, *coast], 200 * 100),
        ([bay, isle], 180 * 180 - 100 * 100),
        ([bay, isle, lake], 180 * 180 - 100 * 100),  # the lake is not the largest component
        ([isle, lake], 90 * 90),
    ):
        path = osm_xml(tmp_path / "bay.osm", shown)
        grid = made(path, pitch_m=1.0, crop=box_deg(100.0))
        assert grid.nodes == pytest.approx(area, rel=0.01)


def test_an_extract_is_as_large_as_it_says(tmp_path: Path) -> None:
    """Ways leave it, and without a crop its bounds are the crop."""
    west, south, east, north = box_deg(100.0)
    bounds = f'<bounds minlat="{south}" minlon="{west}" maxlat="{north}" maxlon="{east}"/>'
    path = osm_xml(tmp_path / "bay.osm", coast_of([(-3000, 0), (3000, 0)]))
    text = path.read_text()
    path.write_text(text.replace("<node", bounds + "<node", 1))
    grid = made(path)
    assert grid.navigable.shape == (50, 50) and grid.nodes == 50 * 25
    (line,) = [one for one in place_of(made(path, rotation_deg=30.0)).remarks if "crop:" in one]
    assert "holds all of the crop's 200 x 200 m" in line


def test_files_of_editors_have_numbers_below_0(tmp_path: Path) -> None:
    path = osm_xml(tmp_path / "bay.osm", coast_of([(-300, 0), (300, 0)]))
    text = path.read_text().replace('id="', 'id="-').replace('ref="', 'ref="-')
    path.write_text(text)
    assert made(path, crop=box_deg(100.0)).nodes == 50 * 25


LAKE = {"type": "multipolygon", "natural": "water"}
RELATIONS: dict[int, Any] = {  # of their members, ways 1 and 2 are in the file
    900: ({1: "outer", 77: "inner"}, LAKE),
    901: ({300: "outer", 2: "outer"}, LAKE | {"natural": "wood"}),
    902: ({78: "outer"}, {"type": "boundary", "boundary": "administrative"}),
    903: ({1: "outer", 79: "subarea"}, LAKE | {"name": "whole"}),
    904: ({80: "outer"}, {"type": "route", "natural": "water"}),
    905: ({2: "outer", 81: "outer"}, {"type": "multipolygon", "man_made": "pier"}),
}


def extract_of(path: Path, ways: Features, relations: dict[int, Any]) -> Path:
    """A file of ways with the numbers from 1, and relations."""
    if path.suffix == ".pbf":
        return osm_pbf(path, ways, relations)
    xml = ""
    for k, (members, tags) in relations.items():
        inside = [f'<member type="way" ref="{i}" role="{role}"/>' for i, role in members.items()]
        inside += [f'<tag k="{key}" v="{value}"/>' for key, value in tags.items()]
        xml += f'<relation id="{k}" version="1">{"".join(inside)}</relation>'
    text = osm_xml(path, ways, None, xml).read_text()
    for way, number in enumerate(re.findall(r'<way id="(\d+)"', text), 1):
        text = text.replace(f'<way id="{number}"', f'<way id="{way}"')
    path.write_text(text)
    return path


@pytest.mark.parametrize("name", ["bay.osm", "bay.osm.pbf"])
def test_areas_that_an_extract_has_not_all_of_are_told(tmp_path: Path, name: str) -> None:
    """GDAL leaves them out. Boundaries, forests, whole areas and routes are no news."""
    ways = [
        (shapely.box(-90, -90, 90, 90), {"natural": "water"}),
        (shapely.box(-10, -10, 10, 10), {"man_made": "pier"}),
    ]
    grid = made(extract_of(tmp_path / name, ways, RELATIONS), pitch_m=2.0)
    lines = [line for line in place_of(grid).remarks if "osmium" in line]
    assert lines == [
        "areas that may be missing: 2 (relation 900, natural=water; relation 905, man_made=pier); "
        "the extract lacks ways of their outlines; cut it with osmium extract --strategy smart"
    ]
    whole = made(extract_of(tmp_path / name, ways, {903: RELATIONS[903]}), pitch_m=2.0)
    assert not [line for line in place_of(whole).remarks if "osmium" in line]
    chosen = made(extract_of(tmp_path / name, ways, RELATIONS), land=("natural=wood", "man_made"))
    (line,) = [line for line in place_of(chosen).remarks if "osmium" in line]
    assert "missing: 3 (" in line and "relation 901, natural=wood" in line
    road = extract_of(tmp_path / name, [(ways[0][0], {"highway": "path"})], {900: RELATIONS[900]})
    with pytest.raises(
        UserError, match=r"known as water .*; areas that may be missing: 1 \(relation 900"
    ):
        made(road)
