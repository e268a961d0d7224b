"""A track from above: 40 m of water around the hull, north up."""

import math

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from mjforage.learning.environments.waypoint_track import REACHED_M, WaypointTrack

SIDE = 480  # pixels
SCALE = 12.0  # pixels per metre
WATER, TRACK, HULL, AHEAD, DONE = "#dbe9f1", "#7f9aa8", "#b3382c", "#1f5d87", "#a9bcc6"


def draw_track(track: WaypointTrack, way: list[tuple[float, float]]) -> NDArray[np.uint8]:
    """(SIDE, SIDE, 3) picture of the hull, its track `way` [m] and the waypoints."""
    x0, y0, yaw = track.pose

    def pixel(x: float, y: float) -> tuple[float, float]:
        return SIDE / 2 + SCALE * (x - x0), SIDE / 2 - SCALE * (y - y0)

    image = Image.new("RGB", (SIDE, SIDE), WATER)
    pen = ImageDraw.Draw(image)
    if len(way) > 1:
        pen.line([pixel(*place) for place in way], fill=TRACK, width=2)
    for i, (x, y) in enumerate(track.waypoints):
        (left, top), (right, bottom) = (
            pixel(x - REACHED_M, y + REACHED_M),
            pixel(x + REACHED_M, y - REACHED_M),
        )
        colour = DONE if i < track.reached else AHEAD
        pen.ellipse(
            (left, top, right, bottom), outline=colour, width=4 if i == track.reached else 2
        )
    half, beam = 0.5 * track.vessel.length_m, 0.5 * track.vessel.beam_m
    corners = [(half, 0.0), (0.4 * half, beam), (-half, beam), (-half, -beam), (0.4 * half, -beam)]
    c, s = math.cos(yaw), math.sin(yaw)
    pen.polygon([pixel(x0 + c * a - s * b, y0 + s * a + c * b) for a, b in corners], fill=HULL)
    return np.asarray(image, np.uint8).copy()
