"""Foam behind hulls and the coloured trails of where they came from, from the track alone."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mjforage.view.render.track import Track

Floats = NDArray[np.float64]
WAKE_S = 7.0  # how long foam stays
FULL_SPEED_MPS = 0.9  # speed of the strongest foam
ARM_SLOPE = 0.35  # tangent of the half angle of a ship's wake, 19.5 degrees (Kelvin, 1887)
TRAIL_STEPS = 9.0  # how far back trails reach [decision]
_STEP_S = 0.25
_SPREAD_MPS = 0.10  # at which the churned water widens to either side
_STILL_MPS = 0.08  # slower hulls leave no foam


@dataclass(frozen=True, eq=False)
class Line:
    """A line on the water, from now backwards: (n, 2) [m], width (n,) [m], strength (n,) 0..1."""

    xy: Floats
    width_m: Floats
    strength: Floats


def wake(
    track: Track, agent: int, time_s: float, length_m: float, beam_m: float, scale: float
) -> tuple[Line, ...]:
    """Churned water behind the stern and the two arms of the bow wave, of a hull drawn `scale`.

    A hull drawn larger gets a larger wake, which also stays longer.
    """
    age = np.arange(0.0, WAKE_S * scale + 0.5 * _STEP_S, _STEP_S)
    age = age[age <= time_s]
    way = track.way(agent, time_s - age)
    speed = _speeds(track, agent, time_s - age)
    if len(age) < 2 or speed.max() < _STILL_MPS:
        return ()
    bow = np.column_stack((np.cos(way[:, 2]), np.sin(way[:, 2])))
    side = np.column_stack((-bow[:, 1], bow[:, 0]))
    length, beam = scale * length_m, scale * beam_m
    left = np.clip(1.0 - age / (WAKE_S * scale), 0.0, 1.0)
    strength = np.clip((speed - _STILL_MPS) / FULL_SPEED_MPS, 0.0, 1.0) ** 0.7 * left**1.4
    stern = way[:, :2] - 0.42 * length * bow
    core = Line(stern, beam * 0.8 + 2.0 * _SPREAD_MPS * age, 0.85 * strength)
    run = np.concatenate(([0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * _STEP_S)))
    out = 0.5 * beam + ARM_SLOPE * run / np.sqrt(1.0 + (0.12 * run / scale) ** 2)
    shoulder = way[:, :2] + 0.25 * length * bow
    arms = (
        Line(
            shoulder + sign * out[:, None] * side,
            0.16 * scale + 0.05 * age,
            0.75 * strength * left,
        )
        for sign in (1.0, -1.0)
    )
    return (core, *arms)


def _speeds(track: Track, agent: int, times_s: Floats) -> Floats:
    """(time,) speeds over the second around each time [m/s]."""
    ahead, back = (track.way(agent, times_s + shift)[:, :2] for shift in (0.5, -0.5))
    moved: Floats = np.linalg.norm(ahead - back, axis=1)
    return moved


def trail(track: Track, agent: int, time_s: float, lasting_s: float, width_m: float) -> Line:
    """The way a hull came in the last `lasting_s`, fading into the past."""
    first = max(0.0, time_s - lasting_s)
    step = max(track.frame_s, lasting_s / 90.0)
    inner = step * np.arange(np.floor(first / step) + 1.0, np.ceil(time_s / step))
    times = np.concatenate(([time_s], inner[::-1], [first]))
    part = 1.0 - (time_s - times) / lasting_s
    return Line(track.way(agent, times)[:, :2], width_m * (0.45 + 0.55 * part), part**1.2)
