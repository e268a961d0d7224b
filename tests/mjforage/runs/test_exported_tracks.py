"""Episodes in the formats of other programs, read by readers that are not ours."""

import itertools
import json
from collections.abc import Callable
from datetime import datetime
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import polars as pl
import pytest
import shapely
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

import mjforage as mf
from mjforage.base.errors import UserError
from mjforage.runs.episode_recording import Recording
from mjforage.runs.exporting.ros import Message, messages
from mjforage.runs.exporting.tracks import Tracks
from tests.mjforage.scenario.placing.drawn import geojson

SHORT: dict[str, Any] = {"horizon": 30, "items": {"mean": 30.0, "std": 0.0}}
FORMATS = "csv", "geojson", "gpx", "mcap", "netcdf", "qgc"


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> mf.Run:
    """A run in both worlds on a place that is rotated by 10 degrees."""
    folder = tmp_path_factory.mktemp("harbour")
    shape = shapely.affinity.rotate(shapely.box(-60, -40, 60, 40), -10.0, origin=(0, 0))
    source = geojson(folder / "basin.geojson", [(shape, {"natural": "water"})])
    place = mf.Map.of_chart(source, folder / "port", pitch_m=4.0, rotate="auto")
    scenario = mf.load_scenario("open-bay", map=place, **SHORT)
    return mf.compare(scenario, ["greedy"], episodes=1, folder=folder / "run")


@pytest.fixture(scope="module")
def made(run: mf.Run, tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Folder of a format, of the episode in MuJoCo; made once."""
    done: dict[str, Path] = {}
    folder = tmp_path_factory.mktemp("exports")

    def one(to: str) -> Path:
        if to not in done:
            done[to] = run.export(folder / to, to, world="physics")
        return done[to]

    return one


@pytest.fixture(scope="module")
def recording(run: mf.Run) -> Recording:
    return run.recording("greedy", world="physics")


@pytest.fixture(scope="module")
def latlon(run: mf.Run, recording: Recording) -> np.ndarray[Any, Any]:
    """(frame, vessel, 2), made here from poses in metres."""
    place = run.scenario.map.place
    assert place is not None
    x, y = np.moveaxis(recording.track_pose[..., :2].astype(np.float64), -1, 0)
    cells = np.stack((place.rows - 1 - y / place.pitch_m, x / place.pitch_m), axis=-1)
    return place.latlon(cells)


def test_tables_have_every_pose_and_item(
    made: Callable[[str], Path], recording: Recording, latlon: np.ndarray[Any, Any]
) -> None:
    tracks = pl.read_csv(made("csv") / "tracks.csv")
    columns = ["x_m", "y_m", "yaw_rad"]
    given = tracks.select(columns).to_numpy()
    np.testing.assert_allclose(given, recording.track_pose.reshape(-1, 3), atol=1e-6)
    degrees = tracks.select("lat_deg", "lon_deg").to_numpy()
    np.testing.assert_allclose(degrees, latlon.reshape(-1, 2), atol=1e-8)
    assert tracks["t_s"].max() == pytest.approx(30 * recording.period_s)
    items = pl.read_csv(made("csv") / "items.csv")
    for step, there in enumerate(recording.item_present):
        now = items.filter(pl.col("t_s") == step * recording.period_s)
        assert now["item"].to_list() == np.flatnonzero(there).tolist()


def test_a_bow_to_the_right_of_a_map_turned_to_010_points_to_100(
    made: Callable[[str], Path], latlon: np.ndarray[Any, Any]
) -> None:
    """Headings are bearings of true north: along the way of a vessel that goes ahead."""
    tracks = pl.read_csv(made("csv") / "tracks.csv")
    yaw, heading = tracks["yaw_rad"].to_numpy(), tracks["heading_deg"].to_numpy()
    np.testing.assert_allclose((heading + np.degrees(yaw)) % 360, 100.0, atol=0.02)
    north, east = np.moveaxis(np.diff(latlon[::10], axis=0), -1, 0)
    way = np.degrees(np.arctan2(east * np.cos(np.radians(latlon[0, 0, 0])), north)) % 360
    far = np.hypot(north, east) * 111e3 > 4.0
    bow = heading.reshape(len(latlon), -1)[5::10]
    off = (bow - way + 180) % 360 - 180
    assert far.sum() > 10
    assert np.median(np.abs(off[far])) < 20


def test_a_geojson_has_tracks_with_times(
    made: Callable[[str], Path], recording: Recording, latlon: np.ndarray[Any, Any]
) -> None:
    tree = json.loads((made("geojson") / "episode.geojson").read_text())
    found = {one["properties"]["name"]: one for one in tree["features"]}
    assert [*found][:4] == [*recording.labels]
    assert len(found) == 4 + recording.item_present.any(axis=0).sum()
    for k, name in enumerate(recording.labels):
        line = shapely.geometry.shape(found[name]["geometry"])
        np.testing.assert_allclose(shapely.get_coordinates(line), latlon[:, k, ::-1], atol=1e-8)
        times = [datetime.fromisoformat(one) for one in found[name]["properties"]["coordTimes"]]
        assert len(times) == len(latlon)
        assert (times[-1] - times[0]).total_seconds() == pytest.approx(30 * recording.period_s)
    taken = [
        one["properties"]["collected"]
        for one in tree["features"]
        if one["properties"]["kind"] == "item"
    ]
    gone = recording.item_present[0] & ~recording.item_present[-1]
    assert sum(one is not None for one in taken) == gone.sum() > 0


def test_a_gpx_has_routes_and_tracks(
    made: Callable[[str], Path], latlon: np.ndarray[Any, Any]
) -> None:
    root = ElementTree.parse(made("gpx") / "episode.gpx").getroot()
    space = {"": "http://www.topografix.com/GPX/1/1"}
    for k, track in enumerate(root.findall("trk", space)):
        points = [
            (float(p.attrib["lat"]), float(p.attrib["lon"])) for p in track.iter() if p.attrib
        ]
        np.testing.assert_allclose(points, latlon[:, k], atol=1e-8)
    assert len(root.findall("rte", space)) == len(root.findall("trk", space)) == 4


def test_a_mission_file_leads_to_the_nodes(
    made: Callable[[str], Path], run: mf.Run, recording: Recording
) -> None:
    place = run.scenario.map.place
    assert place is not None
    for k, name in enumerate(recording.labels):
        head, *lines = (made("qgc") / f"{name}.waypoints").read_text().splitlines()
        assert head == "QGC WPL 110"
        rows = [line.split("\t") for line in lines]
        assert [int(row[0]) for row in rows] == [*range(len(rows))]
        assert {len(row) for row in rows} == {12}
        assert [row[1:4] for row in rows] == [
            ["1", "0", "16"],
            *[["0", "3", "16"]] * (len(rows) - 1),
        ]
        cells = place.cells([[float(word) for word in row[8:10]] for row in rows])
        assert recording.agent_target is not None
        nodes = np.argwhere(recording.navigable)[recording.agent_target[:, k]]
        way = [nodes[0], *(b for a, b in itertools.pairwise(nodes) if (a != b).any())]
        np.testing.assert_allclose(cells, way, atol=1e-3)


def test_waypoints_and_decisions_are_what_a_late_hull_was_told(run: mf.Run, tmp_path: Path) -> None:
    """Not where it was when the next decision was made."""
    late = mf.evaluate(
        run.scenario, "greedy", world="physics", episodes=1, period_s=3.0, folder=tmp_path / "run"
    )
    shown, place = late.recording(), run.scenario.map.place
    assert place is not None
    agents = late.agents.sort("agent", "step")
    water = np.argwhere(shown.navigable)
    for k, name in enumerate(shown.labels):
        told = water[agents.filter(pl.col("agent") == k)["target"].to_numpy()]
        came = np.rint(shown.agent_rc[:, k])
        assert (told != came).any()
        way = [told[0], *(b for a, b in itertools.pairwise(told) if (a != b).any())]
        late.export(tmp_path / f"{k}", "qgc")
        lines = (tmp_path / f"{k}" / f"{name}.waypoints").read_text().splitlines()[1:]
        cells = place.cells([[float(word) for word in line.split("\t")[8:10]] for line in lines])
        np.testing.assert_allclose(cells, way, atol=1e-3)
        decisions = [
            json.loads(one.content["data"])
            for one in messages(Tracks(late.scenario, shown))
            if one.topic == f"/{name}/decision"
        ]
        assert [one["to"] for one in decisions] == told[1:].tolist()
        np.testing.assert_allclose(
            place.cells([one["to_latlon"] for one in decisions]), told[1:], atol=1e-3
        )
    assert shown.agent_target is not None
    old = Recording(**vars(shown) | {"agent_target": None})
    (tmp_path / "old.npz").write_bytes(old.content())
    again = Recording.load(tmp_path / "old.npz")
    assert again.agent_target is None
    np.testing.assert_array_equal(Tracks(late.scenario, again).told, np.rint(shown.agent_rc))
    (tmp_path / "far.npz").write_bytes(
        Recording(**vars(shown) | {"agent_target": shown.agent_target + 10**6}).content()
    )
    with pytest.raises(UserError, match="agent_target is no node"):
        Recording.load(tmp_path / "far.npz")


def plain(value: Any) -> Any:
    """A message of rosbags as dictionaries and lists."""
    if hasattr(value, "__dataclass_fields__"):
        fields = [one for one in value.__dataclass_fields__ if one != "__msgtype__"]
        return {name: plain(getattr(value, name)) for name in fields}
    if isinstance(value, np.ndarray):
        return value.tolist()
    return [plain(one) for one in value] if isinstance(value, list | tuple) else value


def same(given: Any, read: Any) -> bool:
    """True if all that was given was read; what was not given is zero or empty."""
    if isinstance(given, dict):
        rest = [value for key, value in read.items() if key not in given]
        return all(same(value, read[key]) for key, value in given.items()) and empty(rest)
    if isinstance(given, list):
        return len(given) == len(read) and all(map(same, given, read))
    return bool(given == read or read == pytest.approx(given, rel=1e-6))


def empty(value: Any) -> bool:
    inner = value.values() if isinstance(value, dict) else value
    return all(map(empty, inner)) if isinstance(value, dict | list) else not value


def test_a_bag_comes_back_message_by_message(
    made: Callable[[str], Path], run: mf.Run, recording: Recording
) -> None:
    written: list[Message] = [*messages(Tracks(run.scenario, recording))]
    with AnyReader([made("mcap")]) as bag:
        read = [
            (where.topic, t, bag.deserialize(data, where.msgtype))
            for where, t, data in bag.messages()
        ]
    assert len(read) == len(written)
    by_topic: dict[str, list[Any]] = {}
    for topic, time_ns, content in read:
        by_topic.setdefault(topic, []).append((time_ns, content))
    for one in written:
        time_ns, content = by_topic[one.topic].pop(0)
        assert time_ns == one.time_ns
        assert same(one.content, plain(content)), one
    assert {"/map", "/belief", "/items", "/hulls", "/tf"} < {*by_topic}
    assert {
        f"/{name}/{t}" for name in recording.labels for t in ("odom", "fix", "pose", "decision")
    } < {*by_topic}


def test_the_definitions_of_messages_are_those_of_ros(made: Callable[[str], Path]) -> None:
    """Hashes of types are equal to those that ROS 2 ships; they cover fields and their order."""
    known = get_typestore(Stores.ROS2_JAZZY)
    with AnyReader([made("mcap")]) as bag:
        kinds = {where.msgtype for where in bag.connections}
        assert len(kinds) == 7
        for kind in kinds:
            assert bag.typestore.hash_rihs01(kind) == known.hash_rihs01(kind)


def test_poses_and_speeds_of_a_bag(
    made: Callable[[str], Path], recording: Recording, latlon: np.ndarray[Any, Any]
) -> None:
    name = recording.labels[0]
    with AnyReader([made("mcap")]) as bag:
        got = {
            topic: [
                bag.deserialize(data, where.msgtype)
                for where, _, data in bag.messages([c for c in bag.connections if c.topic == topic])
            ]
            for topic in (f"/{name}/odom", f"/{name}/fix", "/map", "/belief")
        }
    odom: list[Any] = got[f"/{name}/odom"]
    at = np.array([[o.pose.pose.position.x, o.pose.pose.position.y] for o in odom])
    np.testing.assert_allclose(at, recording.track_pose[:, 0, :2], atol=1e-6)
    turn = np.array([[o.pose.pose.orientation.w, o.pose.pose.orientation.z] for o in odom])
    yaw = 2 * np.arctan2(turn[:, 1], turn[:, 0])
    away = np.exp(1j * (yaw - recording.track_pose[:, 0, 2]))
    np.testing.assert_allclose(away, 1.0, atol=1e-5)
    ahead = np.array([o.twist.twist.linear.x for o in odom])
    way = np.hypot(*np.diff(at, axis=0).T).sum()
    assert np.abs(ahead).sum() * recording.frame_s == pytest.approx(way, rel=0.05)
    fixes: list[Any] = got[f"/{name}/fix"]
    np.testing.assert_allclose([[f.latitude, f.longitude] for f in fixes], latlon[:, 0], atol=1e-9)
    chart: Any = got["/map"][0]
    grid = np.array(chart.data).reshape(chart.info.height, chart.info.width)
    assert ((grid[::-1] == 0) == recording.navigable).all()
    believed: Any = got["/belief"][-1]
    grid = np.array(believed.data).reshape(believed.info.height, believed.info.width)[::-1]
    assert (grid[recording.navigable] == recording.belief[-1][recording.navigable]).all()


@pytest.mark.parametrize("to", FORMATS)
def test_an_episode_at_graph_level_and_a_start_can_be_exported(
    run: mf.Run, tmp_path: Path, to: str
) -> None:
    assert any(run.export(tmp_path / "graph", to, world="graph").iterdir())
    assert any(run.scenario.export(tmp_path / "start", to).iterdir())


def test_a_map_without_a_place(tmp_path: Path) -> None:
    """Metres alone where the format can do with them; else one line, before anything is written."""
    port = mf.load_scenario("comb-port", horizon=2)
    for to in ("csv", "netcdf", "mcap"):
        assert any(port.export(tmp_path / to, to).iterdir())
    assert "lat_deg" not in pl.read_csv(tmp_path / "csv" / "tracks.csv").columns
    for to in ("geojson", "gpx", "qgc"):
        with pytest.raises(UserError, match=f"format {to}: needs latitude and longitude; map comb"):
            port.export(tmp_path / to, to)
        assert not (tmp_path / to).exists()


def test_an_unknown_format_names_those_there_are(run: mf.Run, tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"format rosbag: unknown; .*mcap"):
        run.export(tmp_path / "bag", "rosbag")


def test_topics_have_letters_that_ros_allows(tmp_path: Path) -> None:
    role = {"count": 1, "moves": 1, "radius": 2.0, "collects": True}
    port = mf.load_scenario("comb-port", horizon=2, team={"tug-boats": role})
    with AnyReader([port.export(tmp_path / "bag", "mcap")]) as bag:
        assert "/tug_boats_0/odom" in bag.topics
        assert not any("-" in topic for topic in bag.topics)
