"""`mjforage render`: films and pictures of an episode."""

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from mjforage.cli.console import app, bar, output


@app.command
def render(
    folder: Path,
    /,
    *,
    output_file: Annotated[Path, Parameter(name=("--output", "-o"))],
    episode: int = 0,
    policy: str | None = None,
    world: Literal["graph"] = "graph",
    camera: Literal["top"] = "top",
    start: float = 0.0,
    duration: float | None = None,
    fps: float = 30.0,
    speed: float | None = None,
) -> None:
    """Draw one episode of a run: MP4, GIF, or PNG (one frame, or a numbered series).

    The episode is simulated again from run.json and checked against the run's logs.

    Parameters
    ----------
    folder
        Folder that evaluate wrote.
    output_file
        FILE.mp4, FILE.gif, FILE.png, or frames-%04d.png for a series.
    episode
        Number of the episode.
    policy
        Policy; default the first one of the run.
    world
        Dynamics.
    camera
        Point of view.
    start
        Where to begin [simulated s].
    duration
        How much to show [simulated s]; default to the end.
    fps
        Frames per second of the film.
    speed
        Simulated seconds per second of film; default four decisions per second.
    """
    from mjforage.render import render_replay
    from mjforage.studies.replaying import replay_of_run

    replay = replay_of_run(folder, world, policy, episode)
    with bar("frames") as shown:
        render_replay(
            replay,
            output_file,
            start_s=start,
            duration_s=duration,
            fps=fps,
            speed=speed,
            progress=shown,
        )
    output.print(f"film: {output_file}", soft_wrap=True)
