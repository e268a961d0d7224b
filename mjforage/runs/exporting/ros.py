"""An episode as messages of ROS 2, in the order of time, and as a bag of them (MCAP)."""

import io
import json
from collections import Counter
from collections.abc import Iterator
from functools import lru_cache
from importlib import resources
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.extras import require
from mjforage.mission.setup import Setup
from mjforage.runs.episode_recording import Recording
from mjforage.runs.exporting.tracks import Tracks

BAG = "episode.mcap"
_FRAME = "map"
_SPHERES, _CUBE = 7, 1  # types of a marker
_ORANGE, _BLUE, _GREEN = (0.9, 0.45, 0.1), (0.1, 0.45, 0.9), (0.1, 0.65, 0.3)
_ITEM_M, _HULL_M = 0.4, 0.3  # how wide items and how high hulls are shown


class Message(NamedTuple):
    """A message of a topic."""

    time_ns: int
    topic: str
    kind: str
    content: dict[str, Any]


def messages(tracks: Tracks) -> Iterator[Message]:
    """All messages of an episode: bodies every frame, map, belief and decisions every decision.

    Their frame is `map`: metres from the centre of the south-west cell, x to the right along a
    row, y up along a column.
    """
    step = {int(frame): k for k, frame in enumerate(tracks.decisions)}
    for frame in range(len(tracks.t_s)):
        now = _Moment(tracks, frame)
        if frame in step:
            yield from now.decided(step[frame])
        yield from now.bodies()


class _Moment:
    """Messages of one frame."""

    def __init__(self, tracks: Tracks, frame: int) -> None:
        self.tracks, self.frame = tracks, frame
        self.time_ns = round(tracks.begins_s * 1e3) * 10**6 + round(tracks.t_s[frame] * 1e9)

    def of(self, topic: str, kind: str, **content: Any) -> Message:
        """A message of this moment."""
        return Message(self.time_ns, topic, kind, content)

    def header(self, frame: str = _FRAME) -> dict[str, Any]:
        """Its header."""
        sec, nanosec = divmod(self.time_ns, 10**9)
        return {"stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": frame}

    def bodies(self) -> Iterator[Message]:
        """Poses of the vessels in every form that viewers ask for, and the items."""
        tracks, recording = self.tracks, self.tracks.recording
        poses, rates = recording.track_pose[self.frame].tolist(), tracks.rate[self.frame]
        transforms = []
        for k, name in enumerate(recording.labels):
            (x, y, yaw), pose = poses[k], _pose(*poses[k])
            moved = {"translation": _xyz(x, y), "rotation": pose["orientation"]}
            child = {"child_frame_id": name}
            transforms.append({"header": self.header(), "transform": moved} | child)
            ahead, turn = rates[k, :2] @ _axes(yaw), float(rates[k, 2])
            twist = {"linear": _xyz(*ahead.tolist()), "angular": _xyz(0.0, 0.0, turn)}
            moving = {"header": self.header(), "pose": {"pose": pose}, "twist": {"twist": twist}}
            yield self.of(f"/{_word(name)}/odom", "nav_msgs/Odometry", **moving, **child)
            placed = {"header": self.header(), "pose": pose}
            yield self.of(f"/{_word(name)}/pose", "geometry_msgs/PoseStamped", **placed)
            if tracks.latlon is not None:
                lat, lon = tracks.latlon[self.frame, k].tolist()
                fix = {"header": self.header(name), "latitude": lat, "longitude": lon}
                yield self.of(f"/{_word(name)}/fix", "sensor_msgs/NavSatFix", **fix)
        yield self.of("/tf", "tf2_msgs/TFMessage", transforms=transforms)
        there = recording.track_present[self.frame]
        points = [_xyz(x, y) for x, y in recording.track_items[self.frame][there].tolist()]
        items = self._marker(_FRAME, 0, _SPHERES, (_ITEM_M,) * 3, _ORANGE, points)
        yield self.of("/items", "visualization_msgs/MarkerArray", markers=[items])

    def decided(self, step: int) -> Iterator[Message]:
        """Map, belief, hulls, and where each vessel decided to go at a step."""
        tracks, recording = self.tracks, self.tracks.recording
        water = recording.navigable
        yield self._grid("/map", np.where(water, 0, 100))
        believed = np.where(water, recording.belief[step].clip(0, 100), -1)
        yield self._grid("/belief", believed)
        hulls = []
        for k, (name, hull) in enumerate(zip(recording.labels, tracks.hulls, strict=True)):
            size = hull.length_m, hull.beam_m, _HULL_M
            colour = _GREEN if recording.agent_collects[k] else _BLUE
            hulls.append(self._marker(name, k, _CUBE, size, colour, []))
        yield self.of("/hulls", "visualization_msgs/MarkerArray", markers=hulls)
        if step + 1 < len(recording.agent_rc):
            nodes = np.rint(recording.agent_rc[step]).astype(int), tracks.told[step + 1]
            for k, name in enumerate(recording.labels):
                words: dict[str, Any] = {"t_s": tracks.t_s[self.frame].item(), "step": step}
                words |= {"from": nodes[0][k].tolist(), "to": nodes[1][k].tolist()}
                if tracks.place:
                    words["to_latlon"] = tracks.place.latlon(nodes[1][k]).round(8).tolist()
                yield self.of(f"/{_word(name)}/decision", "std_msgs/String", data=json.dumps(words))

    def _grid(self, topic: str, values: NDArray[np.integer]) -> Message:
        """A grid; its rows count upwards from the south-west corner."""
        recording = self.tracks.recording
        (rows, columns), pitch_m = values.shape, recording.pitch_m
        info = {
            "map_load_time": self.header()["stamp"],
            "resolution": pitch_m,
            "width": columns,
            "height": rows,
            "origin": _pose(-0.5 * pitch_m, -0.5 * pitch_m, 0.0),
        }
        data = values[::-1].ravel().tolist()
        return self.of(topic, "nav_msgs/OccupancyGrid", header=self.header(), info=info, data=data)

    def _marker(
        self,
        frame: str,
        number: int,
        kind: int,
        size: tuple[float, float, float],
        colour: tuple[float, float, float],
        points: list[dict[str, float]],
    ) -> dict[str, Any]:
        return {
            "header": self.header(frame),
            "id": number,
            "type": kind,
            "pose": _pose(0.0, 0.0, 0.0),
            "scale": _xyz(*size),
            "color": dict(zip("rgba", (*colour, 1.0), strict=True)),
            "frame_locked": True,
            "points": points,
        }


def _word(name: str) -> str:
    """A name as a part of a topic, which ROS 2 allows letters, digits and underscores."""
    return name.replace("-", "_")


def _axes(yaw: float) -> NDArray[np.float64]:
    """Ahead and to port, as columns."""
    cos, sin = np.cos(yaw), np.sin(yaw)
    return np.array([[cos, -sin], [sin, cos]])


def _xyz(x: float, y: float, z: float = 0.0) -> dict[str, float]:
    return {"x": x, "y": y, "z": z}


def _pose(x: float, y: float, yaw: float) -> dict[str, Any]:
    turn = {"z": float(np.sin(0.5 * yaw)), "w": float(np.cos(0.5 * yaw))}
    return {"position": _xyz(x, y), "orientation": {"x": 0.0, "y": 0.0} | turn}


def mcap_files(setup: Setup, recording: Recording) -> dict[str, bytes]:
    """`episode.mcap`, `metadata.yaml` that makes a bag of rosbag2 of it, a layout for Foxglove."""
    bag, kinds, counts = io.BytesIO(), {}, Counter[str]()
    tracks = Tracks(setup, recording)
    writer, schemas = _writer(bag), {}
    for one in messages(tracks):
        if one.kind not in schemas:
            package, name = one.kind.split("/")
            definition = _definition(one.kind)
            schemas[one.kind] = writer.register_msgdef(f"{package}/msg/{name}", definition)
        kinds[one.topic] = schemas[one.kind].name
        counts[one.topic] += 1
        where = (one.topic, schemas[one.kind], one.content)
        writer.write_message(*where, log_time=one.time_ns, sequence=counts[one.topic])
    writer.finish()
    start, last = (_Moment(tracks, frame).time_ns for frame in (0, len(tracks.t_s) - 1))
    return {
        BAG: bag.getvalue(),
        "metadata.yaml": _metadata(kinds, counts, start, last - start).encode(),
        "foxglove-layout.json": (json.dumps(_layout(tracks), indent=1) + "\n").encode(),
    }


def _writer(stream: io.BytesIO) -> Any:
    require("format mcap", "mcap", "mcap_ros2")
    from mcap_ros2.writer import Writer

    return Writer(stream)


@lru_cache(maxsize=32)
def _definition(kind: str) -> str:
    """Definition of a kind of message, then those of its parts."""
    text = resources.files(__package__).joinpath("ros2.msg").read_text(encoding="utf-8")
    known = dict(block.split("\n", 1) for block in text.split("MSG: ")[1:])
    wanted = [kind]
    for name in wanted:
        words = [line.split()[0].split("[")[0] for line in known[name].splitlines()]
        wanted += [word for word in words if word in known and word not in wanted]
    rule = "=" * 80
    return known[kind] + "".join(f"{rule}\nMSG: {name}\n{known[name]}" for name in wanted[1:])


def _metadata(kinds: dict[str, str], counts: Counter[str], start_ns: int, long_ns: int) -> str:
    """`metadata.yaml` of rosbag2, version 5."""
    times = (
        f"starting_time:\n    nanoseconds_since_epoch: {start_ns}",
        f"duration:\n    nanoseconds: {long_ns}",
        f"message_count: {counts.total()}",
    )
    lines = ["rosbag2_bagfile_information:", "  version: 5", "  storage_identifier: mcap"]
    lines += ["  compression_format: ''", "  compression_mode: ''"]
    lines += [f"  relative_file_paths: [{BAG}]", *(f"  {one}" for one in times)]
    lines += ["  topics_with_message_count:"]
    for topic, count in sorted(counts.items()):
        about = f"name: {topic}, type: {kinds[topic]}, serialization_format: cdr"
        named = f"topic_metadata: {{{about}, offered_qos_profiles: ''}}"
        lines.append(f"    - {{{named}, message_count: {count}}}")
    nested = (one.replace("\n    ", "\n        ") for one in times)
    lines += ["  files:", f"    - path: {BAG}", *(f"      {one}" for one in nested)]
    return "\n".join(lines) + "\n"


def _layout(tracks: Tracks) -> dict[str, Any]:
    """A layout of Foxglove: the scene from above, and a chart if the map is a place."""
    seen = {topic: {"visible": True} for topic in ("/map", "/belief", "/items", "/hulls")}
    scene = {
        "followTf": _FRAME,
        "followMode": "follow-none",
        "cameraState": {"perspective": False, "distance": 0.8 * np.ptp(tracks.xy_m).item()},
        "topics": seen,
    }
    panels: dict[str, Any] = {"3D!scene": scene}
    arranged: Any = "3D!scene"
    if tracks.place:
        panels["map!chart"] = {"followTopic": f"/{tracks.recording.labels[0]}/fix"}
        arranged = {"first": arranged, "second": "map!chart", "direction": "row"}
    return {"configById": panels, "layout": arranged, "globalVariables": {}, "userNodes": {}}
