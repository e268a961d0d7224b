"""A video of a recorded episode, by the drawing for its world and camera."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.references import nearest
from mjforage.runs.episode_recording import Recording
from mjforage.view.render import palette
from mjforage.view.render.cameras import CAMERAS
from mjforage.view.render.film_frame import EpisodeView, FilmFrame, MapView, check_beside, shape_of
from mjforage.view.render.layout import Box, Layout, frame_layout
from mjforage.view.render.panel import sign_words
from mjforage.view.render.seen_by import EVERYBODY
from mjforage.view.render.seen_by import seen_by as as_seen_by
from mjforage.view.render.video import check_target, is_numbered, write_video

WIDTH, HEIGHT = 1280, 720  # [pixel]
MOST_WIDTH, MOST_HEIGHT, LEAST = 3840, 2160, 64
_STILL_DETAIL = 2  # a single picture is drawn so many times larger and shrunk
_TOLERANCE = 1e-6  # [step]

Progress = Callable[[int, int], None]
Size = tuple[int | None, int | None]


def render_recording(
    recording: Recording,
    path: Path,
    *,
    beside: Recording | None = None,
    camera: str | None = None,
    follow: str | None = None,
    seen_by: str = EVERYBODY,
    size: Size = (None, None),
    start_s: float = 0.0,
    duration_s: float | None = None,
    fps: float = 30.0,
    speed: float | None = None,
    progress: Progress | None = None,
) -> int:
    """Show an episode as an MP4, a GIF, one PNG or numbered PNGs.

    Raises `UserError` if there is no such camera or vessel, a time lies outside the episode, a
    number does not fit, the other episode is none of another policy, there is no OpenGL, or the
    file cannot be written.

    Returns: number of frames written.

    Parameters
    ----------
    path : its suffix chooses the kind, see `write_video`; a single PNG shows the time `start_s`
    beside : the same episode of another policy, shown to the right of it by the same clock; the one
        that ends earlier stays at its end
    camera : overview, chase, top or scout; by default top in the graph world, which is plain
        drawing without OpenGL, else overview
    follow : vessel of chase and scout, such as ``foragers_1``
    seen_by : vessel by whose knowledge the episode is drawn, such as ``scouts_0``, or ``all``
    size : width and height of a frame [pixel], by default 1280 x 720; one alone gives the other,
        16:9
    start_s, duration_s : what to show, in simulated seconds; by default all of the episode
    fps : frames per second of video
    speed : simulated seconds per second of video, 1 being real time; by default four decisions
        (40 s in the default scenario), for chase and scout one
    progress : called as `progress(done, total)` after every frame
    """
    check_target(path, fps)
    name = _camera_of(recording, camera)
    if speed is None:
        speed = CAMERAS[name].steps_per_film_s * recording.period_s
    recordings = [as_seen_by(each, seen_by) for each in (recording, beside) if each is not None]
    if beside is not None:
        check_beside(recording, beside)
    longest = max(recordings, key=lambda each: len(each.agent_rc))
    times = frame_times(longest, start_s=start_s, duration_s=duration_s, fps=fps, speed=speed)
    still = path.suffix.lower() == ".png" and not is_numbered(path)
    times = times[:1] if still else times
    frame_size = _checked_size(size)
    with ExitStack() as opened:
        how = name, follow, speed, _STILL_DETAIL if still else 1
        film = _film_frames(recordings, frame_size, *how, opened)
        return write_video(_frames(film, times, progress), path, fps)


def render_frame(
    recording: Recording,
    time_s: float = 0.0,
    *,
    camera: str | None = None,
    follow: str | None = None,
    seen_by: str = EVERYBODY,
    size: Size = (None, None),
) -> NDArray[np.uint8]:
    """One frame, (height, width, 3) red, green, blue; parameters and errors as `render_recording`.

    `time_s`: simulated time.
    """
    name = _camera_of(recording, camera)
    speed = CAMERAS[name].steps_per_film_s * recording.period_s
    recordings = [as_seen_by(recording, seen_by)]
    [time, *_] = frame_times(recordings[0], start_s=time_s, fps=1.0, speed=speed)
    with ExitStack() as opened:
        how = name, follow, speed, _STILL_DETAIL
        return _film_frames(recordings, _checked_size(size), *how, opened).frame(float(time)).copy()


def _camera_of(recording: Recording, camera: str | None) -> str:
    """Name of a point of view, by default that of the recording's world."""
    name = camera or ("top" if recording.world == "graph" else "overview")
    if name not in CAMERAS:
        raise UserError(f"camera {name}: unknown; {nearest(name, CAMERAS)}")
    return name


def _film_frames(
    recordings: list[Recording],
    size: tuple[int, int],
    camera: str,
    follow: str | None,
    speed: float,
    detail: int,
    opened: ExitStack,
) -> FilmFrame:
    """Frames of one episode or of two, by the drawing for their world and camera."""
    if (recordings[0].world, camera) != ("graph", "top"):
        return _through_mujoco(recordings, size, camera, follow, speed, detail, opened)
    if follow is not None:
        raise UserError(f"follow {follow}: camera top follows nobody; choose chase or scout")
    return map_film(recordings, size)


def frame_times(
    recording: Recording,
    *,
    start_s: float = 0.0,
    duration_s: float | None = None,
    fps: float,
    speed: float,
) -> NDArray[np.float64]:
    """Return the times (frame,) [step] that a film shows, both ends included.

    Raises `UserError` if a time lies outside the episode, or `fps` or `speed` is not above 0.
    """
    length, period_s = len(recording.agent_rc) - 1, recording.period_s
    end_s = length * period_s
    if not 0.0 <= start_s <= end_s:
        raise UserError(f"start {start_s:g} s: the episode lasts from 0 to {end_s:g} s")
    if duration_s is None:
        duration_s = end_s - start_s
    elif not 0.0 < duration_s < np.inf:
        raise UserError(f"duration {duration_s:g} s: must be over 0")
    if start_s + duration_s > end_s + _TOLERANCE * period_s:
        most = f"from {start_s:g} s on, at most {end_s - start_s:g} s are left"
        raise UserError(f"duration {duration_s:g} s: the episode ends at {end_s:g} s; {most}")
    for name, value in (("fps", fps), ("speed", speed)):
        if not 0.0 < value < np.inf:
            raise UserError(f"{name} {value:g}: must be over 0")
    step_per_frame = speed / fps / period_s
    count = int(duration_s / period_s / step_per_frame + _TOLERANCE) + 1
    times = start_s / period_s + step_per_frame * np.arange(count, dtype=np.float64)
    within: NDArray[np.float64] = np.minimum(times, length)
    return within


def map_film(
    recordings: list[Recording], size: tuple[int, int], most: int | None = None
) -> FilmFrame:
    """Frames of the plain drawing from above, of one episode or two side by side.

    Parameters
    ----------
    size : width and height [pixel]
    most : count of believed items that is drawn darkest, by default the largest
    """
    layout = _layout(recordings, size, shape_of(recordings[0]), charted=False)
    most = most or palette.most_believed(*(one.belief for one in recordings))
    pictures = [
        MapView(one, _whole(box), most=most)
        for one, box in zip(recordings, layout.pictures, strict=True)
    ]
    return FilmFrame(recordings, pictures, size, layout, drawn=True)


def _through_mujoco(
    recordings: list[Recording],
    size: tuple[int, int],
    camera: str,
    follow: str | None,
    speed: float,
    detail: int,
    opened: ExitStack,
) -> FilmFrame:
    """Frames that MuJoCo draws of one episode, or of two side by side; `opened` closes them."""
    from mjforage.view.render.harbour_view import HarbourView, water_area  # loads MuJoCo

    shape = None if CAMERAS[camera].follows else water_area(recordings[0]).shape
    layout = _layout(recordings, size, shape, charted=True)
    view: HarbourView | None = None
    pictures: list[EpisodeView] = []
    # The right one comes first: it is larger, and the left one draws on its canvas.
    for recording, box in list(zip(recordings, layout.pictures, strict=True))[::-1]:
        kind = recording, camera, *_whole(box)
        view = HarbourView(*kind, follow=follow, speed=speed, detail=detail, shares=view)
        pictures.insert(0, opened.enter_context(view))
    return FilmFrame(recordings, pictures, size, layout, drawn=False)


def _layout(
    recordings: list[Recording], size: tuple[int, int], shape: float | None, *, charted: bool
) -> Layout:
    signs = len(sign_words(recordings[0], 2, drawn=not charted))
    return frame_layout(*size, len(recordings), shape, signs, charted)


def _whole(box: Box) -> tuple[int, int]:
    """Width and height in whole pixels."""
    return round(box.width), round(box.height)


def _checked_size(size: Size) -> tuple[int, int]:
    """Width and height of a frame, checked; one alone gives the other."""
    for name, value, most in zip(("width", "height"), size, (MOST_WIDTH, MOST_HEIGHT), strict=True):
        if value is not None and not LEAST <= value <= most:
            raise UserError(f"{name} {value}: must be {LEAST} to {most} pixels")
    width, height = size
    if width is None:
        width = WIDTH if height is None else round(height * WIDTH / HEIGHT)
    return width, height or max(LEAST, round(width * HEIGHT / WIDTH))


def _frames(
    film: FilmFrame, times: NDArray[np.float64], progress: Progress | None
) -> Iterator[NDArray[np.uint8]]:
    """One frame after the other; none is kept."""
    for done, time in enumerate(times.tolist(), start=1):
        yield film.frame(time)
        if progress is not None:
            progress(done, len(times))
