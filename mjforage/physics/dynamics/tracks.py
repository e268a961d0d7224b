"""Tracks of items: positions as estimated by a vessel between and after sightings.

A Kalman filter of position and velocity per axis, the velocity a random walk (Bar-Shalom, Li and
Kirubarajan, "Estimation with Applications to Tracking and Navigation", 2001, section 6.2); both
axes share their variances. An item floats, so its track is kept off the land of the chart.
"""

import math
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.device import Launch
from mjforage.base.randomness import UInt64Array
from mjforage.base.rows import put_rows, scatter_all
from mjforage.base.wholes import floor
from mjforage.controllers.chart import LandArray, framed_is_land, grid_shape
from mjforage.physics.dynamics.camera import Camera, sight_items, variance
from mjforage.physics.floating.quays import is_clear

FloatArray = NDArray[np.float64]
SPEED_MPS = 0.05  # standard deviation per axis of the velocity of an item seen for the first time
JERK_M2PS3 = 3e-4  # variance that the velocity gains per second: drift changes every decision
SURPRISE = 13.8  # square of an error over its variance of which chance exceeds .001: pushed
ASHORE_S = 1.0  # time constant of the way that an item sought appears on land
FORGET_S = 20.0  # without a sighting
RADIUS_M = 0.1  # of an item: no nearer to a quay


NOWHERE = np.full(2, np.nan)


class LandGrid(NamedTuple):
    """Cells of land, of which tracks keep off."""

    land: LandArray  # as `controllers.Chart.land`
    pitch_m: float


class ItemTracks(NamedTuple):
    """Tracks of every vessel in every episode, with its sightings in the last frames."""

    xy: FloatArray  # (episode, vessel, item, 2) at `tick` [m]
    velocity: FloatArray  # (episode, vessel, item, 2) [m/s]
    spread: FloatArray  # (episode, vessel, item, 3) variance of place, covariance, of velocity
    tick: NDArray[np.int64]  # (episode, vessel, item) of the last sighting, -1 none
    frames: FloatArray  # (episode, frame, vessel, item, 2) on their way from the camera [m]
    sought: FloatArray  # (episode, vessel, 2) see `note_ashore` [m]
    ashore: FloatArray  # (episode, vessel, 2) the same

    @classmethod
    def of(cls, camera: Camera, vessels: int, items: NDArray[np.int32]) -> Self:
        """None yet, of `items` (episode, item)."""
        every = (items.shape[0], vessels, items.shape[1])
        on_the_way = camera.latency // camera.period + 1
        return cls(
            np.zeros((*every, 2)),
            np.zeros((*every, 2)),
            np.zeros((*every, 3)),
            np.full(every, -1),
            np.full((every[0], on_the_way, *every[1:], 2), np.nan),
            np.full((*every[:2], 2), np.nan),
            np.zeros((*every[:2], 2)),
        )

    def with_rows(self, rows: NDArray[np.int64], fresh: Self) -> Self:
        """The tracks of other episodes in some rows (row,) of the batch, as `put_rows`."""
        frames = put_rows(self.frames, rows, fresh.frames, np.nan)
        return scatter_all(self, rows, fresh, ("tick",))._replace(frames=frames)


@kernel
def afloat(grid: LandGrid, x: float, y: float) -> tuple[float, float]:
    """The place nearest to (x, y) [m] at which an item lies in water; itself if none is near."""
    land, pitch = grid.land, grid.pitch_m
    if land.size == 0 or is_clear(land, pitch, RADIUS_M, x, y):
        return x, y
    column, row = floor(x / pitch + 0.5), floor(y / pitch + 0.5)
    least, best_x, best_y, (columns, rows) = np.inf, x, y, grid_shape(land)
    for i in range(max(column, 1), min(column + 3, columns - 1)):  # of the frame
        for j in range(max(row, 1), min(row + 3, rows - 1)):
            if framed_is_land(land, i, j):
                continue
            half, at_x, at_y = 0.5 * pitch, (i - 1) * pitch, (j - 1) * pitch
            west = half - RADIUS_M * framed_is_land(land, i - 1, j)
            east = half - RADIUS_M * framed_is_land(land, i + 1, j)
            south = half - RADIUS_M * framed_is_land(land, i, j - 1)
            north = half - RADIUS_M * framed_is_land(land, i, j + 1)
            near_x, near_y = (
                min(max(x, at_x - west), at_x + east),
                min(max(y, at_y - south), at_y + north),
            )
            off = math.hypot(near_x - x, near_y - y)
            if off < least:
                least, best_x, best_y = off, near_x, near_y
    return best_x, best_y


@kernel
def note_sighting(
    tracks: ItemTracks,
    grid: LandGrid,
    at: tuple[int, int, int],
    tick: int,
    elapsed_s: float,
    x: float,
    y: float,
    var: float,
) -> None:
    """Take a sighting at (x, y) [m] into track `at`, `elapsed_s` after the one before."""
    place, velocity, spread = tracks.xy[at], tracks.velocity[at], tracks.spread[at]
    t, known = elapsed_s, tracks.tick[at] >= 0 and elapsed_s <= FORGET_S
    tracks.tick[at] = tick
    if known:
        vv = spread[2] + JERK_M2PS3 * t
        pv = spread[1] + spread[2] * t + JERK_M2PS3 * t * t / 2.0
        pp = spread[0] + 2.0 * spread[1] * t + spread[2] * t * t + JERK_M2PS3 * t**3 / 3.0
        off_x = x - (place[0] + t * velocity[0])
        off_y = y - (place[1] + t * velocity[1])
        whole = pp + var
        if off_x * off_x + off_y * off_y <= SURPRISE * whole:
            gain, speed_gain = pp / whole, pv / whole
            x, y = x - (1.0 - gain) * off_x, y - (1.0 - gain) * off_y
            velocity[0] += speed_gain * off_x
            velocity[1] += speed_gain * off_y
            spread[0], spread[1] = (1.0 - gain) * pp, (1.0 - gain) * pv
            spread[2] = vv - speed_gain * pv
            place[0], place[1] = afloat(grid, x, y)
            return
    velocity[:] = 0.0
    spread[0], spread[1], spread[2] = var, 0.0, SPEED_MPS**2
    place[0], place[1] = afloat(grid, x, y)


@kernel
def note_ashore(
    place: FloatArray, ashore: FloatArray, grid: LandGrid, seen: FloatArray, step_s: float
) -> None:
    """Take in where the item sought appears; on land, its vessel's position is off by that much.

    Parameters
    ----------
    place : (2,) where it appears, smoothed, NaN for none [m]
    ashore : (2,) way from there to the water; towards 0 without a sighting [m]
    seen : (2,) a sighting, NaN for none [m]
    step_s : since the one before
    """
    share = step_s / (ASHORE_S + step_s)
    if math.isnan(seen[0]):
        place[:] = np.nan
        ashore[0], ashore[1] = ashore[0] * (1.0 - share), ashore[1] * (1.0 - share)
        return
    if math.isnan(place[0]):
        place[0], place[1] = seen[0], seen[1]
    place[0] += share * (seen[0] - place[0])
    place[1] += share * (seen[1] - place[1])
    x, y = afloat(grid, place[0], place[1])
    ashore[0], ashore[1] = x - place[0], y - place[1]


@kernel
def look_out(
    camera: Camera,
    grid: LandGrid,
    keys: UInt64Array,
    collects: NDArray[np.bool_],
    tracks: ItemTracks,
    active: NDArray[np.bool_],
    tick: NDArray[np.int64],
    step_s: float,
    true_pose: FloatArray,
    pose: FloatArray,
    xy: FloatArray,
    item_node: NDArray[np.int32],
    sought: NDArray[np.int64],
) -> None:
    """One control tick: take a frame if it is due, and process a frame that has arrived.

    Parameters
    ----------
    keys, active, tick : (episode,) ticks since the start
    step_s : of a tick
    true_pose, pose : (episode, vessel, 3) as they are and as measured [m], [rad]
    xy, item_node : (episode, item, 2) [m], (episode, item) below 0 if not afloat
    sought : (episode, vessel) item that it collects, -1 for none
    """
    frames, latency, period = tracks.frames, camera.latency, camera.period
    for e in range(active.size):
        now, past = tick[e], tick[e] - latency
        if not active[e]:
            continue
        for v in range(collects.size):
            if not collects[v]:
                continue
            if now % period == 0:
                seen = frames[e, now // period % frames.shape[1]]
                sight_items(
                    camera, keys[e], now, v, true_pose[e], pose[e], xy[e], item_node[e], seen
                )
            if past < 0 or past % period != 0:
                continue
            came = frames[e, past // period % frames.shape[1], v]
            seen = came[sought[e, v]] if sought[e, v] >= 0 else NOWHERE
            note_ashore(tracks.sought[e, v], tracks.ashore[e, v], grid, seen, step_s * period)
            for k in range(came.shape[0]):
                if math.isnan(came[k, 0]):
                    continue
                x, y = came[k, 0], came[k, 1]
                far = math.hypot(x - pose[e, v, 0], y - pose[e, v, 1])
                elapsed = step_s * (past - tracks.tick[e, v, k])
                note_sighting(tracks, grid, (e, v, k), past, elapsed, x, y, variance(camera, far))


@kernel
def tracked(
    tracks: ItemTracks, grid: LandGrid, tick: NDArray[np.int64], step_s: float, out: FloatArray
) -> None:
    """Places of items now as vessels know them.

    `out`: (episode, vessel, item, 2) written [m]; NaN where there is no track.
    """
    for e in range(out.shape[0]):
        for v in range(out.shape[1]):
            for k in range(out.shape[2]):
                t = step_s * (tick[e] - tracks.tick[e, v, k])
                out[e, v, k] = np.nan
                if tracks.tick[e, v, k] < 0 or t > FORGET_S:
                    continue
                x = tracks.xy[e, v, k, 0] + t * tracks.velocity[e, v, k, 0]
                y = tracks.xy[e, v, k, 1] + t * tracks.velocity[e, v, k, 1]
                out[e, v, k, 0], out[e, v, k, 1] = afloat(grid, x, y)


LOOK_OUT = Launch(look_out, shared="grid collects")
TRACKED = Launch(tracked, shared="grid")
