"""Which moments of an episode a film shows."""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.runs.episode_recording import Recording

STEPS_PER_VIDEO_SECOND = 4.0  # when no speed is asked for: 150 steps in 38 s
_TOLERANCE = 1e-6  # [step]


def frame_times(
    replay: Recording,
    *,
    start_s: float = 0.0,
    duration_s: float | None = None,
    fps: float = 30.0,
    speed: float | None = None,
) -> NDArray[np.float64]:
    """Return the times (frame,) [step] that a film shows, both ends included.

    Raises
    ------
    UserError
        If a time lies outside the episode, or `fps` or `speed` is not above 0.
    """
    length = len(replay.agent_rc) - 1
    end_s = length * replay.period_s
    if not 0.0 <= start_s <= end_s:
        raise UserError(f"start {start_s:g} s: the episode lasts from 0 to {end_s:g} s")
    if duration_s is None:
        duration_s = end_s - start_s
    elif not 0.0 < duration_s < np.inf:
        raise UserError(f"duration {duration_s:g} s: must be over 0")
    if start_s + duration_s > end_s + _TOLERANCE * replay.period_s:
        most = f"from {start_s:g} s on, at most {end_s - start_s:g} s are left"
        raise UserError(f"duration {duration_s:g} s: the episode ends at {end_s:g} s; {most}")
    if speed is None:
        speed = STEPS_PER_VIDEO_SECOND * replay.period_s
    for name, value in (("fps", fps), ("speed", speed)):
        if not 0.0 < value < np.inf:
            raise UserError(f"{name} {value:g}: must be over 0")
    step_per_frame = speed / fps / replay.period_s
    count = int(duration_s / replay.period_s / step_per_frame + _TOLERANCE) + 1
    times = start_s / replay.period_s + step_per_frame * np.arange(count, dtype=np.float64)
    shown: NDArray[np.float64] = np.minimum(times, length)
    return shown
