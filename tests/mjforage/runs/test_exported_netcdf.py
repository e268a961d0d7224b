"""Episodes as NetCDF, read by xarray and the checker of the conventions."""

from pathlib import Path

import numpy as np
import pytest
import shapely
import xarray as xr
from compliance_checker.runner import CheckSuite, ComplianceChecker

import mjforage as mf
from tests.mjforage.scenario.placing.drawn import geojson


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> mf.Run:
    folder = tmp_path_factory.mktemp("harbour")
    water = [(shapely.box(-60, -40, 60, 40), {"natural": "water"})]
    place = mf.Map.of_chart(geojson(folder / "basin.geojson", water), folder / "port", pitch_m=4.0)
    items = {"mean": 30.0, "std": 0.0}
    scenario = mf.load_scenario("open-bay", map=place, horizon=30, items=items)
    return mf.evaluate(scenario, ["greedy"], world="physics", episodes=1, folder=folder / "run")


@pytest.fixture(scope="module")
def file(run: mf.Run, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return run.export(tmp_path_factory.mktemp("export") / "out", "netcdf") / "episode.nc"


def test_there_is_a_trajectory_per_body(run: mf.Run, file: Path) -> None:
    shown, place = run.recording(), run.scenario.map.place
    assert place is not None
    x, y = np.moveaxis(shown.track_pose[..., :2].astype(np.float64), -1, 0)
    latlon = place.latlon(np.stack((place.rows - 1 - y / 4.0, x / 4.0), axis=-1))
    with xr.open_dataset(file, engine="netcdf4", decode_times=False) as data:
        assert data.name.values[:4].astype(str).tolist() == [*shown.labels]
        np.testing.assert_allclose(data.lat.values[:4].T, latlon[..., 0], atol=1e-9)
        np.testing.assert_allclose(data.lon.values[:4].T, latlon[..., 1], atol=1e-9)
        np.testing.assert_allclose(data.x.values[:4].T, x, atol=1e-6)
        assert (np.isfinite(data.y.values[4:].T) == shown.track_present).all()
        assert (data.time.values[0] == shown.frame_s * np.arange(len(x))).all()
        found = np.where(shown.t_discovered < 0, np.nan, shown.t_discovered * shown.period_s)
        np.testing.assert_array_equal(data.discovered.values[4:], found)
        taken, gone = data.collected.values[4:], ~shown.item_present[-1]
        assert (np.isfinite(taken) == (gone & shown.item_present[0])).all()
        for item in np.flatnonzero(np.isfinite(taken)):
            seen = data.time.values[4 + item]
            assert np.nanmax(seen) == taken[item] - shown.frame_s
        assert np.isfinite(taken).any()
    with xr.open_dataset(file, engine="netcdf4") as data:
        assert str(data.time.values[0, 0])[:19] == "1970-01-01T00:00:00"


def test_it_follows_the_conventions(file: Path, tmp_path: Path) -> None:
    CheckSuite.load_all_available_checkers()
    report = str(tmp_path / "report.json")
    told = {"output_filename": report, "output_format": "json"}
    good, failed = ComplianceChecker.run_checker(str(file), ["cf:1.8"], 0, "strict", **told)
    assert good and not failed, Path(report).read_text(encoding="utf-8")
