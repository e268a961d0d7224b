"""Points of view on a harbour, as pure functions of the track and the time."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mjforage.view.render.track import Track

Floats = NDArray[np.float64]
UP: Floats = np.array([0.0, 0.0, 1.0])
_MARGIN = 0.93  # part of the frame that a fitted area takes
_SMOOTH_SAMPLES = 151
_LEAST_SMOOTH_S = 1.5  # of the moving cameras [s]
_SMOOTH_FILM_S = 0.45  # the same in seconds of film, for fast films
_CHASE_BACK_M, _CHASE_HEIGHT_M, _CHASE_AHEAD_M = 6.6, 3.1, 1.8
_LIFE_SIZE_M = 54.0  # longer side of an area seen as a whole up to which hulls have their size
_NEAR_ITEMS, _FAR_ITEMS = 1.5, 2.0  # how much larger debris is drawn than hulls
_MAST_PITCH_RAD = np.radians(7.0)  # the scout's camera looks down by this


@dataclass(frozen=True, eq=False)
class View:
    """A pinhole camera: eye, direction of view and up (3,) [m], vertical field of view [rad]."""

    eye: Floats
    forward: Floats
    up: Floats
    fov_rad: float

    @property
    def right(self) -> Floats:
        """Unit vector to the right of the picture."""
        right: Floats = np.cross(self.forward, self.up)
        return right

    @property
    def north_rad(self) -> float:
        """Direction of north in the picture, clockwise from up; looking straight down by `up`."""
        flat = self.forward[:2] if np.hypot(*self.forward[:2]) > 1e-6 else self.up[:2]
        return float(np.arctan2(flat[1], flat[0]) - 0.5 * np.pi)

    def project(self, points: Floats, aspect: float) -> Floats:
        """(n, 3) points as (n, 3): x and y in the picture, -1 to 1, and the distance ahead [m]."""
        rel = points - self.eye
        ahead = rel @ self.forward
        safe = np.where(np.abs(ahead) < 1e-9, 1e-9, ahead)
        scale = 1.0 / (np.tan(0.5 * self.fov_rad) * safe)
        return np.column_stack((rel @ self.right * scale / aspect, rel @ self.up * scale, ahead))


@dataclass(frozen=True)
class Area:
    """A rectangle of the world [m]."""

    west: float
    south: float
    east: float
    north: float

    @property
    def corners(self) -> Floats:
        """(4, 3) on the water."""
        x, y = (self.west, self.east, self.east, self.west), (self.south,) * 2 + (self.north,) * 2
        return np.column_stack((x, y, np.zeros(4)))

    @property
    def shape(self) -> float:
        """Width by height."""
        return (self.east - self.west) / (self.north - self.south)

    def grown(self, margin: float) -> "Area":
        """Area with a margin all around [m]."""
        south, north = self.south - margin, self.north + margin
        return Area(self.west - margin, south, self.east + margin, north)

    @property
    def centre(self) -> Floats:
        """(3,) on the water."""
        middle: Floats = self.corners.mean(axis=0)
        return middle


@dataclass(frozen=True, eq=False)
class Circumstances:
    """All that a camera depends on besides the time."""

    track: Track
    area: Area  # of the water
    aspect: float  # width by height of the frame
    speed: float  # simulated seconds per second of film
    followed: int  # agent
    mast: Floats  # (3,) where the followed hull's own camera sits, in its axes [m]


def looking(eye: Floats, target: Floats, fov_rad: float) -> View:
    """A view from `eye` to `target` with the horizon level; straight down, north is up."""
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, UP)
    if np.linalg.norm(right) < 1e-6:
        right = np.array([1.0, 0.0, 0.0])
    right /= np.linalg.norm(right)
    return View(eye, forward, np.cross(right, forward), fov_rad)


@lru_cache(maxsize=8)
def fitted(area: Area, aspect: float, *, elevation_rad: float, fov_rad: float) -> View:
    """The nearest view of the whole area towards north, so far below the horizon."""
    towards = np.array([0.0, np.cos(elevation_rad), -np.sin(elevation_rad)])
    distance = max(area.east - area.west, area.north - area.south) / np.tan(0.5 * fov_rad)
    view = looking(area.centre - distance * towards, area.centre, fov_rad)
    half = np.tan(0.5 * fov_rad)
    for _ in range(60):  # each brings the area nearer to the middle and to the margin
        x, y, ahead = view.project(area.corners, aspect).T
        low, high = y.min(), y.max()
        reach = max(np.abs(x).max(), 0.5 * (high - low))
        back = (reach / _MARGIN - 1.0) * ahead.min()
        up = 0.5 * (low + high) * half * ahead.mean()
        view = View(view.eye - back * towards + up * view.up, view.forward, view.up, fov_rad)
    return view


def smoothed(track: Track, agent: int, time_s: float, sigma_s: float) -> Floats:
    """(3,) pose of one hull, averaged with a Gaussian over the time around.

    The whole track is known, so the average looks ahead as well and does not lag.
    """
    offset = np.linspace(-2.5, 2.5, _SMOOTH_SAMPLES)
    weight = np.exp(-0.5 * offset**2)
    mean: Floats = weight @ track.way(agent, time_s + sigma_s * offset) / weight.sum()
    return mean


def _sigma_s(speed: float) -> float:
    return max(_LEAST_SMOOTH_S, _SMOOTH_FILM_S * speed)


def overview(about: Circumstances, time_s: float) -> View:
    """The whole harbour at rest, from the south: north is up, as on the chart."""
    angles = {"elevation_rad": np.radians(55.0), "fov_rad": np.radians(28.0)}
    return fitted(about.area, about.aspect, **angles)


def top(about: Circumstances, time_s: float) -> View:
    """The whole harbour from high above, north up: almost without perspective."""
    angles = {"elevation_rad": np.radians(90.0), "fov_rad": np.radians(6.0)}
    return fitted(about.area, about.aspect, **angles)


def chase(about: Circumstances, time_s: float) -> View:
    """View from behind and above the followed vessel, turning smoothly after it."""
    hull = about.track.way(about.followed, np.array([time_s]))[0]
    calm = smoothed(about.track, about.followed, time_s, _sigma_s(about.speed))
    bow = np.array([np.cos(calm[2]), np.sin(calm[2]), 0.0])
    base = np.array([*(0.8 * hull[:2] + 0.2 * calm[:2]), 0.0])
    eye = base - _CHASE_BACK_M * bow + _CHASE_HEIGHT_M * UP
    return looking(eye, base + _CHASE_AHEAD_M * bow + 0.2 * UP, np.radians(46.0))


def scout(about: Circumstances, time_s: float) -> View:
    """View from the followed vessel's mast, over its bow."""
    hull = about.track.way(about.followed, np.array([time_s]))[0]
    calm = smoothed(about.track, about.followed, time_s, 0.2 * _sigma_s(about.speed))
    cos, sin = np.cos(hull[2]), np.sin(hull[2])
    x, y, z = about.mast
    eye = np.array([hull[0] + cos * x - sin * y, hull[1] + sin * x + cos * y, z])
    flat = np.cos(_MAST_PITCH_RAD)
    ahead = np.array([flat * np.cos(calm[2]), flat * np.sin(calm[2]), -np.sin(_MAST_PITCH_RAD)])
    return looking(eye, eye + ahead, np.radians(58.0))


@dataclass(frozen=True)
class Camera:
    """A point of view and the settings that suit it.

    Attributes
    ----------
    view : position at a simulated time [s]
    follows : True if it belongs to one vessel
    near_m : nearest thing that it sees [m]
    ground_m : side of the square around the followed hull whose water shows wakes; None for all
    steps_per_film_s : decisions per second of film, where no speed is asked for
    """

    view: Callable[[Circumstances, float], View]
    follows: bool
    near_m: float
    ground_m: float | None
    steps_per_film_s: float


CAMERAS = {
    "overview": Camera(overview, False, 5.0, None, 4.0),
    "chase": Camera(chase, True, 0.3, 72.0, 1.0),
    "top": Camera(top, False, 50.0, None, 4.0),
    "scout": Camera(scout, True, 0.05, 72.0, 1.0),
}
"""Registry of the points of view."""


def magnified(camera: Camera, area: Area) -> tuple[float, float]:
    """Factors by which vessels and debris are drawn larger than life, so that they can be seen."""
    if camera.follows:
        return 1.0, _NEAR_ITEMS
    longer = max(area.east - area.west, area.north - area.south)
    hulls = max(1.0, longer / _LIFE_SIZE_M)
    return hulls, _FAR_ITEMS * hulls
