"""Recorded wind and current: conventions, files of others, both worlds, and an independent ODE."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from mjforage.base.errors import UserError
from mjforage.base.randomness import episode_keys
from mjforage.forcing import Forcing
from mjforage.forcing.record import starts_of
from mjforage.forcing.record_files import Recorded, read_record
from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.graph_planner.policies import create_policy
from mjforage.mission.setup import Setup
from mjforage.physics.worlds import create_mission
from mjforage.runs.identity import run_info
from mjforage.scenario.place import Place
from mjforage.scenario.scenario import Weather
from mjforage.scenario.scenario_file import load_scenario

FloatArray = NDArray[np.float64]
HOURS = np.datetime64("2024-06-01T00:00", "ns") + np.arange(9) * np.timedelta64(1, "h")
AIR = "time,wind_speed_mps,wind_from_deg"
HEADER = f"{AIR},current_speed_mps,current_to_deg"
STEADY = "\n".join([HEADER, *(f"2024-06-01T0{h}:00,6,270,0.2,30" for h in range(9))])
KEYS, EPISODES = episode_keys(0, np.arange(3)), np.arange(1000)
PLACE = Place(38.97, -76.48, 4.0, 61, 61, rotation_deg=20.0)
SEA = navigation_graph(np.ones((61, 61), np.bool_), 4.0, False)


def write(folder: Path, text: str, name: str = "record.csv") -> str:
    (folder / name).write_text(text)
    return str(folder / name)


def read(folder: Path, text: str) -> Recorded:
    return read_record(write(folder, text))


def grid(**more: Any) -> xarray.Dataset:
    """Wind and current that change in space and time, by CF names, about the place."""
    lat, lon = np.linspace(38.96, 38.98, 9), np.linspace(-76.5, -76.46, 13)
    t, y, x = np.meshgrid(
        np.arange(9.0), np.linspace(-1, 1, 9), np.linspace(-1, 1, 13), indexing="ij"
    )
    fields = {
        "eastward_sea_water_velocity": 0.1 + 0.1 * x * y + 0.02 * t,
        "northward_sea_water_velocity": 0.05 * np.sin(3 * x) - 0.01 * t * y,
        "eastward_wind": 4.0 + x,
        "northward_wind": 1.0 - y * t / 9,
    }
    dims = ("time", "latitude", "longitude")
    units = {"units": "m s-1"}
    data = {
        f"f{i}": (dims, f, units | {"standard_name": k}) for i, (k, f) in enumerate(fields.items())
    }
    return xarray.Dataset(data, {"time": HOURS, "latitude": lat, "longitude": lon}).assign(**more)


def saved(folder: Path, data: xarray.Dataset, engine: Any = "h5netcdf", **more: Any) -> str:
    file = folder / f"record-{len(list(folder.iterdir()))}.nc"
    data.to_netcdf(
        file, engine=engine, format="NETCDF3_CLASSIC" if engine == "scipy" else None, **more
    )
    return str(file)


def forcing_of(file: str, **weather: Any) -> Forcing:
    given = Weather(file=file, start="2024-06-01T00:00", noise_node_per_step=0.0, **weather)
    return Forcing.create(given, KEYS, SEA, 10.0, PLACE)


def test_wind_is_named_by_where_it_is_from_and_current_by_where_it_goes(tmp_path: Path) -> None:
    found = read(tmp_path, STEADY)
    assert found.wind is not None and found.current is not None
    np.testing.assert_allclose(found.wind[:, 0, 0], np.tile([6.0, 0.0], (9, 1)), atol=1e-12)
    np.testing.assert_allclose(found.current[:, 0, 0], np.tile([0.1, 0.1 * 3**0.5], (9, 1)))


@pytest.mark.parametrize("world", ["graph", "physics"])
def test_a_recorded_wind_from_the_west_pushes_items_east(tmp_path: Path, world: str) -> None:
    file = write(tmp_path, STEADY.replace("0.2,30", "0,0"))
    setup = Setup.of(load_scenario("open-bay", [f"weather.file={file!r}", "horizon=3"]))
    mission, policy = create_mission(setup, world), create_policy("random")
    mission.reset(0, np.arange(2))
    start = mission.state.item_rc.copy()
    mission.run(policy)
    went = np.median((mission.state.item_rc - start)[mission.state.item_node >= 0], axis=0)
    expected = 0.03 * 6.0 * 3 * setup.scenario.period_s / 4.0
    np.testing.assert_allclose(went, (0.0, expected), atol=0.09 * expected)


def test_a_recorded_drift_is_alike_in_the_graph_and_in_mujoco(tmp_path: Path) -> None:
    """Wind that turns and grows, and a current: the way of most items within 3 %."""
    rows = [
        f"2024-06-01T00:0{m},{3 + m / 3},{200 + 9 * m},{0.1 + m / 50},{40 + m}" for m in range(10)
    ]
    file = write(tmp_path, "\n".join([HEADER, *rows]))
    sets = [f"weather.file={file!r}", "weather.start='2024-06-01T00:00'", "horizon=18"]
    setup = Setup.of(
        load_scenario("open-bay", [*sets, "weather.noise_node_per_step=0", "team.scouts.count=0"])
    )
    ways = []
    for world in ("graph", "physics"):
        mission, policy = create_mission(setup, world), create_policy("random")
        mission.reset(1, np.arange(3))
        mission.prepare(policy)
        mission.advance(mission.ask(policy))
        start = mission.state.item_rc.copy()
        for _ in range(10):
            mission.advance(mission.ask(policy))
        ways.append((mission.state.item_rc - start, mission.state.item_node >= 0))
    left = ways[0][1] & ways[1][1]
    graph, hulls = (np.median(way[left], axis=0) for way, _ in ways)
    assert np.linalg.norm(graph - hulls) < 0.03 * np.linalg.norm(hulls) and graph[1] > 1.0


def test_tracers_go_as_an_independent_integration_of_the_file(tmp_path: Path) -> None:
    """scipy's solver on xarray's interpolation, in latitude and longitude; 10 min, 1 %."""
    data = grid()
    forcing = forcing_of(saved(tmp_path, data))
    rc = np.array([[[30.0, 30.0], [45.0, 12.0], [20.0, 40.0]]]).repeat(3, axis=0)
    start, metre = PLACE.latlon(rc[0]), np.pi / 180 * 6371008.8
    for step in range(60):
        there = rc + 0.5 * forcing.carried_rc(10.0 * step, rc, 0.0)
        rc = rc + forcing.carried_rc(10.0 * step + 5.0, there, 0.0)
    fields = data[["f0", "f1"]].to_dataarray()

    def flow(t_s: float, latlon: FloatArray) -> FloatArray:
        lat, lon = latlon
        when = HOURS[0] + np.timedelta64(round(t_s * 1e9), "ns")
        u, v = fields.interp(time=when, latitude=lat, longitude=lon).values
        return np.array([v, u / np.cos(np.radians(lat))]) / metre

    for k, begin in enumerate(start):
        end = solve_ivp(flow, (0.0, 600.0), begin, rtol=1e-8).y[:, -1]
        came = PLACE.cells(np.array([begin, end, PLACE.latlon(rc[0, k])]))
        assert np.linalg.norm(came[2] - came[1]) < 0.01 * np.linalg.norm(came[1] - came[0])
        assert np.linalg.norm(came[1] - came[0]) > 5.0


def era5(new: bool) -> xarray.Dataset:
    """The same winds as old and as new files of ERA5 have them."""
    data = grid()[["f2", "f3"]].rename(f2="u10", f3="v10").isel(latitude=slice(None, None, -1))
    for name in ("u10", "v10"):
        data[name] = (data[name].dims, np.round(data[name].values, 1), {"units": "m s**-1"})
    data = data.assign_coords(longitude=data.longitude % 360.0)
    if not new:
        first = data.where(data.time < HOURS[5])
        return xarray.concat([first, data.where(data.time >= HOURS[5])], "expver").transpose(
            "time", ...
        )
    data = data.rename(time="valid_time")
    return data.assign_coords(number=0, expver=("valid_time", ["0001"] * 9))


def test_old_and_new_files_of_era5_give_equal_bits(tmp_path: Path) -> None:
    packed = {"dtype": "int16", "scale_factor": 0.1, "add_offset": 4.0, "_FillValue": -32767}
    how: dict[str, Any] = {"encoding": {"u10": packed, "v10": packed}}
    old = read_record(saved(tmp_path, era5(new=False), "scipy", **how))
    new = read_record(saved(tmp_path, era5(new=True), **how))
    assert old.wind is not None and new.wind is not None
    np.testing.assert_array_equal(old.wind, new.wind)
    np.testing.assert_array_equal(old.longitude, new.longitude)
    np.testing.assert_allclose(new.wind[:, ::8, ::12, 0], [[[3, 5], [3, 5]]] * 9, atol=1e-12)
    assert (np.diff(new.latitude) > 0).all()
    wind = forcing_of(saved(tmp_path, era5(new=True), **how)).open_water(0.0).wind
    assert np.hypot(*wind[0]) == pytest.approx(np.hypot(4.0, 1.0), abs=0.2)


def test_a_grid_may_be_cut_anywhere(tmp_path: Path) -> None:
    """At Greenwich, at 180 degrees, or going round: the wind on the map is that of the globe."""
    for middle, width in ((0.0, 2.0), (180.0, 2.0), (-76.48, 2.0), (0.1, 358.0), (-0.01, 358.0)):
        step = 2.0 if width > 9.0 else 0.5
        lon = np.arange(middle - 0.5 * width, middle + 0.5 * width + step / 2, step)
        for cut in (lon % 360.0, (lon + 180.0) % 360.0 - 180.0):
            data = grid().interp(longitude=np.linspace(-76.5, -76.46, lon.size))
            turned = np.cos(np.radians(cut)) * xarray.ones_like(data.f2)
            turned = turned.assign_attrs(data.f2.attrs)
            data = data.assign(f2=turned).assign_coords(longitude=cut).sortby("longitude")
            place = Place(38.97, middle, 4.0, 61, 61)
            given = Weather(file=saved(tmp_path, data), start="2024-06-01T00:00")
            found = Forcing.create(given, KEYS, SEA, 10.0, place).open_water(0.0).wind[0, 0]
            assert found == pytest.approx(np.cos(np.radians(middle)), abs=2e-4), (middle, cut)


def test_a_grid_of_one_latitude_is_the_same_to_north_and_south(tmp_path: Path) -> None:
    line = grid().isel(latitude=[4])
    one, all_of_it = (forcing_of(saved(tmp_path, data)) for data in (line, grid()))
    there = np.array([[[60.0, 120.0], [200.0, 120.0]]]).repeat(3, axis=0)
    found, along = one.wind(0.0, there), all_of_it.wind(0.0, there)
    assert found[0, 0, 0] != found[0, 1, 0]
    np.testing.assert_allclose(found, along, atol=0.05)
    assert read_record(saved(tmp_path, line)).latitude == pytest.approx(38.97)


def at_height(data: xarray.Dataset, height: float, units: str = "m") -> xarray.Dataset:
    told = {"units": units, "standard_name": "height"}
    return data.assign_coords(height_2=((), height, told))


def test_a_wind_is_brought_from_the_height_that_its_file_tells(tmp_path: Path) -> None:
    plain = forcing_of(saved(tmp_path, grid())).open_water(0.0).wind
    low = forcing_of(saved(tmp_path, at_height(grid(), 2.0))).open_water(0.0).wind
    np.testing.assert_allclose(low, plain * 5.0**0.14)
    deep = at_height(grid(), 2.0).expand_dims("height_2")
    np.testing.assert_array_equal(forcing_of(saved(tmp_path, deep)).open_water(0.0).wind, low)
    same = forcing_of(saved(tmp_path, at_height(grid(), 2.0)), record_height_m=2.0)
    np.testing.assert_array_equal(same.open_water(0.0).wind, low)
    with pytest.raises(UserError, match=r"record_height_m = 3: record .* has its wind at 2 m"):
        forcing_of(saved(tmp_path, at_height(grid(), 2.0)), record_height_m=3.0)
    for height, units in ((0.0, "m"), (30.0, "ft")):
        with pytest.raises(UserError, match=f"its wind is at a height of {height:g} {units}; give"):
            read_record(saved(tmp_path, at_height(grid(), height, units)))


GUST = {"units": "m s-1", "standard_name": "wind_speed_of_gust"}


def test_gusts_are_those_that_a_record_has(tmp_path: Path) -> None:
    """By Ishizaki's rule, in the world with gusts, unless the scenario gives others."""
    data = grid()
    speed = np.hypot(data.f2, data.f3)
    data = data.assign(g=(1.3 * speed).assign_attrs(GUST))
    file, own = saved(tmp_path, data), 0.3 / (0.5 * np.log(200.0))
    gusty, other, calm = (
        forcing_of(file, **more) for more in ({}, {"gust_intensity": own}, {"gust_intensity": 0.0})
    )
    there = np.array([[[60.0, 120.0], [200.0, 30.0]]]).repeat(3, axis=0)
    np.testing.assert_allclose(gusty.wind(50.0, there), other.wind(50.0, there), atol=1e-12)
    assert np.abs(gusty.wind(50.0, there) - calm.wind(50.0, there)).max() > 0.1
    for mean in (
        gusty.open_water(50.0, gusts=False),
        Forcing.create(gusty.weather.without_gusts(), KEYS, SEA, 10.0, PLACE).open_water(50.0),
    ):
        np.testing.assert_array_equal(mean.wind, calm.open_water(50.0).wind)
    buoy = read(tmp_path, NDBC.replace("MM   MM   6.0", "225  2.0  MM"))
    assert buoy.gusts is not None
    excess = np.array([0.25, 0.225, 0.2])  # the middle one is missing
    np.testing.assert_allclose(buoy.gusts[:, 0, 0], excess / (0.5 * np.log(96.0)))
    assert read(tmp_path, STEADY).gusts is None
    elsewhere = data.assign(g=data.g.isel(latitude=slice(4)).rename(latitude="lat"))
    with pytest.raises(UserError, match="wind and gusts are on different grids"):
        read_record(saved(tmp_path, elsewhere))


NDBC = """#YY  MM DD hh mm WDIR WSPD GST
#yr  mo dy hr mn degT m/s  m/s
2024 06 01 02 00 180  5.0  6.0
2024 06 01 01 00 MM   MM   6.0
2024 06 01 00 50 270  4.0  5.0
2024 06 01 00 00 999 99.0 99.0
"""


def test_ndbc_text_is_read_newest_first_and_of_old_years(tmp_path: Path) -> None:
    """What is missing goes; two hours remain an hour and ten minutes apart, which is a gap."""
    with pytest.raises(UserError, match=r"gap of 1\.17 h from 2024-06-01T00:50:00 to "):
        read(tmp_path, NDBC)
    found = read(tmp_path, NDBC.replace("MM   MM ", "225  2.0"))
    assert found.wind is not None and found.current is None
    np.testing.assert_allclose(found.wind[0, 0, 0], (4.0, 0.0), atol=1e-12)
    np.testing.assert_allclose(found.wind[2, 0, 0], (0.0, 5.0), atol=1e-12)
    old = read(tmp_path, "YY MM DD hh WD WSPD\n98 12 31 22 090 1.0\n98 12 31 23 090 2.0\n")
    assert old.wind is not None and old.times_s[0] == 915141600.0
    np.testing.assert_allclose(old.wind[1, 0, 0], (-2.0, 0.0), atol=1e-12)


def test_a_record_begins_where_it_is_told_or_where_its_episode_draws(tmp_path: Path) -> None:
    rows = [f"2024-06-01T0{h}:00,{h},270" for h in range(9)]
    file = write(tmp_path, "\n".join([HEADER[:33], *rows]))
    given = Weather(file=file, start="2024-06-01T03:30")
    told = Forcing.create(given, KEYS, SEA, 10.0, long_s=3600.0)
    np.testing.assert_allclose(told.open_water(1800.0).wind, [[4.0, 0.0]] * 3, atol=1e-12)
    drawn = Forcing.create(Weather(file=file), KEYS, SEA, 10.0, long_s=3600.0)
    speeds = drawn.open_water(0.0).wind[:, 0]
    assert np.unique(speeds).size == 3 and speeds.max() <= 7.0
    alone = Forcing.create(Weather(file=file), KEYS[2:], SEA, 10.0, long_s=3600.0)
    assert (alone.open_water(0.0).wind[0] == drawn.open_water(0.0).wind[2]).all()
    low = Forcing.create(Weather(file=file, start="2024-06-01T04:00", height_m=2.5), KEYS, SEA)
    assert low.open_water(0.0).wind[0, 0] == pytest.approx(4.0 * 0.25**0.14)


def test_another_horizon_moves_no_start_that_still_fits() -> None:
    """And starts are whole seconds, of which each that fits is as likely."""
    hours, keys = np.linspace(0.0, 86400.0, 25), episode_keys(3, EPISODES)
    day = Recorded("day", "", hours, None, None, np.zeros(1), np.zeros(1))
    short, longer = (starts_of(day, None, keys, long_s) for long_s in (1500.0, 7 * 3600.0))
    fits = short <= 17 * 3600.0
    assert 0.6 < fits.mean() < 0.85 and (short[fits] == longer[fits]).all()
    assert longer.max() <= 17 * 3600.0 and (longer == np.floor(longer)).all()
    shares = np.histogram(longer, 4, (0.0, 17 * 3600.0))[0] / EPISODES.size
    np.testing.assert_allclose(shares, 0.25, atol=0.05)
    assert not starts_of(day, None, keys, 86400.0).any()


def test_the_record_is_part_of_the_run_s_identity(tmp_path: Path) -> None:
    hashes = set()
    for text in (STEADY, STEADY.replace("6,270", "5,270")):
        file = write(tmp_path, text)
        setup = Setup.of(load_scenario("open-bay", [f"weather.file={file!r}"]))
        hashes.add(run_info(setup, ["greedy"], ["graph"], 1, 0)["hash"])
    assert len(hashes) == 2


KNOTS = {"units": "knots", "standard_name": "wind_speed"}
FROM = {"units": "degree", "standard_name": "wind_from_direction"}


def test_a_missing_speed_is_99_and_a_missing_direction_999(tmp_path: Path) -> None:
    hours = "".join(f"\n2024-06-01T0{k}:00,{v}" for k, v in enumerate(("5,90", "5,99", "5,98")))
    found = read(tmp_path, f"{AIR}{hours}\n2024-06-01T03:00,5,999\n2024-06-01T03:00,99,98")
    assert found.times_s.size == 3 and found.wind is not None
    assert np.degrees(np.arctan2(-found.wind[1, 0, 0, 0], -found.wind[1, 0, 0, 1])) == (
        pytest.approx(99.0)
    )


def test_a_header_in_quotes_is_that_of_other_programs(tmp_path: Path) -> None:
    lines = STEADY.splitlines()
    quoted = ",".join(f'"{one.strip()}"' for one in lines[0].split(","))
    found = read(tmp_path, "\n".join((quoted, *lines[1:])))
    assert (found.times_s == read(tmp_path, STEADY).times_s).all()


def test_speeds_in_knots_and_bearings_are_converted(tmp_path: Path) -> None:
    times, point = HOURS, np.full(9, 10.0)
    data = xarray.Dataset(
        {"s": ("time", point, KNOTS), "d": ("time", 9 * point, FROM)}, {"time": times}
    )
    found = read_record(saved(tmp_path, data)).wind
    assert found is not None
    np.testing.assert_allclose(
        found[:, 0, 0], np.tile([-10 * 1852 / 3600, 0.0], (9, 1)), atol=1e-12
    )
