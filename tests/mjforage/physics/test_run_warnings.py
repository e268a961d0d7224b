"""Warnings before a run: settings without effect, oscillation, late moves; and that they hold."""

import logging
import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray

from mjforage.forcing.record import far_km
from mjforage.forcing.record_files import Recorded
from mjforage.graph_planner.policies.registry import create_policy
from mjforage.mission.dynamics import LATE
from mjforage.mission.setup import Setup
from mjforage.physics.run_warnings import run_warnings, vessel_warnings
from mjforage.physics.vessel_models import decision_s, full_speed_s
from mjforage.physics.vessels import load_vessel
from mjforage.physics.worlds import WORLDS, create_mission
from mjforage.runs.evaluate import evaluate
from mjforage.scenario.place import Place
from mjforage.scenario.scenario_file import load_scenario, preset_names
from mjforage.scenario.vessel_files import vessel_path

PHYSICS = ("physics",)


def told(worlds: Sequence[str], *overrides: str) -> list[str]:
    return list(run_warnings(Setup.of(load_scenario("comb-port", overrides)), worlds))


def copied(folder: Path, name: str, *changes: tuple[str, str], without: str = "") -> str:
    """Path of a shipped vessel's file with numbers changed, or without a table."""
    text = vessel_path(name).read_text("utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    if without:
        head, _, rest = text.partition(f"\n[{without}]")
        text = head + rest[rest.index("\n\n") :]
    path = folder / f"{name}_.toml"
    path.write_text(text, "utf-8")
    return str(path)


@pytest.mark.parametrize(
    "preset", [name for name in preset_names() if not load_scenario(name).rules.jump]
)
def test_shipped_scenarios_have_vessels_that_feel_and_can_do_all(preset: str) -> None:
    setup = Setup.of(load_scenario(preset))
    assert run_warnings(setup, ("graph", "physics")) == ()
    for world in WORLDS:
        assert not any(line.startswith("vessel ") for line in run_warnings(setup, (world,)))


def test_wind_that_a_vessel_does_not_feel_is_told(tmp_path: Path) -> None:
    bare = copied(tmp_path, "scout", without="windage")
    scouts, wind = f"physics.vessels.scouts={bare}", "weather.wind_speed_mps=12"
    line = "vessel scout_ of scouts: has no [windage] and does not feel the wind of up to 12 m/s"
    assert told(PHYSICS, scouts, wind) == [line]
    drawn = "weather.wind_speed_mps=8", "weather.wind_spread=0.5"
    assert told(PHYSICS, scouts, *drawn) == [line]
    assert told(("graph", "hulls", "physics"), scouts, wind) == [line]
    assert told(("graph",), scouts, wind) == []
    calm = "weather.drift_node_per_step=0"
    assert told(PHYSICS, scouts, calm) == []
    drift = told(PHYSICS, scouts)  # the paper's, of 0.1 node per step on both axes: 4 m / 10 s
    assert "the wind of up to 1.89 m/s" in drift[0]
    assert math.sqrt(2.0) * 0.1 * 0.4 / 0.03 == pytest.approx(1.89, abs=0.005)


def test_a_device_and_vessels_that_differ_say_nothing_without_hulls() -> None:
    given = "physics.device=warp-cpu", "physics.spread.mass=0.1"
    line = "physics.spread, physics.device: not felt in world graph, and without effect in this run"
    assert told(("graph",), *given) == [line]
    assert told(("graph", "physics"), *given) == []


def test_a_collector_without_load_is_told(tmp_path: Path) -> None:
    bare = copied(tmp_path, "forager", without="load")
    line = "vessel forager_ of foragers: has no [load], so that items aboard add neither mass nor "
    assert told(PHYSICS, f"physics.vessels.foragers={bare}") == [f"{line}drag"]
    scouts = told(PHYSICS, "physics.vessels.scouts=otter")  # they carry nothing
    assert not any("[load]" in line for line in scouts)


@pytest.mark.parametrize(
    ("key", "value", "worlds"),
    [
        ("weather.gust_intensity", "0.1", ("graph", "debris", "intake")),
        ("weather.circulation_mps", "0.1", ("graph", "hulls")),
        ("weather.current_wander_mps", "0.1", ("graph", "calibrated")),
        ("weather.shelter_height_m", "5", ("graph",)),
        ("sensors.position_noise_m", "0.3", ("graph", "intake")),
        ("sensors.heading_noise_deg", "1", ("debris",)),
        ("sensors.camera_noise_m", "0.1", ("graph", "physics")),  # node: no item is steered for
    ],
)
def test_keys_that_no_world_of_a_run_feels_are_told(
    key: str, value: str, worlds: tuple[str, ...]
) -> None:
    words = f"{key}: not felt in world {' nor '.join(worlds)}, and without effect in this run"
    assert told(worlds, f"{key}={value}") == [words]
    assert told((*worlds, "physics"), f"{key}={value}", "physics.capture=intake") == []


@pytest.mark.parametrize(
    ("key", "value", "worlds", "felt"),
    [
        ("physics.item_classes", '["bag"]', ("graph", "hulls", "calibrated"), "debris"),
        ("physics.capture", "intake", ("graph", "hulls", "debris"), "calibrated"),
        ("physics.integrator", "reference", ("graph",), "hulls"),
        ("physics.step_s", "0.05", ("graph",), "hulls"),
        ("faults.rate_per_h", "2", ("graph",), "hulls"),
        ("faults.team", "scouts", ("graph",), "hulls"),
        ("physics.scale.mass", "1.1", ("graph",), "hulls"),
    ],
)
def test_keys_of_physics_that_no_world_of_a_run_feels_are_told(
    key: str, value: str, worlds: tuple[str, ...], felt: str
) -> None:
    table_key = ".".join(key.split(".")[:2])
    words = f"{table_key}: not felt in world {' nor '.join(worlds)}, and without effect in this run"
    assert told(worlds, f"{key}={value}") == [words]
    assert told((*worlds, felt), f"{key}={value}") == []


@pytest.mark.parametrize("key", ["current_speed_mps", "current_wander_mps", "circulation_mps"])
def test_currents_that_only_vessels_feel_are_told(key: str) -> None:
    current = f"weather.{key}=0.1"
    (line,) = told(PHYSICS, current, "physics.items=graph")
    assert line.startswith(f"weather.{key}: vessels feel it, items do not by physics.items")
    assert told(PHYSICS, current, "physics.items=bodies") == []
    assert told(PHYSICS, "physics.items=graph") == []
    assert line not in told(("graph",), current, "physics.items=graph")


def test_a_record_tells_what_it_lacks_and_what_says_nothing_beside_it(tmp_path: Path) -> None:
    wind, water = tmp_path / "wind.csv", tmp_path / "water.csv"
    rows = "".join(f"\n2024-06-01T0{h}:00,1,90" for h in range(9))
    wind.write_text("time,wind_speed_mps,wind_from_deg" + rows)
    water.write_text("time,current_speed_mps,current_to_deg" + rows)
    air, flow = (f"weather.file={file}" for file in (wind, water))
    bay = ("map.file=open-bay", "map.starts=[]")
    assert told(PHYSICS, air, *bay) == []
    assert told(PHYSICS, air, *bay, "weather.drift_node_per_step=0.3") == [
        f"weather.drift_node_per_step: without effect, as record {wind} has the wind; leave it out"
    ]
    told_of = told(("graph",), flow, *bay, "weather.height_m=2", "weather.record_height_m=4")
    assert told_of == [
        f"weather.record_height_m, weather.height_m: without effect, as record {water} has no "
        "wind; leave it out",
        f"record {water}: has no wind, so that weather.drift_node_per_step gives one; give "
        "weather.wind_speed_mps, 0 for a calm",
    ]
    assert told(PHYSICS, flow, *bay, "weather.wind_speed_mps=0") == []


def test_a_record_from_far_away_is_told(tmp_path: Path) -> None:
    hours, place = np.linspace(0.0, 86400.0, 25), Place(38.97, -76.48, 4.0, 61, 61)
    for lat, lon, away in ((38.97, -76.48, 0.0), (np.nan, np.nan, 0.0), (39.97, -76.48, 111.0)):
        known = Recorded("buoy", "", hours, None, None, np.array([lat]), np.array([lon]))
        assert far_km(known, place) == pytest.approx(away, abs=0.5)
    buoy = tmp_path / "buoy.nc"
    units = {"units": "m s-1"}
    wind = {k: ("time", np.ones(3), units) for k in ("eastward_wind", "northward_wind")}
    times = np.datetime64("2024-06-01T00:00", "ns") + np.arange(3) * np.timedelta64(1, "h")
    xarray.Dataset(wind, {"time": times, "lat": 39.97, "lon": -76.48}).to_netcdf(
        buoy, engine="h5netcdf"
    )
    setup = Setup.of(load_scenario("open-bay", (f"weather.file={buoy}",)))
    setup = replace(setup, grid=replace(setup.grid, place=place))
    words = f"record {buoy}: is of 39.97, -76.48, 111 km from the place at 38.97, -76.48; give one"
    assert list(run_warnings(setup, ("graph",))) == [f"{words} from nearer by"]
    line = Recorded("line", "", hours, None, None, np.array([37.97]), np.array([-80.0, -70.0]))
    assert far_km(line, place) == pytest.approx(111.0, abs=0.5)


def test_items_without_bodies_have_no_classes() -> None:
    words = "physics.item_classes: not felt in world physics, and without effect in this run"
    assert told(PHYSICS, 'physics.item_classes=["bag"]', "physics.items=graph") == [words]


@pytest.mark.parametrize(("longer_s", "hunts"), [(-0.01, False), (0.01, True)])
def test_a_vessel_hunts_from_a_dead_time_as_long_as_its_rise(longer_s: float, hunts: bool) -> None:
    scout = load_vessel("scout")
    rise = full_speed_s(scout)
    vessel = replace(scout, lag_s=rise - 0.1 + longer_s)
    assert full_speed_s(vessel) == rise
    lines = list(vessel_warnings(vessel, 0.0, 0.02))
    assert [": it hunts, and its ways" in line for line in lines] == [True] * hunts


@pytest.mark.parametrize(("longer_s", "late"), [(-0.1, True), (0.1, False)])
def test_moves_are_late_where_they_take_longer_than_a_decision(longer_s: float, late: bool) -> None:
    period_s = decision_s(load_vessel("scout"), 20.0) + longer_s
    overrides = ("map.pitch_m=10", "team.foragers.count=0", "team.scouts.count=1")
    lines = told(PHYSICS, *overrides, f"period_s={period_s}")
    assert ["moves will be late" in line for line in lines] == [True] * late
    worn = told(PHYSICS, *overrides, f"period_s={period_s}", "physics.scale.thrust=0.65")
    assert any("moves will be late" in line for line in worn)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            [('36.0, unit = "kg"', '1.0, unit = "kg"')],
            "full thrust gives it its cruise speed in 0.094 s, control and thruster lag take 0.3 s:"
            " it hunts, and its ways hang on the time step; give a shorter lag_s, less thrust or",
        ),
        ([("lag_s = { value = 0.2", "lag_s = { value = 3.0")], "control and thruster lag take 3.1"),
        (
            [("linear_yaw = { value = 3.3", "linear_yaw = { value = 330.0")],
            "drag takes its turning in 0.021 s, too short for a time step of 0.1 s; give "
            "physics.step_s of at most 0.059",
        ),
    ],
)
def test_vessels_too_quick_for_control_or_step_are_told(
    tmp_path: Path, changes: list[tuple[str, str]], words: str
) -> None:
    scouts = f"physics.vessels.scouts={copied(tmp_path, 'scout', *changes)}"
    lines = told(PHYSICS, scouts)
    assert any(words in line for line in lines), lines
    assert all(line.startswith("vessel scout_ of scouts: ") for line in lines)
    if "physics.step_s" in words:
        assert told(PHYSICS, scouts, "physics.step_s=0.05") == []


@pytest.mark.parametrize(("step_s", "deep_mm"), [(0.05, 25), (0.1, 50)])
def test_steps_with_soft_fenders_are_told(step_s: float, deep_mm: int) -> None:
    """Those of Runge-Kutta beyond its own 0.02 s; Euler's have none."""
    reference, steps = "physics.integrator=reference", f"physics.step_s={step_s}"
    assert told(PHYSICS, reference, steps) == [
        f'physics.step_s = {step_s} with physics.integrator = "reference": fenders are soft, and '
        f"1 m/s takes a hull {deep_mm} mm and more into a quay; give at most 0.02 s, or "
        'physics.integrator = "fast"'
    ]
    assert told(PHYSICS, steps) == told(PHYSICS, reference, "physics.step_s=0.02") == []


def test_moves_that_a_vessel_cannot_make_are_told_and_are_late() -> None:
    """20 m in 10 s at 1.94 m/s, after a turn of 90 degrees at 0.9 rad/s."""
    overrides = ("map.pitch_m=10", "horizon=4", "team.foragers.count=0", "team.scouts.count=1")
    (line,) = told(PHYSICS, *overrides)
    assert line == (
        "vessel scout of scouts: team.scouts.moves = 2 of 10 m take it 13.7 s, at 1.94 m/s after "
        "a turn of 90 degrees, and a decision has 10 s: moves will be late; give fewer moves, a "
        "longer period_s or a shorter map.pitch_m"
    )
    for pitch, least, most in ((10, 0.7, 1.0), (4, 0.0, 0.1)):
        setup = Setup.of(load_scenario("comb-port", (*overrides[1:], f"map.pitch_m={pitch}")))
        mission, policy = create_mission(setup, "hulls"), create_policy("lawnmower")
        mission.reset(0, np.arange(5))
        mission.prepare(policy)
        nodes, late = (setup.graph.rows, setup.graph.cols), []
        for _ in range(4):
            before = mission.state.agent_node.copy()
            mission.advance(mission.ask(policy))
            assert mission.moves is not None
            rows, cols = (at[mission.moves.target] - at[before] for at in nodes)
            late.append((mission.state.outcome == LATE)[np.maximum(abs(rows), abs(cols)) == 2])
        assert least <= np.concatenate(late).mean() <= most


def test_a_run_says_it_once(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    setup = Setup.of(load_scenario("comb-port", ("weather.gust_intensity=0.1", "horizon=2")))
    line = "weather.gust_intensity: not felt in world graph, and without effect in this run"
    with caplog.at_level(logging.WARNING):
        evaluate(setup, ["random", "greedy"], tmp_path / "run", episodes=60)
    assert caplog.messages.count(line) == 1
    caplog.clear()
    evaluate(setup, ["random", "greedy"], tmp_path / "run", episodes=60)  # it is all there
    assert line not in caplog.messages
