"""Runs that play a record: their dates in logs and exports, and a file that moves or changes."""

import json
from collections.abc import Callable
from datetime import datetime
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import polars as pl
import pytest
import shapely
import xarray
from rosbags.highlevel import AnyReader

import mjforage as mf
from mjforage.base.errors import UserError
from mjforage.runs.episode_recording import Recording
from tests.mjforage.scenario.placing.drawn import geojson

HOURS = [f"2024-06-01T{h:02}:00,{3 + h / 4},{200 + 3 * h}" for h in range(24)]
TEXT = "\n".join(["time,wind_speed_mps,wind_from_deg", *HOURS])
SHORT: dict[str, Any] = {"horizon": 8, "items": {"mean": 20.0, "std": 0.0}}


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a place and a record."""
    folder = tmp_path_factory.mktemp("project")
    water = [(shapely.box(-60, -40, 60, 40), {"natural": "water"})]
    mf.Map.of_chart(geojson(folder / "basin.geojson", water), folder / "port", pitch_m=4.0)
    (folder / "wind.csv").write_text(TEXT)
    return folder


@pytest.fixture(scope="module")
def run(project: Path) -> mf.Run:
    """Return a run that was made in that folder, with the record's path as from there."""
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(project)
        bay = mf.load_scenario("open-bay", map="port", weather={"file": "wind.csv"}, **SHORT)
        return mf.evaluate(bay, "greedy", episodes=3, record=[0], folder=project / "run")


def test_the_drawn_start_of_an_episode_is_logged_and_can_be_told(run: mf.Run) -> None:
    starts = run.episodes["record_start"].to_list()
    assert len(set(starts)) == 3
    assert "record_start" not in run.summary["metric"].to_list()
    told = run.scenario.replace(weather={"start": starts[2]})
    again = mf.evaluate(told, "greedy", episodes=3)
    assert again.episodes["record_start"].to_list() == 3 * [starts[2]]
    blown = [
        one.steps.filter(pl.col("episode") == 2).select("wind_speed_mps", "wind_from_deg")
        for one in (run, again)
    ]
    assert blown[0].equals(blown[1])
    assert "record_start" not in mf.evaluate("open-bay", "greedy", episodes=1, **SHORT).episodes


@pytest.mark.parametrize("episode", [0, 1])
def test_exports_begin_when_the_episode_does(run: mf.Run, tmp_path: Path, episode: int) -> None:
    """Of a recorded episode, and of one that is played again, with another working folder."""
    start = datetime.fromisoformat(run.episodes["record_start"][episode])
    for to in ("csv", "geojson", "gpx", "mcap", "netcdf"):
        run.export(tmp_path / to, to, episode=episode)
    tree = json.loads((tmp_path / "geojson" / "episode.geojson").read_text())
    times = tree["features"][0]["properties"]["coordTimes"]
    gpx = ElementTree.parse(tmp_path / "gpx" / "episode.gpx")
    first = next(one.text for one in gpx.iter() if one.tag.endswith("time"))
    table = pl.read_csv(tmp_path / "csv" / "tracks.csv")
    for text in (times[0], first, table["utc"][0]):
        assert datetime.fromisoformat(str(text)) == start
    assert (datetime.fromisoformat(times[1]) - start).total_seconds() == 10.0
    with AnyReader([tmp_path / "mcap"]) as bag:
        assert bag.start_time == start.timestamp() * 1e9
    with xarray.open_dataset(tmp_path / "netcdf" / "episode.nc", engine="netcdf4") as data:
        assert str(data.time.values[0, 0])[:19] == start.isoformat()[:19]


def test_a_report_needs_no_record(run: mf.Run, tmp_path: Path) -> None:
    run.save(tmp_path / "copy")
    assert mf.load_run(tmp_path / "copy").report().is_file()


def test_a_recording_of_no_date_or_of_none_that_there_is(run: mf.Run, tmp_path: Path) -> None:
    shown = run.recording(episode=0)
    assert shown.begins_s is not None
    (tmp_path / "far.npz").write_bytes(
        shown.__class__(**vars(shown) | {"begins_s": 1e99}).content()
    )
    with pytest.raises(UserError, match=r"cannot be read .begins_s is 1e"):
        Recording.load(tmp_path / "far.npz")


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda file: file.unlink(), "is not there; put back the file that the run played, of SHA"),
        (lambda file: file.write_text(TEXT.replace(",200", ",190")), "has changed; put back the"),
    ],
)
def test_a_record_that_was_moved_or_changed_is_named(
    run: mf.Run, project: Path, spoil: Callable[[Path], object], words: str
) -> None:
    file, sha = project / "wind.csv", json.loads((project / "run" / "run.json").read_text())
    spoil(file)
    try:
        with pytest.raises(UserError, match=f"^record {file}: {words}") as caught:
            run.recording(episode=1)
        assert sha["map"]["record"] in str(caught.value)
        assert run.recording(episode=0).begins_s is not None  # was recorded
        if file.exists():
            with pytest.raises(UserError, match=f"another run: record {file} differs"):
                mf.evaluate(run.scenario, "greedy", episodes=3, folder=project / "run")
    finally:
        file.write_text(TEXT)
