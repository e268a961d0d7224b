"""Recorded wind and current as kernels read them: bilinear in space, linear in time."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.errors import UserError
from mjforage.base.randomness import Stream, UInt64Array, stream_key, uniform
from mjforage.forcing.record_files import Recorded, read_record, seconds_of
from mjforage.graph_planner.graph.navigation import NavigationGraph
from mjforage.scenario.bearings import direction
from mjforage.scenario.place import Place, projection
from mjforage.scenario.scenario import Scenario, Weather

FloatArray = NDArray[np.float64]
_DIGITS = 12  # of a place in a grid: the last ones differ from one processor to another
_START = 1001  # step of a drawn start in its stream, away from the other draws
_USUAL_M = 10.0  # height of a wind whose height nobody tells
_TRIES = 64  # draws of a start from all of the record, before those from what fits alone


class Record(NamedTuple):
    """Velocities of air or water on a grid in the frame of a map; no times: there is none.

    Of a wind with gusts of its own a third value is their standard deviation over its speed.
    """

    times_s: FloatArray  # (time,) since the record begins
    velocity: FloatArray  # (time, row, column, 2 or 3) in (x, y) [m/s]
    cell: FloatArray  # (2, 3) row and column of the grid are this times (x, y, 1)
    starts_s: FloatArray  # (episode,) when in the record each episode begins


NO_RECORD = Record(np.empty(0), np.empty((0, 1, 1, 2)), np.zeros((2, 3)), np.empty(0))


@kernel
def _between(place: float, count: int) -> tuple[int, int, float]:
    """The two entries about a place in a row of so many, held at its ends, and how far between."""
    place = min(max(place, 0.0), count - 1.0)
    first = min(int(place), max(count - 2, 0))
    return first, min(first + 1, count - 1), place - first


@kernel
def recorded_velocity(
    record: Record, e: int, t_s: float, x: float, y: float
) -> tuple[float, float, float]:
    """Velocity, and gusts over it, at a time of episode e [s] and a place [m]; the record's ends
    hold beyond it.
    """
    times, cell = record.times_s, record.cell
    now = min(max(record.starts_s[e] + t_s, times[0]), times[-1])
    i = min(max(np.searchsorted(times, now, side="right") - 1, 0), times.size - 2)
    late = (now - times[i]) / (times[i + 1] - times[i])
    r0, r1, down = _between(cell[0, 0] * x + cell[0, 1] * y + cell[0, 2], record.velocity.shape[1])
    c0, c1, over = _between(cell[1, 0] * x + cell[1, 1] * y + cell[1, 2], record.velocity.shape[2])
    u = v = gusts = 0.0
    for time, of_time in ((i, 1.0 - late), (i + 1, late)):
        for row, of_row in ((r0, 1.0 - down), (r1, down)):
            for column, of_column in ((c0, 1.0 - over), (c1, over)):
                share = of_time * of_row * of_column
                u += share * record.velocity[time, row, column, 0]
                v += share * record.velocity[time, row, column, 1]
                if record.velocity.shape[3] > 2:
                    gusts += share * record.velocity[time, row, column, 2]
    return u, v, gusts


@kernel
def _drawn_starts(keys: UInt64Array, whole_s: float, latest_s: float) -> FloatArray:
    """(episode,) whole seconds, uniform from 0 to the latest start [s].

    Each is the first of draws from all of the record that is not too late, so that another
    horizon changes only those that would end beyond the record.
    """
    starts = np.empty(keys.size)
    for e in range(keys.size):
        key = stream_key(keys[e], Stream.WEATHER)
        starts[e] = math.floor(latest_s * uniform(key, _TRIES, _START))
        for attempt in range(_TRIES):
            drawn = math.floor(whole_s * uniform(key, attempt, _START))
            if drawn <= latest_s:
                starts[e] = drawn
                break
    return starts


def starts_of(
    recorded: Recorded, start: str | None, keys: UInt64Array, long_s: float
) -> FloatArray:
    """(episode,) when in the record each episode of so many seconds begins [s].

    Raises `UserError` if the record does not last so long, or not from that start on.
    """
    whole = recorded.times_s[-1] - recorded.times_s[0]
    latest = whole - long_s
    first, last = (np.datetime64(int(t), "s") for t in recorded.times_s[[0, -1]])
    if latest < 0.0:
        raise UserError(
            f"{recorded.name}: is from {first} to {last}, shorter than an episode of "
            f"{long_s / 3600:.4g} h; give a longer record, or a smaller horizon"
        )
    if start is None:
        return _drawn_starts(keys, whole, latest)
    begin = seconds_of(start, "weather.start") - recorded.times_s[0]
    if not 0.0 <= begin <= latest:
        raise UserError(
            f"weather.start = {start}: {recorded.name} is from {first} to {last}, and an episode "
            f"lasts {long_s / 3600:.4g} h; give a start within"
        )
    return np.full(keys.size, begin)


def begins_of(scenario: Scenario, keys: UInt64Array) -> FloatArray | None:
    """(episode,) UTC of the record when each episode begins, since 1970 [s]; None without one."""
    weather = scenario.weather
    if weather.file is None:
        return None
    recorded = read_record(weather.file)
    starts = starts_of(recorded, weather.start, keys, scenario.period_s * scenario.horizon)
    begins: FloatArray = recorded.times_s[0] + starts
    return begins


def on_map(
    recorded: Recorded,
    part: str,
    starts_s: FloatArray,
    graph: NavigationGraph | None,
    place: Place | None,
    factor: float = 1.0,
) -> Record:
    """The wind, with its gusts, or the current of a record on a map, its velocities times a factor.

    Raises `UserError` if a grid shall be on a map that is no place, or does not cover it.
    """
    east_north = getattr(recorded, part)
    if east_north is None:
        return NO_RECORD
    turn = direction(place.rotation_deg) if place else 0.0
    east, north = factor * east_north[..., 0], factor * east_north[..., 1]
    gusts = recorded.gusts if part == "wind" else None
    velocity = np.stack(
        (
            east * math.cos(turn) - north * math.sin(turn),
            east * math.sin(turn) + north * math.cos(turn),
            *(() if gusts is None else (gusts,)),
        ),
        axis=-1,
    )
    cell = np.zeros((2, 3))
    if velocity.shape[1] * velocity.shape[2] > 1:
        if place is None or graph is None:
            raise UserError(
                f"{recorded.name}: is a grid, and the map has no latitude and longitude; give a "
                "place (`mjforage place`), or a record of one point"
            )
        cell = _cells(recorded, graph, place)
    return Record(recorded.times_s - recorded.times_s[0], velocity, cell, starts_s)


def _cells(recorded: Recorded, graph: NavigationGraph, place: Place) -> FloatArray:
    """(2, 3) row and column of a record's grid by (x, y, 1): linear, as a place is small."""
    rows, columns = graph.shape
    corners = np.array([(r, c) for r in (-0.5, rows - 0.5) for c in (-0.5, columns - 0.5)])
    found, (lat, lon) = [], place.latlon(corners).T
    known = recorded.latitude, recorded.longitude
    turns = np.round((0.5 * (known[1][0] + known[1][-1]) - lon[0]) / 360.0)
    lon = lon[0] + (lon - lon[0] + 180.0) % 360.0 - 180.0 + 360.0 * turns
    for at, degrees in zip((lat, lon), known, strict=True):
        if degrees.size > 1 and (at.min() < degrees[0] or at.max() > degrees[-1]):
            (south, north), (west, east) = (each[[0, -1]] for each in known)
            raise UserError(
                f"{recorded.name}: its grid, latitude {south:g} to {north:g} and longitude "
                f"{west:g} to {east:g}, does not cover the map about {place.latitude_deg:.5g}, "
                f"{place.longitude_deg:.5g}; give a larger grid, or one of that place"
            )
        found.append((at - degrees[0]) / (degrees[1] - degrees[0]) if degrees.size > 1 else 0 * at)
    metres = np.column_stack((graph.metres(corners), np.ones(4)))
    cell = np.linalg.lstsq(metres, np.column_stack(found), rcond=None)[0].T
    return np.ascontiguousarray(np.round(cell, _DIGITS))


def far_km(recorded: Recorded, place: Place) -> float:
    """Distance of a record of one point, or of one latitude or longitude, from a place; 0 if the
    record does not tell it.
    """
    middle = place.latitude_deg, place.longitude_deg
    known = (recorded.latitude, recorded.longitude)
    lat, lon = (
        own[0] if own.size == 1 and np.isfinite(own[0]) else here
        for own, here in zip(known, middle, strict=True)
    )
    return math.hypot(*projection(*middle).transform(lon, lat)) / 1000.0


def rise_of(recorded: Recorded, weather: Weather) -> float:
    """Speed at `height_m` over that of the record, by the power law.

    Raises `UserError` if the scenario gives another height of the record than its file.
    """
    given, own = weather.record_height_m, recorded.height_m
    if given is not None and own is not None and given != own:
        raise UserError(
            f"weather.record_height_m = {given:g}: {recorded.name} has its wind at {own:g} m; "
            "leave out the key"
        )
    return float((weather.height_m / (given or own or _USUAL_M)) ** weather.shear_exponent)
