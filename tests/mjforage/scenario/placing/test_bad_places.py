"""Malformed inputs: each gets one line that names the thing, the value and the remedy."""

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from PIL import Image

import mjforage as mf
from mjforage.scenario.scenario_file import load_scenario
from tests.mjforage.scenario.placing.drawn import geojson, osm_pbf, written

BASIN = shapely.box(-100, -60, 100, 60)
WATER = [(BASIN, {"natural": "water"})]
TWO = ("2,3=36,-5.6", "70,100=35.999,-5.599")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Files, good and bad."""
    place = tmp_path_factory.mktemp("files")
    good = geojson(place / "good.geojson", WATER).read_text()
    (place / "cut.geojson").write_text(good[: len(good) // 2])
    (place / "none.geojson").write_text('{"type": "FeatureCollection", "features": []}')
    (place / "empty.geojson").write_text("")
    (place / "words.txt").write_text("no chart")
    (place / "cell.000").write_bytes(b"\0" * 500)
    (place / "harbour.osm.pbf").write_bytes(b"\0\0\0\rOSMHeader" + b"\1" * 90)
    (place / "part.osm.pbf").write_bytes(osm_pbf(place / "p.osm.pbf", WATER).read_bytes()[:100])
    geojson(place / "points.geojson", [(shapely.Point(0, 0), {"natural": "water"})])
    geojson(place / "lines.geojson", [(shapely.LineString([(0, 0), (9, 9)]), {"kind": "path"})])
    geojson(place / "thin.geojson", [(shapely.box(0, 0, 100, 1), {})])
    geojson(place / "land.geojson", [*WATER, (BASIN.buffer(9), {"man_made": "pier"})])
    tree = json.loads(good)
    tree["features"][0]["geometry"]["coordinates"] = [[[9, 4e6], [1, 4e6], [2, 5e6], [9, 4e6]]]
    (place / "metres.geojson").write_text(json.dumps(tree))
    geojson(place / "globe.geojson", [(shapely.box(-4e6, -2e6, 4e6, 2e6), {})])
    written(place / "nowhere.shp", WATER, geometry_type="Polygon")
    (place / "nowhere.prj").unlink()
    Image.new("RGB", (120, 80), "#aad3df").save(place / "blue.png")
    (place / "bad.png").write_bytes(b"\x89PNG no")
    return place


Case = tuple[str, dict[str, Any], str]
CASES: list[Case] = [
    ("missing.geojson", {}, "no such file"),
    (".", {}, "no such file"),
    ("cut.geojson", {}, "cannot be read"),
    ("none.geojson", {}, "has no features"),
    ("empty.geojson", {}, "cannot be read"),
    ("words.txt", {}, "give GeoJSON, GeoPackage"),
    ("cell.000", {}, "cannot be read"),
    ("harbour.osm.pbf", {}, "harbour.osm.pbf"),
    ("part.osm.pbf", {}, "part.osm.pbf"),
    ("points.geojson", {}, "no polygon"),
    ("lines.geojson", {}, "--water KEY=VALUE or --land KEY=VALUE, with layer, kind"),
    ("thin.geojson", {"pitch_m": 8.0}, "give a smaller --pitch or --share"),
    ("land.geojson", {}, "has no water there"),
    ("metres.geojson", {}, "on no globe"),
    ("globe.geojson", {}, "are more than 40,000,000"),
    ("nowhere.shp", {}, "has no coordinate system; add its .prj"),
    ("good.geojson", {"pitch_m": 0.0}, "pitch_m = 0.0: give a finite number above 0"),
    ("good.geojson", {"pitch_m": float("nan")}, "pitch_m = nan"),
    ("good.geojson", {"pitch_m": 1e-4}, "are more than 40,000,000"),
    ("good.geojson", {"share": 0.0}, "share = 0.0"),
    ("good.geojson", {"share": 1.5}, "share = 1.5: give at most 1"),
    ("good.geojson", {"rotate": "left"}, "rotate 'left'"),
    ("good.geojson", {"rotate": 400.0}, "rotate = 400: give at most 360"),
    ("good.geojson", {"pier_width_m": -1.0}, "pier_width_m = -1.0"),
    ("good.geojson", {"pier_width_m": 2000.0}, "give at most 1000"),
    ("good.geojson", {"min_depth_m": 2.0}, "has a depth (DRVAL1)"),
    ("good.geojson", {"crop": (1.0, 2.0, 3.0)}, "give west, south, east and north"),
    ("good.geojson", {"crop": (-5.5, 36.0, -5.7, 36.1)}, "give west < east"),
    ("good.geojson", {"crop": (-5.7, 36.0, -5.5, 96.0)}, "within 89 degrees"),
    ("good.geojson", {"crop": (-5.7, float("inf"), -5.5, 36.0)}, "crop = inf"),
    ("good.geojson", {"crop": (10.0, 50.0, 10.1, 50.1)}, "has no features in the crop"),
    ("good.geojson", {"water": "naturl=water"}, "did you mean natural?"),
    ("good.geojson", {"water": "natural=watre"}, "did you mean water?"),
    ("good.geojson", {"land": ("=pier",)}, "--land '=pier': give KEY=VALUE"),
    ("good.geojson", {"land": ("man_made=",)}, "--land 'man_made=': give KEY=VALUE"),
    ("good.geojson", {"points": TWO}, "is no image; leave out --point (2 given)"),
    ("blue.png", {}, "needs --point ROW,COL=LAT,LON twice (0 given)"),
    ("blue.png", {"points": TWO[:1]}, "(1 given)"),
    ("blue.png", {"points": ("1,2,3=4", TWO[1])}, "--point '1,2,3=4': give ROW,COL=LAT,LON"),
    ("blue.png", {"points": ("1,x=36,5", TWO[1])}, "--point '1,x=36,5'"),
    ("blue.png", {"points": ("1,2=95,5", TWO[1])}, "--point '1,2=95,5'"),
    ("blue.png", {"points": (TWO[0], TWO[0]), "water": "light"}, "0 pixels and 0 m apart"),
    ("blue.png", {"points": TWO, "water": "#00ff00"}, "no pixel is near it; there are #aad3df"),
    ("blue.png", {"points": TWO}, "100 % of its pixels are coloured; say by --water which"),
    ("blue.png", {"points": TWO, "water": "blue"}, "give light, dark, or a colour: #aad3df"),
    ("blue.png", {"points": TWO, "land": "natural"}, "leave out --land"),
    ("blue.png", {"points": TWO, "water": "dark"}, "no cell of 4 m has 0.6 of it"),
    ("bad.png", {"points": TWO}, "map bad.png"),
]


def one_line(call: Callable[[], object], words: str) -> None:
    with pytest.raises(mf.UserError) as caught:
        call()
    text = str(caught.value)
    assert words in text and "\n" not in text, text


@pytest.mark.parametrize(("name", "arguments", "words"), CASES)
def test_what_no_place_is_made_of(
    folder: Path, tmp_path: Path, name: str, arguments: dict[str, Any], words: str
) -> None:
    one_line(lambda: mf.Map.of_chart(folder / name, tmp_path / "out", **arguments), words)
    assert not (tmp_path / "out").exists()


PLACES = {
    "no key": (r"pitch_m = .*\n", "", "missing pitch_m"),
    "word": (r"rows = 32", 'rows = "x"', "rows = 'x'"),
    "unknown": (r"share =", "shore =", "unknown key shore; did you mean share?"),
    "pole": (r"latitude_deg = .*", "latitude_deg = 90.0", "latitude_deg = 90.0"),
    "mercator": (r"azimuthal equidistant", "mercator", "projection = 'mercator'"),
    "size": (r"rows = 32", "rows = 33", "has 33 rows and 52 columns, harbour.csv beside it 32"),
    "no toml": (r"share =", "share = =", "not readable as TOML"),
}


@pytest.mark.parametrize("name", PLACES)
def test_a_spoilt_place_is_refused(folder: Path, tmp_path: Path, name: str) -> None:
    mf.Map.of_chart(folder / "good.geojson", tmp_path / "place")
    pattern, by, words = PLACES[name]
    file = tmp_path / "place" / "place.toml"
    file.write_text(re.sub(pattern, by, file.read_text()))
    one_line(lambda: mf.Map(tmp_path / "place"), words)


@pytest.mark.parametrize("text", ["", "{}", '{"features": []}', '{"features": [{"geometry": 1}]}'])
def test_spoilt_quays_are_refused(folder: Path, tmp_path: Path, text: str) -> None:
    mf.Map.of_chart(folder / "good.geojson", tmp_path / "place")
    (tmp_path / "place" / "quays.geojson").write_text(text)
    one_line(lambda: mf.Map(tmp_path / "place"), "not lines of x, y")


def test_a_scenario_that_does_not_fit_its_place_is_refused(folder: Path, tmp_path: Path) -> None:
    made = mf.Map.of_chart(folder / "good.geojson", tmp_path / "place")
    assert made.place is not None
    here = made.place.latlon([[1, 1], [200, 1]]).tolist()
    (tmp_path / "none").mkdir()

    def scenario(**keys: Any) -> object:
        return mf.load_scenario("open-bay", map={"file": str(tmp_path / "place")} | keys)

    found = scenario(starts_latlon=here[:1], starts=None)
    assert isinstance(found, mf.Scenario) and found.map.starts == ((1, 1),)
    one_line(lambda: scenario(pitch_m=3.0), "leave it out, or make the place at that pitch")
    one_line(lambda: scenario(starts_latlon=here, starts=None), "is outside in map place")
    one_line(lambda: scenario(starts_latlon=here[:1] * 2, starts=None), "in the node of another")
    one_line(lambda: scenario(starts_latlon=here[:1], starts=[[1, 1]]), "give one of them")
    one_line(lambda: scenario(starts_latlon=[[95.0, 0.0]]), "starts_latlon[0][0] = 95.0")
    one_line(lambda: load_scenario("open-bay", ['map.starts_latlon=["x"]']), "starts_latlon[0]")
    one_line(
        lambda: mf.load_scenario("open-bay", map={"starts_latlon": here[:1], "starts": None}),
        "has no latitude and longitude",
    )
    one_line(lambda: mf.Map(tmp_path / "none"), "neither a shipped map nor a file")
    water = np.ones((4, 4), bool)
    assert mf.Map(water).place is None
