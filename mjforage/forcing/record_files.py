"""Records of wind and current in files: CSV, NDBC's standard meteorological text, and NetCDF.

Wind is named by where it comes from and current by where it goes to; both are kept as velocities,
east and north. Times are UTC. Missing values, 99, 999 or empty, leave out their time.
"""

import csv
import hashlib
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.forcing.record_content import MEANS_OVER_GUSTS, Content, intensity
from mjforage.scenario.bearings import flow_direction, wind_direction

FloatArray = NDArray[np.float64]
LONGEST_S = 3600.0  # between two times
COLUMNS = "time", "wind_speed_mps", "wind_from_deg", "current_speed_mps", "current_to_deg"
_MISSING = {"speed": (99.0, 999.0), "direction": (999.0,)}  # NDBC's; 99 degrees is a direction
_FASTEST = {"wind": 75.0, "current": 10.0}  # [m/s] of what is taken for a speed
_NDBC = {"YY": "year", "YYYY": "year", "MM": "month", "DD": "day", "hh": "hour", "mm": "minute"}


@dataclass(frozen=True, eq=False)
class Recorded:
    """Content of a record; a part that it has not is None."""

    name: str  # for messages
    sha256: str
    times_s: FloatArray  # (time,) UTC, since 1970
    wind: FloatArray | None  # (time, row, column, 2) where the air goes, east and north [m/s]
    current: FloatArray | None  # alike of the water
    latitude: FloatArray  # (row,) ascending; NaN of a point at an unknown place
    longitude: FloatArray  # (column,) ascending without a jump, so that it may go beyond 180
    gusts: FloatArray | None = None  # (time, row, column) standard deviation over the wind's speed
    height_m: float | None = None  # of the wind above the water, if the file has it


def read_record(file: str) -> Recorded:
    """Read a record, once as long as the file stays the same.

    Raises `UserError` if it cannot be read, is malformed, or has a gap of more than an hour.
    """
    path = Path(file)
    try:
        found = path.stat()
        return _read(path, found.st_mtime_ns, found.st_size)
    except (OSError, ValueError) as error:
        raise UserError(
            f"record {file}: cannot be read ({error}); give weather.file a file"
        ) from error


@lru_cache(maxsize=4)
def _read(path: Path, _changed: int, _size: int) -> Recorded:
    content, name = path.read_bytes(), f"record {path}"
    if content[:4] in (b"CDF\x01", b"CDF\x02", b"\x89HDF"):
        from mjforage.forcing.record_netcdf import netcdf_parts  # xarray where it is wanted

        found = netcdf_parts(path, content[:3] == b"CDF", name)
    else:
        try:
            lines = content.decode("utf-8-sig").splitlines()
        except UnicodeDecodeError as error:
            raise UserError(f"{name}: is neither NetCDF nor UTF-8 text; give a CSV file") from error
        read = _csv if lines and "," in lines[0] else _ndbc
        try:
            found = _columns(list(read(lines, name)), name)
        except csv.Error as error:
            raise UserError(f"{name}: is no CSV that can be read ({error})") from error
    times, parts, gusts = found.times_s, found.parts, found.parts.pop("gusts", None)
    if not parts:
        raise UserError(f"{name}: has neither wind nor current; give {', '.join(COLUMNS)}")
    kept = np.logical_and.reduce([np.isfinite(p).all(axis=(1, 2, 3)) for p in parts.values()])
    times, parts = times[kept], {key: np.ascontiguousarray(p[kept]) for key, p in parts.items()}
    if gusts is not None and np.isfinite(gusts := gusts[kept]).any():
        gusts = np.where(np.isfinite(gusts), gusts, np.nanmedian(gusts))
    else:
        gusts = None
    if times.size < 2:
        raise UserError(f"{name}: has {times.size} times with all values, at least 2 are needed")
    apart = np.diff(times)
    if (apart <= 0.0).any():
        when = np.datetime64(int(times[1:][apart <= 0.0][0]), "s")
        raise UserError(f"{name}: {when} comes twice, or late; sort the times")
    if apart.max() > LONGEST_S:
        i = int(np.argmax(apart > LONGEST_S))
        first, last = (np.datetime64(int(t), "s") for t in times[[i, i + 1]])
        raise UserError(
            f"{name}: has a gap of {apart[i] / 3600:.3g} h from {first} to {last}; give a record "
            "without gaps of more than an hour, or a part of this one"
        )
    for part, velocity in parts.items():
        if (most := np.hypot(velocity[..., 0], velocity[..., 1]).max()) > _FASTEST[part]:
            raise UserError(f"{name}: a {part} of {most:.4g} m/s; check its units")
    sha = hashlib.sha256(content).hexdigest()
    about = parts.get("wind"), parts.get("current"), found.latitude, found.longitude
    return Recorded(name, sha, times, *about, gusts, found.height_m)


Row = tuple[float, dict[str, float]]  # time [s], column -> value, NaN where it is missing


def seconds_of(text: str, where: str) -> float:
    """UTC of an ISO 8601 time, since 1970 [s].

    Raises `UserError` if it is none, or in another zone.
    """
    try:
        when = datetime.fromisoformat(text.strip())
    except ValueError as error:
        raise UserError(
            f"{where}: {text!r} is no ISO 8601 time, such as 2024-06-01T08:00"
        ) from error
    if when.utcoffset() not in (None, timedelta(0)):
        raise UserError(f"{where}: {text} is not UTC; give times in UTC")
    return when.replace(tzinfo=UTC).timestamp()


def utc(seconds: float, timespec: str = "auto") -> str:
    """ISO 8601 of seconds since 1970, such as 2024-06-01T08:00:00Z; in no other unit of time."""
    when = datetime(1970, 1, 1) + timedelta(seconds=seconds)
    return f"{when.isoformat(timespec=timespec)}Z"


def _number(text: str, kind: str, where: str) -> float:
    """A value of a column; NaN where it is missing, by the kind of the column."""
    if text.strip() in ("", "MM", "nan", "NaN"):
        return np.nan
    try:
        value = float(text)
    except ValueError:
        value = math.inf
    if not math.isfinite(value):
        raise UserError(f"{where} = {text!r} is no number")
    return np.nan if abs(value) in _MISSING[kind] else value


def _csv(lines: Sequence[str], name: str) -> Iterator[Row]:
    cells_of = csv.reader(lines, strict=True)
    header = [column.strip() for column in next(cells_of)]
    unknown = [column for column in header if column not in COLUMNS]
    if unknown or "time" not in header or len(set(header)) < len(header):
        raise UserError(
            f"{name}: its columns are {', '.join(header)[:80]}; give time and pairs of "
            f"{', '.join(COLUMNS[1:])}"
        )
    for number, cells in enumerate(cells_of, 2):
        where = f"{name}: line {number}"
        if not cells:
            continue
        if len(cells) != len(header):
            raise UserError(f"{where} has {len(cells)} cells, expected {len(header)}")
        row = dict(zip(header, cells, strict=True))
        time = seconds_of(row.pop("time"), where)
        kinds = {key: "direction" if key.endswith("_deg") else "speed" for key in row}
        yield time, {key: _number(row[key], kinds[key], f"{where}: {key}") for key in row}


def _ndbc(lines: Sequence[str], name: str) -> Iterator[Row]:
    header = lines[0].lstrip("#").split() if lines else []
    columns = ["WDIR" if column == "WD" else column for column in header]
    clock = [column for column in columns if column in _NDBC]
    if not {"MM", "DD", "hh", "WDIR", "WSPD"} <= set(columns) or columns[0] not in ("YY", "YYYY"):
        raise UserError(
            f"{name}: is neither CSV with {COLUMNS[0]} and {COLUMNS[1]} nor NDBC's standard "
            "meteorological text; give one of these, or NetCDF"
        )
    rows = []
    for number, line in enumerate(lines[1:], 2):
        if line.startswith("#") or not line.strip():
            continue
        cells, where = line.split(), f"{name}: line {number}"
        if len(cells) < len(columns):
            raise UserError(f"{where} has {len(cells)} columns, expected {len(columns)}")
        row = dict(zip(columns, cells, strict=False))
        try:
            parts = {_NDBC[column]: int(row[column]) for column in clock}
            year = parts.pop("year")
            year += 0 if year > 99 else 1900 if year > 69 else 2000
            when = datetime(year, **parts, tzinfo=UTC)
        except (ValueError, OverflowError) as error:
            raise UserError(f"{where}: {' '.join(cells[: len(clock)])} is no time") from error
        values = {
            "wind_speed_mps": _number(row["WSPD"], "speed", f"{where}: WSPD"),
            "wind_from_deg": _number(row["WDIR"], "direction", f"{where}: WDIR"),
            "gust_mps": _number(row.get("GST", ""), "speed", f"{where}: GST"),
        }
        rows.append((when.timestamp(), values))
    backwards = len(rows) > 1 and rows[0][0] > rows[-1][0]  # the newest first, as of real time
    yield from reversed(rows) if backwards else rows


def _columns(rows: Sequence[Row], name: str) -> Content:
    """Times, velocities (time, 1, 1, 2) of wind and current, and gusts."""
    times, parts = np.array([time for time, _ in rows]), {}
    for part, bearing in (("wind", "from"), ("current", "to")):
        names = f"{part}_speed_mps", f"{part}_{bearing}_deg"
        known = [column for column in names if rows and column in rows[0][1]]
        if len(known) == 1:
            raise UserError(f"{name}: has {known[0]} alone; give {names[0]} and {names[1]}")
        if not known:
            continue
        speed, degrees = (np.array([row[column] for _, row in rows]) for column in names)
        if (speed < 0.0).any() or (np.abs(degrees) > 360.0).any():
            raise UserError(f"{name}: {names[0]} below 0, or {names[1]} beyond 360")
        parts[part] = along(speed, degrees, part)[:, None, None]
    if rows and "gust_mps" in rows[0][1]:
        gust = np.array([row["gust_mps"] for _, row in rows])[:, None, None]
        parts["gusts"] = intensity(gust, parts["wind"], MEANS_OVER_GUSTS[1])
    return Content(times, parts)


def along(speed: FloatArray, degrees: FloatArray, part: str) -> FloatArray:
    """(time, 2) velocities, east and north, of a wind from bearings or a current to them [deg]."""
    of = wind_direction if part == "wind" else flow_direction
    unit = [(math.cos(angle), math.sin(angle)) for angle in map(of, degrees)]
    velocity: FloatArray = speed[:, None] * np.array(unit).reshape(-1, 2)
    return velocity
