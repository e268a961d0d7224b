"""The command line: one function per command, thin over the library."""

import logging
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Literal

import cyclopts
from cyclopts import Parameter
from rich.console import Console
from rich.logging import RichHandler
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

from mjforage import __version__
from mjforage.errors import UserError

BAD_INPUT = 2  # exit code of every error that a user can mend, an interruption included

app = cyclopts.App(
    name="mjforage",
    version=__version__,
    help="Cooperative foraging by autonomous surface vehicles: run, measure, compare, look.",
    help_format="plaintext",
    suppress_keyboard_interrupt=False,
)
PIPE_COLUMNS = 400  # tables keep their natural width where stdout is no terminal

output = Console(markup=False, highlight=False)
if not output.is_terminal and "COLUMNS" not in os.environ:
    output.width = PIPE_COLUMNS
errors = Console(stderr=True, soft_wrap=True, highlight=False)

Policies = Annotated[list[str], Parameter(name="--policy", negative="")]
Overrides = Annotated[tuple[str, ...], Parameter(name="--set", negative="")]


@contextmanager
def _bar(words: str) -> Iterator["_Bar"]:
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
    )
    hidden = not errors.is_terminal
    with Progress(*columns, console=errors, transient=True, disable=hidden) as progress:
        yield _Bar(progress, words)


class _Bar:
    """A progress bar that appears with the first report."""

    def __init__(self, progress: Progress, words: str) -> None:
        self._progress, self._words = progress, words
        self._task = progress.add_task(words, total=None)

    def __call__(self, done: int, total: int) -> None:
        self._progress.update(self._task, completed=done, total=total)


@app.command
def evaluate(
    scenario: str = "comb-port",
    /,
    *,
    policy: Policies,
    world: Literal["graph"] = "graph",
    episodes: int = 100,
    seed: int = 0,
    map: str | None = None,
    set: Overrides = (),
    jobs: int = 1,
    out: Path | None = None,
) -> None:
    """Run policies on the same episodes; write logs, tables, figures and report.html.

    Parameters
    ----------
    scenario
        Name of a preset (see `mjforage scenarios`) or path of a TOML file.
    policy
        A policy (see `mjforage policies`); repeat the flag for several.
    world
        Dynamics.
    episodes
        Episodes per policy.
    seed
        Seed of the run; episode i is the same world for every policy.
    map
        Map that replaces the scenario's grid: a name, CSV or image. Starts and all else stay.
    set
        Override KEY=VALUE in TOML syntax, for example team.scouts.count=3; repeatable.
    jobs
        Worker processes.
    out
        Run folder; default runs/SCENARIO. An unfinished run of the same settings is resumed.
    """
    from mjforage.mission import Setting
    from mjforage.report import terminal_table, write_report
    from mjforage.scenario_file import load_scenario
    from mjforage.studies.evaluate import check_policies
    from mjforage.studies.evaluate import evaluate as run

    check_policies(policy)
    setting = Setting.of(load_scenario(scenario, set, map))
    folder = out or Path("runs") / setting.scenario.name
    shares = ", ".join(f"{n} reach {share:.0%}" for n, share in setting.reachable_shares.items())
    rows, columns = setting.graph.shape
    output.print(
        f"{setting.scenario.name} on map {setting.grid.name} ({rows} x {columns}, "
        f"{len(setting.graph)} nodes; {shares} of them)"
    )
    with _bar("episodes") as bar:
        summary = run(
            setting,
            policy,
            folder,
            episodes=episodes,
            seed=seed,
            jobs=jobs,
            worlds=(world,),
            progress=bar,
        )
    output.print(terminal_table(summary))
    with errors.status("drawing the report"):
        path = write_report(folder)
    output.print(f"report: {path}", soft_wrap=True)


@app.command
def report(folder: Path, /) -> None:
    """Draw tables, figures and report.html again, from a run folder's logs alone.

    Parameters
    ----------
    folder
        Folder that evaluate wrote.
    """
    from mjforage.report import write_report

    with errors.status("drawing the report"):
        path = write_report(folder)
    output.print(f"report: {path}", soft_wrap=True)


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
    with _bar("frames") as bar:
        render_replay(
            replay,
            output_file,
            start_s=start,
            duration_s=duration,
            fps=fps,
            speed=speed,
            progress=bar,
        )
    output.print(f"film: {output_file}", soft_wrap=True)


def _rounded(value: float) -> str:
    return f"{value:,.0f}" if abs(value) >= 100 else f"{value:.3g}"


@app.command
def manoeuvre(
    vessel: str,
    /,
    *,
    schedule: Path | None = None,
    test: str | None = None,
    current: str = "0@0",
    wind: str = "0@0",
    heading: float = 0.0,
    duration: float | None = None,
    dt: float = 0.05,
    out: Path | None = None,
    plot: Path | None = None,
) -> None:
    """Run one hull on open water in MuJoCo, from rest: a schedule of commands or a standard test.

    Parameters
    ----------
    vessel
        A vessel (see `mjforage vessels`) or path of a TOML file.
    schedule
        CSV with columns t_s,left,right: propeller rad/s or newtons, each row until the next.
    test
        turning-circle, turning-circle-starboard, zigzag, zigzag-20, straight, stop or drift.
    current
        SPEED@DIRECTION it flows to [m/s, degrees counter-clockwise from east].
    wind
        The same for the wind.
    heading
        At the start [degrees counter-clockwise from east].
    duration
        How long [s]; default the test's own, or 60 s beyond the schedule.
    dt
        Step of the integration, RK4 [s].
    out
        CSV to write: t_s,x_m,y_m,yaw_rad,surge_mps,sway_mps,yaw_rate_radps.
    plot
        Picture to write.
    """
    from mjforage.manoeuvre import key_figures, manoeuvre_figure, write_trajectory
    from mjforage.manoeuvre import manoeuvre as run
    from mjforage.simulation.hull import MujocoHull
    from mjforage.storage import writing

    path = run(vessel, schedule, test, current, wind, heading, duration, dt, MujocoHull)
    if out is not None:
        write_trajectory(path, out)
    if plot is not None:
        with writing(plot):
            manoeuvre_figure(path).savefig(plot)
    table = Table("figure", "value", "unit", "meaning")
    for name, figure in key_figures(path).items():
        table.add_row(name, f"{figure.value:.4g}", figure.unit, figure.meaning)
    output.print(table)


@app.command
def vessels() -> None:
    """List the vessels that ship with the package."""
    from mjforage.vessels import load_vessel, vessel_names

    hulls = [load_vessel(name) for name in vessel_names()]
    _list((v.name, f"{v.length_m:g} x {v.beam_m:g} m, {v.mass_kg:g} kg") for v in hulls)


@app.command
def bench(*, json_file: Annotated[Path | None, Parameter(name="--json")] = None) -> None:
    """Measure speeds on this machine, in CPU seconds of one core.

    Parameters
    ----------
    json_file
        Also write {key: {"value", "unit"}} to this file.
    """
    from mjforage.bench import bench as measure
    from mjforage.storage import write_json

    if json_file is not None and not json_file.parent.is_dir():
        raise UserError(f"--json {json_file}: cannot be written, no folder {json_file.parent}")

    with errors.status("measuring") as status:
        figures = measure(lambda key: status.update(f"measuring {key}"))
    table = Table("figure", "value", "unit")
    for key, figure in figures.items():
        table.add_row(key, _rounded(float(figure["value"])), str(figure["unit"]))
    output.print(table)
    if json_file is not None:
        write_json(json_file, figures)


@app.command
def policies() -> None:
    """List the policies."""
    from graph_planner.policies.registry import policy_summary

    _list((name, policy_summary(name)) for name in _policy_names())


def _policy_names() -> list[str]:
    from graph_planner.policies import policy_names

    return policy_names()


@app.command
def scenarios() -> None:
    """List the scenarios that ship with the package."""
    from mjforage.scenario_file import load_scenario, preset_names

    _list((name, load_scenario(name).description) for name in preset_names())


@app.command
def maps(
    map: str | None = None,
    /,
    *,
    output_file: Annotated[Path | None, Parameter(name=("--output", "-o"))] = None,
) -> None:
    """List the maps, or check one and draw it.

    Parameters
    ----------
    map
        Name of a shipped map, or path of a CSV file or image.
    output_file
        Picture to write, for example harbour.png.
    """
    from mjforage.map_files import shipped_maps
    from mjforage.map_pictures import save_map_picture
    from mjforage.maps import load_map

    for name in (map,) if map else shipped_maps():
        grid = load_map(name, corner_cutting=True)
        rows, columns = grid.navigable.shape
        output.print(f"{grid.name}: {rows} x {columns}, {grid.nodes} nodes")
        if output_file is not None and map:
            save_map_picture(grid, output_file)


def _list(rows: "Iterator[tuple[str, str]] | Sequence[tuple[str, str]]") -> None:
    table = Table(box=None, show_header=False, pad_edge=False)
    for name, words in rows:
        table.add_row(Text(name, style="bold"), Text(words))
    output.print(table)


def main(arguments: Sequence[str] | None = None) -> None:
    """Entry point: one clear line and exit code 2 for everything that a user can mend."""
    logging.basicConfig(
        level=logging.WARNING,
        format="%(message)s",
        handlers=[RichHandler(console=errors, show_time=False, show_path=False)],
    )
    try:
        app(arguments, exit_on_error=False, print_error=False)
    except (UserError, cyclopts.CycloptsError) as error:
        words = " ".join(str(error).split())
        errors.print(f"mjforage: {words}", style="red", markup=False)
        sys.exit(BAD_INPUT)
    except OSError as error:  # of a file that is nobody's in particular, such as a compiler's cache
        where, reason = error.filename or "a file", error.strerror or str(error)
        errors.print(
            f"mjforage: {where}: {reason}; free some space or mend its permissions, then run the "
            "same command again",
            style="red",
            markup=False,
        )
        sys.exit(BAD_INPUT)
    except KeyboardInterrupt:
        errors.print(
            "mjforage: interrupted; finished work is kept, run the same command again to resume",
            style="red",
        )
        sys.exit(BAD_INPUT)
