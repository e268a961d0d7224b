"""`mjforage render`: films and pictures of episodes."""

from pathlib import Path
from typing import Annotated, Any, Literal

from mjforage.cli.console import OUT, app, output
from mjforage.cli.flags import NOBODY, Trusted
from mjforage.cli.progress import bar

Point = Literal["overview", "chase", "top", "scout"]


@app.command
def render(
    folder: Path,
    /,
    *,
    output_file: Annotated[Path, OUT],
    episode: int = 0,
    policy: str | None = None,
    beside: str | None = None,
    world: str | None = None,
    camera: Point | None = None,
    follow: str | None = None,
    seen_by: str = "all",
    start: float = 0.0,
    duration: float | None = None,
    fps: float = 30.0,
    speed: float | None = None,
    width: int | None = None,
    height: int | None = None,
    known: Trusted = NOBODY,
) -> None:
    """Show one episode of a run: MP4, GIF, or PNG (one frame, or a numbered series).

    The episode is simulated again from run.json and checked against the run's logs. The graph world
    from above is a plain drawing; everything else is drawn by MuJoCo through EGL or OSMesa, without
    a display. Waves, rocking vessels and bobbing items are drawn, not simulated.

    Parameters
    ----------
    folder
        Folder that evaluate or compare wrote.
    output_file
        FILE.mp4, FILE.gif, FILE.png, or frames-%04d.png for a series.
    episode
        Number of the episode.
    policy
        Policy; default the first one of the run.
    beside
        Another policy of the run, shown to the right of it in the same episode.
    world
        A world of the run; default its first.
    camera
        Point of view; default top for graph, else overview.
    follow
        Vessel of the cameras chase and scout, for example foragers_1.
    seen_by
        Vessel by whose knowledge the map and the inset are drawn, for example scouts_0, where the
        run has a link; default what all know together.
    start
        Time at which to begin [simulated s].
    duration
        Time to show [simulated s]; default to the end.
    fps
        Frames per second of the film.
    speed
        Simulated seconds per second of film; default four decisions per second, for chase and scout
        one.
    width
        Width of a frame [pixel]; default 1280, or 16/9 of the height.
    height
        Height of a frame [pixel]; default 9/16 of the width.
    """
    from mjforage.api.evaluating import load_run

    view: dict[str, Any] = {"camera": camera, "follow": follow, "seen_by": seen_by}
    view |= {"size": (width, height), "start_s": start, "duration_s": duration}
    view |= {"world": world, "episode": episode, "beside": beside, "fps": fps, "speed": speed}
    named = [one for one in (policy, beside) if one is not None]
    with bar("render", "frames") as progress:
        load_run(folder, policies=named).film(output_file, policy, progress=progress, **view)
    kind = "picture" if output_file.suffix.lower() == ".png" else "film"
    output.print(f"{kind}: {output_file}", soft_wrap=True)
