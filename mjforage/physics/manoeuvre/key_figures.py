"""Key figures of a manoeuvre as a sea trial reports them, each with its unit."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from mjforage.physics.manoeuvre.standard import AHEAD_S, APPROACH_S
from mjforage.physics.manoeuvre.trajectory import Trajectory

Float64Array = NDArray[np.float64]

RISEN = 1.0 - math.exp(-1.0)  # 63 % of a first-order rise


@dataclass(frozen=True)
class KeyFigure:
    """A number with its unit and meaning."""

    value: float
    unit: str
    meaning: str


def key_figures(trajectory: Trajectory) -> dict[str, KeyFigure]:
    """Key figures of a standard test or a schedule, by name; speeds are through the water.

    What did not happen within the run, such as a full turn, is left out.
    """
    special = _OF_TEST.get(trajectory.test, _turning)
    found = {**_general(trajectory), **special(trajectory)}
    return {name: figure for name, figure in found.items() if math.isfinite(figure.value)}


def crossing_s(times: Float64Array, values: Float64Array, level: float) -> float:
    """First time at which `values` (rows,) passes `level`, between rows linearly; nan if never."""
    above = values >= level
    changes = np.flatnonzero(above[1:] != above[:-1])
    if not changes.size:
        return math.nan
    i = int(changes[0])
    part = (level - values[i]) / (values[i + 1] - values[i])
    return float(times[i] + part * (times[i + 1] - times[i]))


def rise_time_s(times: Float64Array, speed: Float64Array) -> float:
    """Time from the first row to 63 % of the way to the last row's speed [s]."""
    level = speed[0] + RISEN * (speed[-1] - speed[0])
    return crossing_s(times, speed, float(level)) - float(times[0])


def coast_time_s(times: Float64Array, speed: Float64Array) -> float:
    """Time from the first row until 1/e of its speed is left [s]."""
    return crossing_s(times, speed, float(speed[0]) / math.e) - float(times[0])


def last_turn_s(times: Float64Array, yaw: Float64Array) -> float:
    """Duration of the run's last full turn [s]; nan if there is none."""
    back = crossing_s(times[::-1], np.abs(yaw[-1] - yaw[::-1]), 2.0 * math.pi)
    return float(times[-1]) - back


def zigzag_figures(
    times: Float64Array, heading: Float64Array, angle: float
) -> tuple[list[float], float]:
    """Overshoots and mean period of a zigzag (IMO MSC.137(76), section 5.3.3).

    Parameters
    ----------
    times : (rows,) [s]
    heading : (rows,) from the heading at the first execute on [rad]
    angle : heading at which the thrust is reversed, either side [rad]

    Returns
    -------
    overshoots : angle of each swing beyond the ordered one [rad]; a swing that had not come back to
        a heading of 0 by the end does not count
    period : mean time between passing a heading of 0 in the same direction [s]; nan if it did not
        happen twice
    """
    passed = np.flatnonzero(heading[1:] * heading[:-1] < 0.0)
    before, after = heading[passed], heading[passed + 1]
    zeros = times[passed] - before * (times[passed + 1] - times[passed]) / (after - before)
    edges = np.concatenate(([0], passed + 1))
    swings = [heading[a:b] for a, b in pairwise(edges)]
    overshoots = [_peak(np.abs(swing)) - angle for swing in swings]
    periods = zeros[2:] - zeros[:-2]
    period = float(periods.mean()) if periods.size else math.nan
    return [size for size in overshoots if size >= 0.0], period


def _peak(values: Float64Array) -> float:
    """Largest value, through the parabola of the three rows around it."""
    i = int(values.argmax())
    if not 0 < i < values.size - 1:
        return float(values[i])
    left, top, right = (float(value) for value in values[i - 1 : i + 2])
    bend = left - 2.0 * top + right
    return top - (right - left) ** 2 / (8.0 * bend) if bend else top


def _general(t: Trajectory) -> dict[str, KeyFigure]:
    speed = np.hypot(*t.through_water.T)
    steps = np.hypot(*np.diff(t.states[:, :2], axis=0).T)
    return {
        "top_speed": KeyFigure(float(speed.max()), "m/s", "highest speed through the water"),
        "final_speed": KeyFigure(float(speed[-1]), "m/s", "speed through the water at the end"),
        "final_yaw_rate": KeyFigure(float(t.states[-1, 5]), "rad/s", "yaw rate at the end"),
        "distance": KeyFigure(float(steps.sum()), "m", "way over ground"),
    }


def _turning(t: Trajectory) -> dict[str, KeyFigure]:
    period = last_turn_s(t.times_s, t.states[:, 2])
    if not math.isfinite(period):
        return {}
    start = float(t.times_s[-1]) - period
    turn = t.times_s >= start
    surge, sway = t.through_water[turn].T
    speed, rate = float(np.hypot(surge, sway).mean()), 2.0 * math.pi / period
    before = [float(np.interp(start, t.times_s, t.states[:, i])) for i in (0, 1)]
    drift = math.hypot(t.states[-1, 0] - before[0], t.states[-1, 1] - before[1]) / period
    slip = math.degrees(float(np.arctan2(sway, surge).mean()))
    return {
        "turning_speed": KeyFigure(speed, "m/s", "mean speed through the water, last full turn"),
        "turning_rate": KeyFigure(rate, "rad/s", "mean yaw rate of the last full turn"),
        "turning_diameter": KeyFigure(2.0 * speed / rate, "m", "diameter of the steady turn"),
        "drift_angle": KeyFigure(slip, "deg", "from the bow to the velocity, port positive"),
        "centre_drift": KeyFigure(drift, "m/s", "drift of the circle's centre"),
    }


def _straight(t: Trajectory) -> dict[str, KeyFigure]:
    surge = t.through_water[:, 0]
    ahead, coasting = t.times_s <= AHEAD_S, t.times_s >= AHEAD_S
    if not coasting.any():
        return {}
    steady = float(surge[ahead][-1])
    rise = rise_time_s(t.times_s[ahead], surge[ahead])
    coast = coast_time_s(t.times_s[coasting], surge[coasting])
    return {
        "steady_speed": KeyFigure(steady, "m/s", f"after {AHEAD_S:g} s flat out from rest"),
        "rise_time": KeyFigure(rise, "s", "from rest to 63 % of it"),
        "coast_time": KeyFigure(coast, "s", "from stopping the thrusters to 37 % of it"),
    }


def _stop(t: Trajectory) -> dict[str, KeyFigure]:
    after = t.times_s >= AHEAD_S
    if not after.any():
        return {}
    times, x, y = t.times_s[after], t.states[after, 0], t.states[after, 1]
    stopped = crossing_s(times, t.through_water[after, 0], 0.0)
    way = np.concatenate(([0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))))
    far = float(np.interp(stopped, times, way)) if math.isfinite(stopped) else math.nan
    return {
        "stopping_time": KeyFigure(stopped - float(times[0]), "s", "full astern until stopped"),
        "stopping_distance": KeyFigure(far, "m", "track over ground until then"),
    }


def _drift(t: Trajectory) -> dict[str, KeyFigure]:
    yaw = float(t.states[-1, 2])
    surge, sway = t.through_water[-1].tolist()
    east = math.cos(yaw) * surge - math.sin(yaw) * sway
    north = math.sin(yaw) * surge + math.cos(yaw) * sway
    wind = math.hypot(*t.conditions.wind_mps)
    leeway = math.hypot(east, north) / wind * 100.0 if wind and t.vessel.windage.any else math.nan
    over_ground = math.hypot(*t.states[-1, 3:5])
    return {
        "drift_speed": KeyFigure(over_ground, "m/s", "over ground at the end"),
        "leeway": KeyFigure(leeway, "% of the wind", "through the water at the end"),
    }


def _zigzag(angle_deg: float) -> Callable[[Trajectory], dict[str, KeyFigure]]:
    def figures(t: Trajectory) -> dict[str, KeyFigure]:
        after = t.times_s >= APPROACH_S
        if after.sum() < 2:
            return {}
        yaw = t.states[after, 2]
        overshoots, period = zigzag_figures(t.times_s[after], yaw - yaw[0], math.radians(angle_deg))
        found = {
            f"overshoot_{i}": KeyFigure(math.degrees(size), "deg", f"overshoot number {i}")
            for i, size in enumerate(overshoots[:4], 1)
        }
        return {**found, "period": KeyFigure(period, "s", "between turns of one side, mean")}

    return figures


_OF_TEST: dict[str, Callable[[Trajectory], dict[str, KeyFigure]]] = {
    "straight": _straight,
    "stop": _stop,
    "drift": _drift,
    "zigzag": _zigzag(10.0),
    "zigzag-20": _zigzag(20.0),
}
