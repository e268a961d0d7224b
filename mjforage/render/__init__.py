"""Pictures and films of an episode, drawn without OpenGL."""

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mjforage.errors import UserError
from mjforage.render.top_view import TopView
from mjforage.render.video import check_target, is_numbered, write_video
from mjforage.replay import Replay

__all__ = ["STEPS_PER_VIDEO_SECOND", "TopView", "frame_times", "render_replay", "write_video"]

STEPS_PER_VIDEO_SECOND = 4.0  # when no speed is asked for: 150 steps in 38 s
_TOLERANCE = 1e-6  # [step]


def render_replay(
    replay: Replay,
    path: Path,
    *,
    start_s: float = 0.0,
    duration_s: float | None = None,
    fps: float = 30.0,
    speed: float | None = None,
    long_side: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> int:
    """Draw an episode from above into an MP4, a GIF, one PNG or numbered PNGs.

    Parameters
    ----------
    replay : Replay
        The episode.
    path : Path
        Its suffix chooses the kind, see `write_video`; a single PNG shows the time `start_s`.
    start_s, duration_s : float
        What to show, in simulated seconds; by default all of the episode.
    fps : float
        Frames per second of video.
    speed : float, optional
        Simulated seconds per second of video, 1 being real time; by default four steps (40 s in
        the default scenario).
    long_side : int, optional
        Most pixels along the wider side, see `TopView`.
    progress : callable, optional
        Called as `progress(done, total)` after every frame.

    Returns
    -------
    int
        Number of frames written.

    Raises
    ------
    UserError
        If a time lies outside the episode, `fps`, `speed` or `long_side` does not fit, or the file
        cannot be written.
    """
    check_target(path, fps)
    times = frame_times(replay, start_s=start_s, duration_s=duration_s, fps=fps, speed=speed)
    if path.suffix.lower() == ".png" and not is_numbered(path):
        times = times[:1]
    if long_side is not None and not 320 <= long_side <= 7680:
        raise UserError(f"long side {long_side}: must be 320 to 7680 pixels, for example 1280")
    view = TopView(replay, long_side)

    def frames() -> Iterator[NDArray[np.uint8]]:
        for done, time in enumerate(times, start=1):
            yield view.frame(float(time))
            if progress is not None:
                progress(done, len(times))

    return write_video(frames(), path, fps)


def frame_times(
    replay: Replay,
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
