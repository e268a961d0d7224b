"""Signs on the water by which hulls and debris are found, and the traces that hulls leave."""

import numpy as np
from numpy.typing import NDArray

from mjforage.physics.vessels import Vessel
from mjforage.view.render.palette import ITEM, WATER_SHADOW, WHITE, Colour
from mjforage.view.render.sheet import Sheet
from mjforage.view.render.track import Track
from mjforage.view.render.wakes import trail, wake

Floats = NDArray[np.float64]
FLASH_S = 5.0  # how long a collection stays marked [s]
_TRAIL_ALPHA, _TRAIL_WIDTH = 0.62, 0.42  # width in beams
_AWAY_FROM_SUN: Floats = np.array([-0.63, 0.77])


def lay_hull(
    sheet: Sheet,
    track: Track,
    agent: int,
    vessel: Vessel,
    time_s: float,
    scale: float,
    colour: Colour | None,
    trail_s: float,
) -> None:
    """Lay what belongs to one hull, drawn `scale` times larger than life.

    Parameters
    ----------
    colour : of its trail and of the patch that it lies on; None for neither, but a shadow
    trail_s : how far back the trail reaches [s]
    """
    pose = track.way(agent, np.array([time_s]))[0]
    length, beam = scale * vessel.length_m, scale * vessel.beam_m
    if colour is None:
        _lay_shadow(sheet, pose, length, beam)
    else:
        line = trail(track, agent, time_s, trail_s, _TRAIL_WIDTH * beam)
        sheet.stroke(line.xy, line.width_m, _TRAIL_ALPHA * line.strength, colour)
        _lay_patch(sheet, pose, length, beam, colour)
    for line in wake(track, agent, time_s, vessel.length_m, vessel.beam_m, scale):
        sheet.foam(line.xy, line.width_m, line.strength)


def _along(pose: Floats, reach: float) -> Floats:
    """(2, 2) ends of a hull's axis, `reach` before and behind midships."""
    bow = np.array([np.cos(pose[2]), np.sin(pose[2])])
    ends: Floats = pose[:2] + np.array([[reach], [-reach]]) * bow
    return ends


def _lay_shadow(sheet: Sheet, pose: Floats, length: float, beam: float) -> None:
    """The dark water under and beside a hull."""
    ends = _along(pose, 0.36 * length) + 0.12 * beam * _AWAY_FROM_SUN
    for grow, alpha in ((1.25, 0.16), (1.05, 0.2), (0.85, 0.22)):
        sheet.stroke(ends, np.full(2, grow * beam), np.full(2, alpha), WATER_SHADOW)


def _lay_patch(sheet: Sheet, pose: Floats, length: float, beam: float, colour: Colour) -> None:
    """A patch in the team's colour with a white rim, by which a hull is found from afar."""
    ends = _along(pose, 0.2 * length)
    for wide, alpha, paint in ((1.62, 0.35, WATER_SHADOW), (1.5, 0.9, WHITE), (1.28, 0.9, colour)):
        sheet.stroke(ends, np.full(2, wide * beam), np.full(2, alpha), paint)


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
    scale : how much larger than life items are drawn
    near : whether the camera is near, where rings may be fine
    """
    shown = known & (items[:, 2] > 0.0)
    radius, wide, alpha = (0.30, 0.045, 0.55) if near else (0.27, 0.055, 0.9)
    sheet.rings(
        items[shown, :2],
        np.full(shown.sum(), radius * scale),
        np.full(shown.sum(), wide * scale),
        alpha * items[shown, 2],
        ITEM,
    )
    age = since_s / (FLASH_S if near else 1.5 * FLASH_S)
    flash = (age >= 0.0) & (age < 1.0)
    left = 1.0 - age[flash]
    spread = scale * (0.2 + 0.9 * age[flash])
    sheet.rings(items[flash, :2], spread, scale * 0.09 * left + 0.02, 0.9 * left, ITEM)
