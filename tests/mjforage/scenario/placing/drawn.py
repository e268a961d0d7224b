"""Harbours drawn in metres about a point, and written in the formats that charts come in."""

import json
import struct
import zlib
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np
import shapely
from pyogrio.raw import write
from pyproj import Transformer

from mjforage.scenario.maps import GridMap
from mjforage.scenario.placing.making import Layout, make_place
from mjforage.scenario.placing.water import Choice

LAT, LON = 36.0, -5.6
Features = Sequence[tuple[Any, Mapping[str, str]]]
ABOUT = f"+proj=aeqd +lat_0={LAT} +lon_0={LON} +datum=WGS84 +units=m"


def on_globe(shape: Any, crs: str = "EPSG:4326") -> Any:
    """A shape in metres east and north of the point, in another system."""
    return shapely.transform(shape, lambda xy: np.stack(_onto(crs).transform(*xy.T), axis=-1))


@cache
def _onto(crs: str) -> Any:
    return Transformer.from_crs(ABOUT, crs, always_xy=True)


def box_deg(half_m: float) -> tuple[float, float, float, float]:
    """West, south, east and north of a square about the point."""
    west, south = on_globe(shapely.Point(-half_m, -half_m)).coords[0]
    east, north = on_globe(shapely.Point(half_m, half_m)).coords[0]
    return west, south, east, north


def geojson(path: Path, features: Features) -> Path:
    """Write GeoJSON."""
    tree = {
        "type": "FeatureCollection",
        "features": [
            {
                "type": "Feature",
                "properties": dict(tags),
                "geometry": shapely.geometry.mapping(on_globe(shape)),
            }
            for shape, tags in features
        ],
    }
    path.write_text(json.dumps(tree))
    return path


def written(path: Path, features: Features, crs: str = "EPSG:4326", **how: Any) -> Path:
    """Write the features, with the keys of the first, by GDAL: a GeoPackage or a Shapefile."""
    keys = list(features[0][1])
    columns = [np.array([tags.get(key) for _, tags in features], dtype=object) for key in keys]
    shapes = shapely.to_wkb(np.array([on_globe(shape, crs) for shape, _ in features]))
    write(path, shapes, columns, np.array(keys, dtype=object), crs=crs, **how)
    return path


def made(path: Path, pitch_m: float = 4.0, **more: Any) -> GridMap:
    """The place of a file; arguments are those of `Layout` and `Choice`."""
    own = {key: more.pop(key) for key in ("share", "crop", "rotation_deg") if key in more}
    points = more.pop("points", ())
    return make_place(path, Layout(pitch_m, **own), Choice(**more), points)


def place_of(grid: GridMap) -> Any:
    """Place of a map that has one."""
    assert grid.place is not None
    return grid.place


def _varint(value: int) -> bytes:
    found = b""
    while value > 127:
        found, value = found + bytes([value & 127 | 128]), value >> 7
    return found + bytes([value])


def _zigzag(value: int) -> int:
    return value << 1 if value >= 0 else (-value << 1) - 1


def _field(number: int, value: int | bytes) -> bytes:
    if isinstance(value, int):
        return _varint(number << 3) + _varint(value)
    return _varint(number << 3 | 2) + _varint(len(value)) + value


def _packed(values: Iterable[int]) -> bytes:
    return b"".join(map(_varint, values))


def _deltas(values: Sequence[int]) -> bytes:
    return _packed(_zigzag(int(step)) for step in np.diff(values, prepend=0))


def _blob(kind: bytes, block: bytes) -> bytes:
    blob = _field(2, len(block)) + _field(3, zlib.compress(block))
    header = _field(1, kind) + _field(3, len(blob))
    return struct.pack(">I", len(header)) + header + blob


def osm_pbf(path: Path, ways: Features, relations: Mapping[int, Any] | None = None) -> Path:
    """Write ways of one line or outline each as OpenStreetMap's protocol buffers (.osm.pbf).

    Ways are numbered from 1. Format: https://wiki.openstreetmap.org/wiki/PBF_Format

    Parameters
    ----------
    relations : of each number, the ways that are its members, with their roles, and its tags
    """
    texts, groups = [b""], b""
    nodes: list[tuple[float, ...]] = []

    def number(text: str) -> int:
        if text.encode() not in texts:
            texts.append(text.encode())
        return texts.index(text.encode())

    for k, (shape, tags) in enumerate(ways, 1):
        line = shapely.get_coordinates(on_globe(shape))
        closed = bool((line[0] == line[-1]).all())
        first = len(nodes) + 1
        nodes += [tuple(xy) for xy in (line[:-1] if closed else line)]
        references = [*range(first, len(nodes) + 1), *([first] if closed else [])]
        keys, values = (_packed(number(one[i]) for one in tags.items()) for i in (0, 1))
        way = _field(1, k) + _field(2, keys) + _field(3, values) + _field(8, _deltas(references))
        groups += _field(3, way)
    for k, (members, tags) in (relations or {}).items():
        keys, values = (_packed(number(one[i]) for one in tags.items()) for i in (0, 1))
        relation = _field(1, k) + _field(2, keys) + _field(3, values)
        relation += _field(8, _packed(number(role) for role in members.values()))
        relation += _field(9, _deltas([*members])) + _field(10, _packed([1] * len(members)))
        groups += _field(4, relation)
    degrees = np.rint(np.array(nodes) * 1e7).astype(np.int64)
    dense = _field(1, _deltas([*range(1, len(nodes) + 1)]))
    dense += _field(8, _deltas(degrees[:, 1].tolist())) + _field(9, _deltas(degrees[:, 0].tolist()))
    table = b"".join(_field(1, text) for text in texts)
    block = _field(1, table) + _field(2, _field(2, dense)) + _field(2, groups)
    head = _field(4, b"OsmSchema-V0.6") + _field(4, b"DenseNodes")
    path.write_bytes(_blob(b"OSMHeader", head) + _blob(b"OSMData", block))
    return path


def osm_xml(path: Path, features: Features, within: Any = None, more: str = "") -> Path:
    """Write lines and polygons as OpenStreetMap's XML, rings of polygons with holes in two ways.

    Parameters
    ----------
    within : box outside of which nodes are left out, as in an extract that cuts ways; None: none is
    more : XML of relations
    """
    text, number = {"node": "", "way": "", "relation": more}, 0

    def tagged(kind: str, inside: str, tags: Mapping[str, str]) -> int:
        nonlocal number
        number += 1
        words = "".join(f"<tag k={quoteattr(k)} v={quoteattr(v)}/>" for k, v in tags.items())
        text[kind] += f'<{kind} id="{number}" version="1">{inside}{words}</{kind}>\n'
        return number

    def way(line: Any, tags: Mapping[str, str]) -> int:
        nonlocal number
        nodes = []
        for x, y in shapely.get_coordinates(line):
            lon, lat = on_globe(shapely.Point(x, y)).coords[0]
            where = f"{lat:.9f}", f"{lon:.9f}"
            if where not in known:
                number += 1
                known[where] = number
                if within is None or within.covers(shapely.Point(x, y)):
                    at = f'lat="{where[0]}" lon="{where[1]}"'
                    text["node"] += f'<node id="{number}" version="1" {at}/>\n'
            nodes.append(known[where])
        return tagged("way", "".join(f'<nd ref="{one}"/>' for one in nodes), tags)

    known: dict[tuple[str, str], int] = {}
    for shape, tags in features:
        if shape.geom_type != "Polygon" or not shape.interiors:
            way(shape.exterior if shape.geom_type == "Polygon" else shape, tags)
            continue
        members = ""
        for role, ring in zip(("outer", *["inner"] * 9), shapely.get_rings(shape), strict=False):
            xy, half = shapely.get_coordinates(ring), len(ring.coords) // 2
            for part in (xy[: half + 1], xy[half:]):
                one = way(shapely.LineString(part), {})
                members += f'<member type="way" ref="{one}" role="{role}"/>'
        tagged("relation", members, {"type": "multipolygon", **tags})
    content = f"<?xml version='1.0' encoding='UTF-8'?>\n<osm version='0.6'>{''.join(text.values())}"
    path.write_text(f"{content}</osm>", encoding="utf-8")
    return path
