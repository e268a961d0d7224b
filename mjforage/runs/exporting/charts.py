"""Tracks for tables and charts: CSV, GeoJSON, GPX, and mission files of ArduPilot."""

import json
from typing import Any
from xml.etree import ElementTree

import numpy as np
import polars as pl
from numpy.typing import NDArray

from mjforage.mission.setup import Setup
from mjforage.runs.episode_recording import Recording
from mjforage.runs.exporting.tracks import Tracks

_HOME, _WAYPOINT = (0, 16), (3, 16)
"""Frame and command of a mission's first line and of its others: MAV_FRAME_GLOBAL,
MAV_FRAME_GLOBAL_RELATIVE_ALT, MAV_CMD_NAV_WAYPOINT (mavlink.io, common message set)."""


def csv_files(setup: Setup, recording: Recording) -> dict[str, bytes]:
    """`tracks.csv` of the vessels, a row per frame; `items.csv`, a row per item and decision."""
    tracks = Tracks(setup, recording)
    rows, items = vessel_rows(tracks), item_rows(tracks)
    return {"tracks.csv": rows.write_csv().encode(), "items.csv": items.write_csv().encode()}


def vessel_rows(tracks: Tracks) -> pl.DataFrame:
    """t_s, vessel, x_m, y_m, yaw_rad; of a place lat_deg, lon_deg, heading_deg; utc if known."""
    pose, count = tracks.recording.track_pose, tracks.vessels
    columns: dict[str, Any] = {
        **_times(tracks, tracks.t_s.repeat(count)),
        "vessel": [*tracks.recording.labels] * len(pose),
        **{name: pose[..., k].ravel() for k, name in enumerate(("x_m", "y_m", "yaw_rad"))},
    }
    if tracks.latlon is not None:
        columns |= _degrees(tracks.latlon[:, :count].reshape(-1, 2))
        columns |= {"heading_deg": tracks.heading_deg.ravel().round(3)}
    return pl.DataFrame(columns)


def item_rows(tracks: Tracks) -> pl.DataFrame:
    """t_s, item, x_m, y_m while it is on the water, and of a place lat_deg, lon_deg."""
    frame = tracks.decisions
    step, item = np.nonzero(tracks.recording.track_present[frame])
    xy = tracks.recording.track_items[frame][step, item]
    columns = _times(tracks, tracks.t_s[frame][step])
    columns |= {"item": item, "x_m": xy[:, 0], "y_m": xy[:, 1]}
    if tracks.latlon is not None:
        columns |= _degrees(tracks.latlon[frame, tracks.vessels :][step, item])
    return pl.DataFrame(columns)


def geojson_files(setup: Setup, recording: Recording) -> dict[str, bytes]:
    """`episode.geojson`: a line with times per vessel and per item (RFC 7946).

    Raises `UserError` if the map is no place.
    """
    tracks = Tracks(setup, recording)
    place, vessels = tracks.globe("geojson"), tracks.vessels
    lines = []
    for k, name in enumerate(tracks.names):
        item, frames = k - vessels, np.arange(len(tracks.t_s))
        properties: dict[str, Any] = {"name": name}
        if item < 0:
            team = recording.team_names[recording.agent_team[k]]
            properties |= {"kind": "vessel", "team": team, "hull": recording.vessels[k]}
        else:
            frames = tracks.decisions[tracks.present[tracks.decisions, k]]
            (found,), (taken,) = (
                tracks.stamps(one[item : item + 1])
                for one in (tracks.discovered_s, tracks.collected_s)
            )
            properties |= {"kind": "item", "discovered": found, "collected": taken}
        if len(frames):
            lines.append(_line(tracks, k, frames, properties))
    head = {"type": "FeatureCollection", "features": lines, "licence": place.licence}
    return {"episode.geojson": (json.dumps(head) + "\n").encode()}


def _line(
    tracks: Tracks, k: int, frames: NDArray[np.int64], properties: dict[str, Any]
) -> dict[str, Any]:
    """A feature of one track at some frames: a line, or a point if it is one frame."""
    assert tracks.latlon is not None
    points = tracks.latlon[frames, k, ::-1].round(8).tolist()
    shape = ("LineString", points) if len(points) > 1 else ("Point", points[0])
    return {
        "type": "Feature",
        "properties": properties | {"coordTimes": tracks.stamps(tracks.t_s[frames])},
        "geometry": dict(zip(("type", "coordinates"), shape, strict=True)),
    }


def gpx_files(setup: Setup, recording: Recording) -> dict[str, bytes]:
    """`episode.gpx`: a route of waypoints and a track per vessel (GPX 1.1).

    Raises `UserError` if the map is no place.
    """
    tracks = Tracks(setup, recording)
    tracks.globe("gpx")
    assert tracks.latlon is not None
    space = {"version": "1.1", "creator": "mjforage", "xmlns": "http://www.topografix.com/GPX/1/1"}
    gpx = ElementTree.Element("gpx", space)
    for k, name in enumerate(recording.labels):
        route = _named(gpx, "rte", name)
        for latlon in _waypoints(tracks, k):
            _point(route, "rtept", latlon)
    for k, name in enumerate(recording.labels):
        segment = ElementTree.SubElement(_named(gpx, "trk", name), "trkseg")
        for latlon, stamp in zip(tracks.latlon[:, k], tracks.stamps(tracks.t_s), strict=True):
            ElementTree.SubElement(_point(segment, "trkpt", latlon), "time").text = stamp
    ElementTree.indent(gpx)
    text = ElementTree.tostring(gpx, encoding="utf-8", xml_declaration=True)
    return {"episode.gpx": text + b"\n"}


def _named(parent: ElementTree.Element, kind: str, name: str) -> ElementTree.Element:
    element = ElementTree.SubElement(parent, kind)
    ElementTree.SubElement(element, "name").text = name
    return element


def _point(parent: ElementTree.Element, kind: str, latlon: NDArray[np.float64]) -> Any:
    lat, lon = (f"{degrees:.8f}" for degrees in latlon)
    return ElementTree.SubElement(parent, kind, lat=lat, lon=lon)


def qgc_files(setup: Setup, recording: Recording) -> dict[str, bytes]:
    """A mission file per vessel, `NAME.waypoints` (QGC WPL 110, as ArduPilot loads it).

    Raises `UserError` if the map is no place.
    """
    tracks = Tracks(setup, recording)
    tracks.globe("qgc")
    files = {}
    for k, name in enumerate(recording.labels):
        lines = ["QGC WPL 110"]
        for index, (lat, lon) in enumerate(_waypoints(tracks, k)):
            frame, command = _WAYPOINT if index else _HOME
            where = f"{lat:.8f}", f"{lon:.8f}", "0.000000"
            words = index, int(index == 0), frame, command, *("0.00000000",) * 4, *where, 1
            lines.append("\t".join(map(str, words)))
        files[f"{name}.waypoints"] = ("\n".join(lines) + "\n").encode()
    return files


def _waypoints(tracks: Tracks, vessel: int) -> NDArray[np.float64]:
    """(waypoint, 2) latitude and longitude of the nodes a vessel was told; a stay is none."""
    place = tracks.globe("waypoints")
    nodes = tracks.told[:, vessel]
    moved = np.r_[True, (np.diff(nodes, axis=0) != 0).any(axis=1)]
    return place.latlon(nodes[moved])


def _times(tracks: Tracks, t_s: NDArray[np.float64]) -> dict[str, Any]:
    """Times from the start, and utc of an episode that plays a record."""
    known = tracks.recording.begins_s is not None
    return {"t_s": t_s} | ({"utc": tracks.stamps(t_s)} if known else {})


def _degrees(latlon: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    return {"lat_deg": latlon[:, 0].round(8), "lon_deg": latlon[:, 1].round(8)}
