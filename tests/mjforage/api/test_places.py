"""Places in scenarios: starts, runs and their tables in latitude and longitude."""

from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
import shapely
from PIL import Image
from polars.testing import assert_frame_equal

import mjforage as mf
from mjforage.cli import main
from mjforage.runs.tables import ON_A_PLACE
from mjforage.scenario.maps import GridMap
from mjforage.scenario.place import Place
from mjforage.view.figures.map_pictures import save_map_picture
from tests.mjforage.scenario.placing.drawn import geojson

BASIN = shapely.box(-60, -40, 60, 40)
PIER = shapely.LineString([(0, -40), (0, 10)])
SHORT: dict[str, Any] = {"horizon": 6, "items": {"mean": 5.0, "std": 0.0}}


@pytest.fixture(scope="module")
def harbour(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A place, rotated by 10 degrees."""
    folder = tmp_path_factory.mktemp("harbour")
    turned = [shapely.affinity.rotate(shape, -10.0, origin=(0, 0)) for shape in (BASIN, PIER)]
    features = [(turned[0], {"natural": "water"}), (turned[1], {"man_made": "breakwater"})]
    source = geojson(folder / "basin.geojson", features)
    mf.Map.of_chart(source, folder / "port", pitch_m=4.0, rotate="auto", licence="drawn for a test")
    return folder / "port"


def place_of(found: mf.Map) -> Place:
    assert found.place is not None
    return found.place


def test_a_place_is_a_map_with_a_picture(harbour: Path, tmp_path: Path) -> None:
    found = mf.Map(harbour)
    assert (found.name, found.pitch_m) == ("port", 4.0)
    assert found.water.shape == (22, 32)
    assert found.water.sum() == pytest.approx(600 - 2 * 12, abs=3)
    place = place_of(found)
    assert place.rotation_deg == pytest.approx(10.0, abs=0.01)
    assert (place.source, place.licence) == ("basin.geojson", "drawn for a test")
    assert place_of(mf.Map(harbour / "place.toml")) == place
    with Image.open(harbour / "harbour.png") as image:
        assert image.width > 300
    save_map_picture([GridMap("port", found.water)], tmp_path / "port.png")
    assert (harbour / "harbour.png").read_bytes() == (tmp_path / "port.png").read_bytes()


def test_a_scenario_of_a_place(harbour: Path, tmp_path: Path) -> None:
    """Its folder by a path from the scenario's; starts on the globe; its own pitch."""
    place = place_of(mf.Map(harbour))
    starts = place.latlon([[10, 3], [10, 4]]).round(7).tolist()
    (tmp_path / "port").symlink_to(harbour)
    file = tmp_path / "mine.toml"
    file.write_text(
        'name = "mine"\n[map]\nfile = "port"\n'
        f"starts_latlon = {starts}\n"
        "[team.all]\ncount = 2\nmoves = 1\nradius = 3.0\ncollects = true\n"
    )
    scenario = mf.load_scenario(file)
    assert scenario.map.starts == ((10, 3), (10, 4))
    assert scenario.map.place == place
    kept = mf.load_scenario(scenario.replace(horizon=9).to_file(tmp_path / "kept.toml"))
    assert kept.map.place == place and kept.map.starts == scenario.map.starts


def test_a_place_brings_its_pitch_and_no_starts_of_another_map(tmp_path: Path) -> None:
    source = geojson(tmp_path / "basin.geojson", [(BASIN, {})])
    made = mf.Map.of_chart(source, tmp_path / "fine", pitch_m=2.0)
    for scenario in (
        mf.load_scenario("comb-port", map=tmp_path / "fine"),
        mf.load_scenario("comb-port", map=made),
        mf.parallel_env("comb-port", map=str(tmp_path / "fine")).core.setup,
    ):
        own = mf.Scenario(scenario.scenario, scenario.grid)
        assert (own.map.pitch_m, own.map.starts, own.map.place) == (2.0, (), made.place)


@pytest.fixture(scope="module")
def run(harbour: Path, tmp_path_factory: pytest.TempPathFactory) -> mf.Run:
    """A run on the place."""
    scenario = mf.load_scenario("open-bay", map=harbour, **SHORT)
    out = tmp_path_factory.mktemp("run") / "run"
    return mf.evaluate(scenario, ["greedy"], episodes=2, folder=out)


def test_tables_have_latitude_and_longitude(run: mf.Run, harbour: Path) -> None:
    place = place_of(mf.Map(harbour))
    agents = run.agents
    rows = place.rows - 1 - agents["y_m"].to_numpy() / 4.0
    cells = np.stack((rows, agents["x_m"].to_numpy() / 4.0), axis=-1)
    given = agents.select("lat_deg", "lon_deg").to_numpy()
    np.testing.assert_allclose(given, place.latlon(cells), atol=1e-8)
    items = run.items
    start = items.select("row_start", "col_start").to_numpy()
    given = items.select("lat_start_deg", "lon_start_deg").to_numpy()
    np.testing.assert_allclose(given, place.latlon(start), atol=1e-8)


def test_workers_and_a_loaded_run_have_the_place(
    run: mf.Run, harbour: Path, tmp_path: Path
) -> None:
    scenario = mf.load_scenario("open-bay", map=harbour, **SHORT)
    other = mf.evaluate(scenario, ["greedy"], episodes=2, jobs=2, folder=tmp_path / "run")
    assert_frame_equal(other.agents, run.agents)
    assert run.folder is not None
    assert mf.load_run(run.folder).scenario.map.place == place_of(mf.Map(harbour))


def test_maps_that_are_no_places_have_none_of_it(tmp_path: Path) -> None:
    run = mf.evaluate("open-bay", ["greedy"], episodes=1, folder=tmp_path / "run", **SHORT)
    assert run.folder is not None
    for table, columns in ON_A_PLACE.items():
        assert not columns.keys() & set(getattr(run, table).columns)
    assert '"place"' not in (run.folder / "run.json").read_text()


def test_the_command_makes_a_place_and_tells_of_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    geojson(Path("a.geojson"), [(BASIN, {"natural": "water"}), (PIER, {"man_made": "pier"})])
    crop = "--crop=-5.7,35.9996,-5.5,36.0001"
    how = ("--pitch", "2", "--land", "man_made=pier", "--pier-width", "6", "--rotate", "-5")
    main(["place", "a.geojson", *how, "--out", "port"])
    told = capsys.readouterr().out
    assert "port: " in told and "1 lines of pier taken as 6 m wide" in told
    assert place_of(mf.Map("port")).rotation_deg == -5.0
    main(["maps", "port"])
    assert "port: " in capsys.readouterr().out
    with pytest.raises(SystemExit):
        main(["place", "a.geojson", crop, "--rotate", "x", "--out", "other"])
    assert "four numbers with commas" in capsys.readouterr().err
    assert pl.read_csv("port/harbour.csv", has_header=False).shape == mf.Map("port").water.shape
