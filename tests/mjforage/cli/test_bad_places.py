"""Generated damage to charts, places, records and estimates: one clear line, or none needed."""

import shutil
from pathlib import Path

import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from tests.mjforage.cli.spoiling import SHORT, numbers, outcome, some, spoilt, texts
from tests.mjforage.forcing.test_malformed_records import BAD_GRIDS, BAD_TEXT
from tests.mjforage.forcing.test_records import STEADY, grid, saved, write
from tests.mjforage.scenario.placing.drawn import geojson, osm_pbf, osm_xml, written
from tests.mjforage.scenario.placing.test_bad_places import CASES, PLACES

pytestmark = pytest.mark.usefixtures("place")
FEATURES = [
    (shapely.box(-60, -40, 60, 40), {"natural": "water", "depth": "3.5"}),
    (shapely.box(-10, -40, 0, 10), {"man_made": "pier", "depth": ""}),
]
COAST = [(shapely.LineString([(-90, 0), (90, 5)]), {"natural": "coastline"}), *FEATURES]
SMALL = ("--pitch", "5", "--out", "made")


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Charts, records, and a place."""
    folder = tmp_path_factory.mktemp("whole")
    geojson(folder / "a.geojson", FEATURES)
    written(folder / "a.gpkg", FEATURES, geometry_type="Polygon")
    written(folder / "a.shp", FEATURES, geometry_type="Polygon")
    lake = ({1: "outer", 9: "inner"}, {"type": "multipolygon", "natural": "water"})
    osm_pbf(folder / "a.osm.pbf", COAST, {90: lake})
    osm_xml(folder / "a.osm", COAST)
    Image.new("RGB", (20, 12), "#aad3df").save(folder / "a.png")
    Path(write(folder, STEADY)).rename(folder / "a.csv")
    text = "#YY MM DD hh mm WDIR WSPD GST\n"
    rows = [f"2024 06 01 {hour:02} 00 270 5.0 7.0" for hour in range(9)]
    (folder / "a.txt").write_text(text + "\n".join(rows))
    Path(saved(folder, grid())).rename(folder / "a.nc")
    assert outcome("place", folder / "a.geojson", "--pitch", "4", "--out", folder / "place") == ""
    return folder


@some
@given(data=st.data())
def test_charts(data: st.DataObject, files: Path) -> None:
    name = data.draw(st.sampled_from(["geojson", "gpkg", "shp", "osm.pbf", "osm", "png"]))
    for path in files.glob("a.*"):
        shutil.copy(path, path.name)
    Path(f"a.{name}").write_bytes(spoilt((files / f"a.{name}").read_bytes(), data.draw))
    points = ("--point", "0,0=36,-5.6", "--point", "11,19=35.999,-5.599", "--water", "light")
    outcome("place", f"a.{name}", *SMALL, *(points if name == "png" else ()))
    shutil.rmtree("made", ignore_errors=True)


FLAGS = ("pitch", "crop", "rotate", "water", "land", "share", "pier-width", "min-depth", "licence")
odd = st.one_of(numbers.map(str), texts, st.sampled_from(["1,2,3,4", "nan", "auto", "=", "a=b"]))
crops = st.tuples(numbers, numbers, numbers, numbers).map(lambda four: ",".join(map(str, four)))


@some
@given(data=st.data())
def test_flags_of_places(data: st.DataObject, files: Path) -> None:
    flag = data.draw(st.sampled_from([*FLAGS, "point"]))
    value = data.draw(crops | odd if flag == "crop" else odd)
    name = data.draw(st.sampled_from(["geojson", "osm.pbf", "png"]))
    outcome("place", files / f"a.{name}", *SMALL, f"--{flag}={value}", *(["--point", value] * 2))
    outcome("place", files / "a.geojson", "--out", "made", f"--{flag}={value}")
    shutil.rmtree("made", ignore_errors=True)


@some
@given(data=st.data())
def test_places(data: st.DataObject, files: Path) -> None:
    shutil.rmtree("made", ignore_errors=True)
    shutil.copytree(files / "place", "made")
    path = data.draw(st.sampled_from(sorted(Path("made").iterdir())))
    path.write_bytes(spoilt(path.read_bytes(), data.draw))
    outcome("maps", "made")
    draught = ("--set", "team.foragers.draught_m=0.5")
    outcome("evaluate", "open-bay", "--policy", "random", *SHORT, "--map", "made", *draught)
    outcome("export", "open-bay", "--map", "made", "--to", "mjcf", "--out", "scene")
    for folder in ("scene", "runs", "made"):
        shutil.rmtree(folder, ignore_errors=True)


@some
@given(data=st.data())
def test_records(data: st.DataObject, files: Path) -> None:
    name = data.draw(st.sampled_from(["csv", "txt", "nc"]))
    Path(f"r.{name}").write_bytes(spoilt((files / f"a.{name}").read_bytes(), data.draw))
    record = ("--set", f'weather.file="r.{name}"')
    outcome("evaluate", "open-bay", "--policy", "random", *SHORT, *record)
    shutil.rmtree("runs", ignore_errors=True)


@some
@given(data=st.data())
def test_estimates(data: st.DataObject) -> None:
    flags = {"length": "2", "beam": "1", "mass": "60", "thrust": "50", "top-speed": "1.5"}
    flags[data.draw(st.sampled_from(sorted(flags)))] = data.draw(odd)
    given = [f"--{flag}={value}" for flag, value in flags.items()]
    outcome("estimate-vessel", *given, "--out", data.draw(st.sampled_from(["b.toml", "/dev/x/b"])))


@some
@given(data=st.data())
def test_exports(data: st.DataObject, run: Path) -> None:
    flag = data.draw(st.sampled_from(["to", "episode", "policy", "world", "seed", "set"]))
    kind = data.draw(st.sampled_from(["csv", "geojson", "gpx", "mcap", "mjcf", "netcdf", "qgc"]))
    source = data.draw(st.sampled_from([run, "open-bay"]))
    outcome("export", source, f"--to={kind}", "--out", "bag", f"--{flag}={data.draw(odd)}")
    outcome("answer", run, data.draw(odd))
    outcome("stream", run, f"--{data.draw(st.sampled_from(['port', 'speed']))}=-1")
    shutil.rmtree("bag", ignore_errors=True)


def test_there_are_a_hundred() -> None:
    """Cases whose words are tested too: of charts and places, and of records."""
    assert len(CASES) + len(PLACES) + len(BAD_TEXT) + len(BAD_GRIDS) >= 100
