"""Records that are not what they should be: each has one line."""

import gc
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray

from mjforage.base.errors import UserError
from mjforage.forcing import Forcing
from mjforage.forcing.record_files import read_record
from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.scenario.scenario import Weather
from tests.mjforage.forcing.test_records import (
    AIR,
    HOURS,
    KEYS,
    PLACE,
    SEA,
    STEADY,
    grid,
    saved,
    write,
)

ROW, NEXT = "2024-06-01T00:00", "2024-06-01T00:30"
BAD_TEXT = {
    f"{AIR}\n{ROW},5,{'9' * 140_000}": "is no CSV that can be read",
    "YY MM DD hh WDIR WSPD\n" + "9" * 20 + " 06 01 00 90 5": "is no time",
    "": "is neither CSV with time and wind_speed_mps nor NDBC's",
    "hello": "is neither CSV",
    "time": "is neither CSV",
    "a,b\n1,2": "its columns are a, b; give time and pairs of",
    "wind_speed_mps,wind_from_deg\n1,2": "its columns are wind_speed_mps",
    "time,time,wind_speed_mps\n": "its columns are time, time",
    "time,wind_speed_mps\n" + f"{ROW},1": "has wind_speed_mps alone; give wind_speed_mps and",
    f"time,current_to_deg\n{ROW},1": "has current_to_deg alone",
    f"{AIR},wind_gust\n": "its columns are",
    AIR: "has neither wind nor current",
    f"{AIR}\n{ROW},5,270": "has 1 times with all values, at least 2",
    f"{AIR}\n{ROW},,270\n{NEXT},,": "has 0 times",
    f"{AIR}\n{ROW},5,999\n{NEXT},99,270": "has 0 times",
    f"{AIR}\n{ROW},5\n": "line 2 has 2 cells, expected 3",
    f"{AIR}\n{ROW},5,270\n{NEXT},5,270,1": "line 3 has 4 cells",
    f"{AIR}\nyesterday,5,270": "line 2: 'yesterday' is no ISO 8601 time, such as",
    f"{AIR}\n2024-13-01T00:00,5,270": "line 2: '2024-13-01T00:00' is no ISO 8601 time",
    f"{AIR}\n{ROW}+02:00,5,270": "line 2: 2024-06-01T00:00+02:00 is not UTC",
    f"{AIR}\n{ROW},fast,270": "line 2: wind_speed_mps = 'fast' is no number",
    f"{AIR}\n{ROW},5,W": "line 2: wind_from_deg = 'W' is no number",
    f"{AIR}\n{ROW},-5,270\n{NEXT},5,270": "wind_speed_mps below 0, or wind_from_deg beyond 360",
    f"{AIR}\n{ROW},5,400\n{NEXT},5,270": "wind_from_deg beyond 360",
    f"{AIR}\n{ROW},500,270\n{NEXT},5,270": "a wind of 500 m/s; check its units",
    f"{AIR}\n{ROW},inf,270\n{NEXT},5,270": "wind_speed_mps = 'inf' is no number",
    f"time,current_speed_mps,current_to_deg\n{ROW},20,0\n{NEXT},5,0": "a current of 20 m/s",
    f"{AIR}\n{NEXT},5,270\n{ROW},5,270": "2024-06-01T00:00:00 comes twice, or late",
    f"{AIR}\n{ROW},5,270\n{ROW},5,270": "comes twice",
    f"{AIR}\n{ROW},5,270\n2024-06-01T02:00,5,270": "has a gap of 2 h from 2024-06-01T00:00:00",
    "#YY MM DD hh mm WSPD\n": "is neither CSV",
    "#YY MM DD hh mm WDIR WSPD\n2024 06 01 00 00 270": "line 2 has 6 columns, expected 7",
    "#YY MM DD hh mm WDIR WSPD\n2024 06 41 00 00 270 5.0": "line 2: 2024 06 41 00 00 is no time",
    "#YY MM DD hh mm WDIR WSPD\n2024 06 01 00 x 270 5.0": "is no time",
    "#YY MM DD hh mm WDIR WSPD\n2024 06 01 00 00 W 5.0": "line 2: WDIR = 'W' is no number",
    "#YY MM DD hh mm WDIR WSPD\n": "has neither wind nor current",
    "\x89HDF": "is no NetCDF file that can be read",
    "CDF\x01": "is no NetCDF file that can be read",
}


@pytest.mark.parametrize("text", BAD_TEXT)
def test_each_malformed_text_has_one_line(tmp_path: Path, text: str) -> None:
    content = text.encode("latin-1" if text[:1] in ("\x89", "C") else "utf-8")
    (tmp_path / "record").write_bytes(content)
    with pytest.raises(UserError, match=r"^record ") as caught:
        read_record(str(tmp_path / "record"))
    assert BAD_TEXT[text] in str(caught.value) and "\n" not in str(caught.value)


def named(data: xarray.Dataset, key: str, **attributes: str) -> xarray.Dataset:
    return data.assign({key: data[key].assign_attrs(attributes)})


BAD_GRIDS: dict[str, tuple[Callable[[xarray.Dataset], xarray.Dataset], str]] = {
    "units": (
        lambda d: named(d, "f0", units="furlong"),
        "units 'furlong' of a speed are not",
    ),
    "none": (lambda d: named(d, "f0", units=""), "units '' of a speed"),
    "names": (lambda d: d[["f0"]], "has neither wind nor current by a CF standard name, but eastw"),
    "twice": (
        lambda d: d.assign(f9=d.f2),
        "has eastward_wind twice, f2 and f9; keep one",
    ),
    "zone": (
        lambda d: d.assign_coords(
            time=("time", np.arange(9), {"units": "hours since 2024-06-01 EST"})
        ),
        "its time is in 'hours since 2024-06-01 EST'; give times in UTC",
    ),
    "elsewhere": (
        lambda d: d.assign(
            {
                k: d[k].assign_coords(latitude=d.latitude + 1).rename(latitude="lat")
                for k in ("f0", "f1")
            }
        ),
        "wind and current are on different grids",
    ),
    "below": (
        lambda d: xarray.Dataset(
            {
                "s": -abs(d.f2).assign_attrs(standard_name="wind_speed", units="m s-1"),
                "d": (d.f2 * 0).assign_attrs(standard_name="wind_from_direction", units="degree"),
            }
        ),
        "wind_speed below 0; check its missing values",
    ),
    "askew": (
        lambda d: named(d, "f2", standard_name="x_wind"),
        "along the axes of its grid (x_wind)",
    ),
    "staggered": (
        lambda d: d.assign(f1=d.f1.drop_vars("latitude").rename(latitude="eta_v")),
        "are on different points (a staggered grid); bring",
    ),
    "depth": (lambda d: d.expand_dims(depth=[0.0, 5.0]), "has a dimension depth of 2; choose one"),
    "uneven": (lambda d: d.isel(latitude=[0, 1, 3]), "its latitude is not evenly spaced"),
    "curved": (
        lambda d: d.rename(latitude="y", longitude="x").assign_coords(
            lat=(("y", "x"), np.zeros((9, 13))), lon=(("y", "x"), np.zeros((9, 13)))
        ),
        "its latitude has two dimensions (a rotated or curvilinear grid)",
    ),
    "still": (lambda d: d.isel(time=0, drop=True), "has no dimension time or valid_time"),
    "clock": (
        lambda d: d.assign_coords(time=np.arange(9.0)),
        "its time has no units such",
    ),
    "gap": (lambda d: d.isel(time=[0, 1, 5, 6]), "has a gap of 4 h from 2024-06-01T01:00:00"),
    "late": (lambda d: d.isel(time=[0, 1, 1, 2]), "comes twice"),
    "empty": (lambda d: d.where(d.time < HOURS[0]), "has 0 times with all values"),
}


@pytest.mark.parametrize("fault", BAD_GRIDS)
def test_each_malformed_grid_has_one_line(tmp_path: Path, fault: str) -> None:
    spoil, words = BAD_GRIDS[fault]
    with pytest.raises(UserError, match=r"^record ") as caught:
        read_record(saved(tmp_path, spoil(grid())))
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_a_damaged_root_leaves_no_traceback(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Such as of an object that was half made, and fails again as it is deleted."""
    left: list[object] = []
    monkeypatch.setattr(sys, "unraisablehook", left.append)
    file = Path(saved(tmp_path, grid()))
    content = bytearray(file.read_bytes())
    content[99] ^= 255  # in the header of the root
    file.write_bytes(content)
    with pytest.raises(UserError, match="is no NetCDF file that can be read"):
        read_record(str(file))
    gc.collect()
    assert not left


def test_a_record_that_does_not_fit_its_mission_is_refused(tmp_path: Path) -> None:
    wind, far = (
        write(tmp_path, STEADY),
        saved(tmp_path, grid().assign_coords(latitude=np.arange(9.0))),
    )
    pond = navigation_graph(np.pad(np.ones((4, 5), np.bool_), 1), 4.0, False)
    bay: Any = (SEA, 10.0, PLACE)
    cases: list[tuple[dict[str, Any], Any, str]] = [
        ({"file": str(tmp_path / "none.csv")}, bay, "cannot be read"),
        ({"file": wind, "wind_speed_mps": 5.0}, bay, "wind_speed_mps = 5: record .* has the wind"),
        ({"file": wind, "start": "noon"}, bay, "weather.start: 'noon' is no ISO 8601 time"),
        ({"file": wind, "start": "2024-06-01T07:30"}, (*bay, 3600.0), "give a start within"),
        ({"file": wind}, (*bay, 9e4), "shorter than an episode of 25 h"),
        ({"file": wind}, (pond, 10.0), "the map has no water at its edge"),
        ({"file": saved(tmp_path, grid())}, (SEA, 10.0), "the map has no latitude and longitude"),
        ({"file": far}, bay, r"latitude 0 to 8 and .* does not cover the map about 38.97, -76.48"),
    ]
    for weather, about, words in cases:
        with pytest.raises(UserError, match=words):
            Forcing.create(Weather(**weather), KEYS, *about)
