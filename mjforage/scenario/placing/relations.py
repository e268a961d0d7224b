"""Areas that GDAL leaves out of an extract of OpenStreetMap: relations whose ways it lacks."""

import itertools
import struct
import zlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree

_TYPES = ("multipolygon", "boundary")  # relations that GDAL makes areas of
_NO_OUTLINE = "subarea"  # role of members that are no part of it
_WAY = 1  # kind of a member, in protocol buffers
_BLOCK = 1 << 25  # bytes of a block, at most
_BROKEN = (
    *(KeyError, IndexError, TypeError, ValueError, struct.error, zlib.error),
    *(ElementTree.ParseError, MemoryError),
)


class _Relation(NamedTuple):
    """Tags of a relation, and the numbers of the ways that outline it."""

    tags: dict[str, str]
    ways: set[int]


def incomplete_areas(path: Path) -> list[dict[str, str]]:
    """Tags of the areas that lack ways, and ``osm_id``; none of a file that is not understood.

    Formats: https://wiki.openstreetmap.org/wiki/OSM_XML and .../PBF_Format
    """
    with path.open("rb") as file:
        xml = b"<" in file.read(16)  # no byte of the head of a file of protocol buffers
    there: set[int] = set()
    relations: list[_Relation] = []
    try:
        for one in _of_xml(path) if xml else _of_pbf(path):
            relations += [one] if isinstance(one, _Relation) else []
            there |= set() if isinstance(one, _Relation) else {one}
    except _BROKEN:
        return []
    return [one.tags for one in relations if one.tags.get("type") in _TYPES and one.ways - there]


def _of_xml(path: Path) -> Iterator[int | _Relation]:
    for _, one in ElementTree.iterparse(path):
        if one.tag == "way":
            yield int(one.get("id", 0))
        elif one.tag == "relation":
            tags = {tag.get("k", ""): tag.get("v", "") for tag in one.iter("tag")}
            members = [member.attrib for member in one.iter("member")]
            ways = {int(one["ref"]) for one in members if _outlines(one["type"], one.get("role"))}
            yield _Relation(tags | {"osm_id": one.get("id", "")}, ways)
        if one.tag in ("node", "way", "relation"):
            one.clear()


def _outlines(kind: str | int, role: str | None) -> bool:
    return kind in ("way", _WAY) and role != _NO_OUTLINE


def _of_pbf(path: Path) -> Iterator[int | _Relation]:
    with path.open("rb") as file:
        while size := file.read(4):
            head = dict(_fields(file.read(*struct.unpack(">I", size))))
            blob = dict(_fields(file.read(head[3])))
            if bytes(head[1]) == b"OSMData":
                yield from _of_block(
                    blob[1] if 1 in blob else zlib.decompressobj().decompress(blob[3], _BLOCK)
                )


def _of_block(block: bytes) -> Iterator[int | _Relation]:
    groups = [field for field in _fields(block) if field[0] == 2]
    texts = [bytes(text) for _, text in _fields(dict(_fields(block))[1])]
    for kind, one in itertools.chain.from_iterable(_fields(group) for _, group in groups):
        if kind == 3:
            yield next((value for name, value in _fields(one) if name == 1), 0)
        elif kind == 4:
            yield _relation(dict(_fields(one)), texts)


def _relation(fields: Mapping[int, Any], texts: Sequence[bytes]) -> _Relation:
    keys, values, roles, steps, kinds = (_varints(fields.get(n, b"")) for n in (2, 3, 8, 9, 10))
    tags = {
        texts[key].decode(): texts[value].decode() for key, value in zip(keys, values, strict=True)
    }
    numbers = itertools.accumulate(step >> 1 ^ -(step & 1) for step in steps)
    members = zip(numbers, kinds, roles, strict=True)
    ways = {way for way, kind, role in members if _outlines(kind, texts[role].decode())}
    return _Relation(tags | {"osm_id": str(fields[1])}, ways)


def _fields(data: Any) -> Iterator[tuple[int, Any]]:
    """Numbers and values of a message's fields: whole numbers, or views of bytes."""
    data, at = memoryview(data), 0
    while at < len(data):
        key, at = _varint(data, at)
        value, at = _varint(data, at)
        if key & 7 == 2:
            yield key >> 3, data[at : at + value]
            at += value
        else:
            yield key >> 3, value


def _varints(data: Any) -> list[int]:
    found, at = [], 0
    while at < len(data):
        value, at = _varint(data, at)
        found.append(value)
    return found


def _varint(data: Any, at: int) -> tuple[int, int]:
    value = shift = 0
    while data[at] > 127:
        value, shift, at = value | (data[at] & 127) << shift, shift + 7, at + 1
    return value | data[at] << shift, at + 1
