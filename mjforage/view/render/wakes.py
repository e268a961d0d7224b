"""Marks on the water by which vessels and debris are found, and the traces that vessels leave."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mjforage.physics.vessels import Vessel
from mjforage.view.render.palette import ITEM, WATER_SHADOW, WHITE, Colour
from mjforage.view.render.sheet import Sheet
from mjforage.view.render.track import Track

Floats = NDArray[np.float64]
WAKE_S = 7.0  # how long foam stays
FULL_SPEED_MPS = 0.9  # speed of the strongest foam
ARM_SLOPE = 0.35  # tangent of the half angle of a ship's wake, 19.5 degrees (Kelvin, 1887)
TRAIL_STEPS = 9.0  # how far back trails reach [decision]
FLASH_S = 5.0  # how long a collection stays marked [s]
_STEP_S = 0.25
_SPREAD_MPS = 0.10  # at which the churned water widens to either side
_STILL_MPS = 0.08  # slower vessels leave no foam
_TRAIL_ALPHA, _TRAIL_WIDTH = 0.62, 0.42  # width in beams
_AWAY_FROM_SUN: Floats = np.array([-0.63, 0.77])


@dataclass(frozen=True, eq=False)
class Line:
    """A line on the water, from now backwards: (n, 2) [m], width (n,) [m], strength (n,) 0..1."""

    xy: Floats
    width_m: Floats
    strength: Floats


def lay_vessel(
    sheet: Sheet,
    track: Track,
    agent: int,
    vessel: Vessel,
    time_s: float,
    scale: float,
    colour: Colour | None,
    trail_s: float,
) -> None:
    """Paint the marks of one vessel, drawn `scale` times larger than life.

    Parameters
    ----------
    colour : of its trail and of the patch that it lies on; None for neither, but a shadow
    trail_s : duration of the trail [s]
    """
    x, y, yaw = track.way(agent, np.array([time_s]))[0]
    length, beam = scale * vessel.length_m, scale * vessel.beam_m
    axis = np.array([[np.cos(yaw), np.sin(yaw)], [-np.cos(yaw), -np.sin(yaw)]])
    if colour is None:
        at = (x, y) + 0.12 * beam * _AWAY_FROM_SUN + 0.36 * length * axis
        layers = [(1.25, 0.16, WATER_SHADOW), (1.05, 0.2, WATER_SHADOW), (0.85, 0.22, WATER_SHADOW)]
    else:
        line = trail(track, agent, time_s, trail_s, _TRAIL_WIDTH * beam)
        sheet.stroke(line.xy, line.width_m, _TRAIL_ALPHA * line.strength, colour)
        at = (x, y) + 0.2 * length * axis
        layers = [(1.62, 0.35, WATER_SHADOW), (1.5, 0.9, WHITE), (1.28, 0.9, colour)]
    for wide, alpha, paint in layers:
        sheet.stroke(at, np.full(2, wide * beam), np.full(2, alpha), paint)
    for line in wake(track, agent, time_s, vessel, scale):
        sheet.foam(line.xy, line.width_m, line.strength)


def lay_rings(
    sheet: Sheet,
    items: Floats,
    known: NDArray[np.bool_],
    since_s: Floats,
    scale: float,
    near: bool,
) -> None:
    """Lay rings around discovered items, and one that spreads where an item was collected.

    Parameters
    ----------
    items : (item, 3) x, y [m] and share that is there
    known : (item,) whether it is discovered
    since_s : (item,) time since it was collected [s], negative before
    scale : scale of drawn items, 1 for life size
    near : True if the camera is near, where rings may be fine
    """
    visible = known & (items[:, 2] > 0.0)
    radius, wide, alpha = (0.30, 0.045, 0.55) if near else (0.27, 0.055, 0.9)
    one = np.ones(visible.sum())
    sizes = radius * scale * one, wide * scale * one
    sheet.rings(items[visible, :2], *sizes, alpha * items[visible, 2], ITEM)
    age = since_s / (FLASH_S if near else 1.5 * FLASH_S)
    flash = (age >= 0.0) & (age < 1.0)
    left = 1.0 - age[flash]
    spread = scale * (0.2 + 0.9 * age[flash])
    sheet.rings(items[flash, :2], spread, scale * 0.09 * left + 0.02, 0.9 * left, ITEM)


def wake(track: Track, agent: int, time_s: float, vessel: Vessel, scale: float) -> Iterator[Line]:
    """Churned water behind the stern and the two arms of the bow wave of a vessel drawn `scale`.

    A vessel drawn larger gets a larger wake, which also stays longer.
    """
    age = np.arange(0.0, WAKE_S * scale + 0.5 * _STEP_S, _STEP_S)
    age = age[age <= time_s]
    way = track.way(agent, time_s - age)
    ahead, back = (track.way(agent, time_s - age + shift)[:, :2] for shift in (0.5, -0.5))
    speed = np.linalg.norm(ahead - back, axis=1)  # over the second around each time [m/s]
    if len(age) < 2 or speed.max() < _STILL_MPS:
        return
    bow = np.column_stack((np.cos(way[:, 2]), np.sin(way[:, 2])))
    side = np.column_stack((-bow[:, 1], bow[:, 0]))
    length, beam = scale * vessel.length_m, scale * vessel.beam_m
    left = np.clip(1.0 - age / (WAKE_S * scale), 0.0, 1.0)
    strength = np.clip((speed - _STILL_MPS) / FULL_SPEED_MPS, 0.0, 1.0) ** 0.7 * left**1.4
    stern = way[:, :2] - 0.42 * length * bow
    yield Line(stern, beam * 0.8 + 2.0 * _SPREAD_MPS * age, 0.85 * strength)
    run = np.concatenate(([0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * _STEP_S)))
    out = 0.5 * beam + ARM_SLOPE * run / np.sqrt(1.0 + (0.12 * run / scale) ** 2)
    shoulder, wide = way[:, :2] + 0.25 * length * bow, 0.16 * scale + 0.05 * age
    for sign in (1.0, -1.0):
        yield Line(shoulder + sign * out[:, None] * side, wide, 0.75 * strength * left)


def trail(track: Track, agent: int, time_s: float, lasting_s: float, width_m: float) -> Line:
    """The way a vessel came in the last `lasting_s`, fading into the past."""
    first = max(0.0, time_s - lasting_s)
    step = max(track.frame_s, lasting_s / 90.0)
    inner = step * np.arange(np.floor(first / step) + 1.0, np.ceil(time_s / step))
    times = np.concatenate(([time_s], inner[::-1], [first]))
    part = 1.0 - (time_s - times) / lasting_s
    return Line(track.way(agent, times)[:, :2], width_m * (0.45 + 0.55 * part), part**1.2)
