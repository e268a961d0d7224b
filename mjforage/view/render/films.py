"""An episode into a file, by whichever drawing suits its world and camera."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.references import nearest
from mjforage.runs.episode_recording import Recording
from mjforage.view.render import palette
from mjforage.view.render.beside import Beside, BesideFrame, Half, check_beside
from mjforage.view.render.cameras import CAMERAS
from mjforage.view.render.seen_by import EVERYBODY
from mjforage.view.render.seen_by import seen_by as as_seen_by
from mjforage.view.render.side_panel import Moment
from mjforage.view.render.times import frame_times
from mjforage.view.render.top_view import TopView
from mjforage.view.render.video import check_target, is_numbered, write_video

WIDTH, HEIGHT = 1280, 720  # [pixel]
MOST_WIDTH, MOST_HEIGHT, LEAST = 3840, 2160, 64
_STILL_DETAIL = 2  # a single picture is drawn so many times larger and shrunk

Progress = Callable[[int, int], None]
Size = tuple[int | None, int | None]
Frame = Callable[[float], NDArray[np.uint8]]


def default_camera(world: str) -> str:
    """The camera where none is asked for."""
    return "top" if world == "graph" else "overview"


def needs_opengl(world: str, camera: str) -> bool:
    """Whether MuJoCo draws: everything but the graph world from above, which is plain drawing."""
    return (world, camera) != ("graph", "top")


def render_replay(
    replay: Recording,
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

    Parameters
    ----------
    replay : Recording
        The episode.
    path : Path
        Its suffix chooses the kind, see `write_video`; a single PNG shows the time `start_s`.
    beside : Recording, optional
        The same episode of another policy, shown to the right of it by the same clock; the one
        that ends earlier stays at its end.
    camera : str, optional
        overview, chase, top or scout; by default `default_camera`.
    follow : str, optional
        Vessel of chase and scout, such as ``foragers_1``.
    seen_by : str
        Vessel by whose knowledge the episode is drawn, such as ``scouts_0``, or ``all``.
    size : (int or None, int or None)
        Width and height of a frame [pixel], by default 1280 x 720. The drawing of one episode of
        the graph world from above takes the width for its longer side and finds its own height.
    start_s, duration_s : float
        What to show, in simulated seconds; by default all of the episode.
    fps : float
        Frames per second of video.
    speed : float, optional
        Simulated seconds per second of video, 1 being real time; by default four decisions (40 s in
        the default scenario), for chase and scout one.
    progress : callable, optional
        Called as `progress(done, total)` after every frame.

    Returns
    -------
    int
        Number of frames written.

    Raises
    ------
    UserError
        If there is no such camera or vessel, a time lies outside the episode, a number does not
        fit, the other episode is none of another policy, there is no OpenGL, or the file cannot be
        written.
    """
    check_target(path, fps)
    name = camera or default_camera(replay.world)
    if name not in CAMERAS:
        raise UserError(f"camera {name}: unknown; {nearest(name, CAMERAS)}")
    if speed is None:
        speed = CAMERAS[name].steps_per_film_s * replay.period_s
    shown = [as_seen_by(each, seen_by) for each in (replay, beside) if each is not None]
    if beside is not None:
        check_beside(replay, beside)
    longest = max(shown, key=lambda each: len(each.agent_rc))
    times = frame_times(longest, start_s=start_s, duration_s=duration_s, fps=fps, speed=speed)
    still = path.suffix.lower() == ".png" and not is_numbered(path)
    times = times[:1] if still else times
    with ExitStack() as opened:
        if needs_opengl(replay.world, name):
            look = _Look(name, follow, speed, _STILL_DETAIL if still else 1)
            draw = _through_mujoco(shown, look, size, opened)
        else:
            draw = _drawing(shown, follow, size)
        return write_video(_frames(draw, times, progress), path, fps)


@dataclass(frozen=True)
class _Look:
    """How MuJoCo's pictures are taken."""

    camera: str
    follow: str | None
    speed: float
    detail: int


def _through_mujoco(shown: list[Recording], look: _Look, size: Size, opened: ExitStack) -> Frame:
    """What MuJoCo draws of one episode, or of two side by side; `opened` closes it."""
    frame = _frame_size(size)
    from mjforage.view.render.harbour_view import (
        HarbourView,  # loads MuJoCo, the drawing goes without
    )

    def view(
        replay: Recording,
        width: int,
        height: int,
        *,
        panel: bool,
        shares: HarbourView | None = None,
    ) -> HarbourView:
        taken = HarbourView(
            replay,
            look.camera,
            width,
            height,
            follow=look.follow,
            speed=look.speed,
            detail=look.detail,
            panel=panel,
            shares=shares,
        )
        return opened.enter_context(taken)

    if len(shown) == 1:
        return view(shown[0], *frame, panel=True).frame
    place = BesideFrame(*frame)
    right = view(shown[1], *place.rooms[1], panel=False)  # the larger one, of odd widths
    left = view(shown[0], *place.rooms[0], panel=False, shares=right)
    first, second = (
        Half(replay, taken.frame, taken.moment, True, taken.followed)
        for replay, taken in zip(shown, (left, right), strict=True)
    )
    return Beside((first, second), place).frame


def _frame_size(size: Size) -> tuple[int, int]:
    """Width and height of a frame, checked."""
    return (
        _checked("width", size[0], WIDTH, MOST_WIDTH),
        _checked("height", size[1], HEIGHT, MOST_HEIGHT),
    )


def _drawing(shown: list[Recording], follow: str | None, size: Size) -> Frame:
    """The plain drawing from above, for which some options mean nothing."""
    width, height = size
    if follow is not None:
        raise UserError(f"follow {follow}: camera top follows nobody; choose chase or scout")
    if len(shown) == 2:
        place = BesideFrame(*_frame_size(size))
        most = palette.most_believed(*(replay.belief for replay in shown))
        first, second = (
            _drawn_half(replay, room, most) for replay, room in zip(shown, place.rooms, strict=True)
        )
        return Beside((first, second), place).frame
    if height is not None:
        raise UserError(
            f"height {height}: the drawing from above finds its own; leave height out, or choose "
            "another camera"
        )
    if width is not None and not 320 <= width <= 7680:
        raise UserError(f"width {width}: must be 320 to 7680 pixels, for example 1280")
    return TopView(shown[0], width).frame


def _drawn_half(replay: Recording, room: tuple[int, int], most: int) -> Half:
    view = TopView(replay, room=room, most=most)
    return Half(replay, view.frame, lambda time: Moment(view.on_chart(time), "", 0.0), False, None)


def _checked(name: str, value: int | None, default: int, most: int) -> int:
    if value is not None and not LEAST <= value <= most:
        raise UserError(f"{name} {value}: must be {LEAST} to {most} pixels, for example {default}")
    return default if value is None else value


def _frames(
    draw: Frame, times: NDArray[np.float64], progress: Progress | None
) -> Iterator[NDArray[np.uint8]]:
    """One frame after the other; none is kept."""
    for done, time in enumerate(times.tolist(), start=1):
        yield draw(time)
        if progress is not None:
            progress(done, len(times))
