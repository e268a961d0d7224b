"""`mjforage export` and `mjforage stream`."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter, validators

from mjforage.base.errors import UserError
from mjforage.cli.console import FOLDER, app, output
from mjforage.cli.flags import NOBODY, Map, Overrides, Trusted, WaterOf
from mjforage.cli.progress import working


@app.command
def export(
    source: str,
    /,
    *,
    to: str,
    out: Annotated[Path, FOLDER],
    episode: int = 0,
    policy: str | None = None,
    world: str | None = None,
    seed: int | None = None,
    map: Map = None,
    water: WaterOf = None,
    set: Overrides = (),
    known: Trusted = NOBODY,
) -> None:
    """Write an episode in a format of other programs: of a run all of it, of a scenario its start.

    csv: tracks.csv and items.csv. geojson: a line with times per vessel and item. gpx: a route and
    a track per vessel. mcap: a bag of ROS 2. mjcf: a scene that opens in MuJoCo without mjforage,
    and a README with the forces that are not in it. netcdf: trajectories by the CF conventions.
    qgc: a mission file of ArduPilot per vessel. geojson, gpx and qgc need a place.

    Parameters
    ----------
    source
        Folder that evaluate or compare wrote; or name of a preset (see `mjforage scenarios`), or
        path of a TOML file.
    to
        Format: csv, geojson, gpx, mcap, mjcf, netcdf or qgc.
    out
        Folder to write, empty or not there yet.
    episode
        Number of the episode.
    policy
        Policy of the run; default its first one.
    world
        World of the run; default its first.
    seed
        Seed of the scenario's episode; default 0.
    """
    from mjforage.api.evaluating import load_run
    from mjforage.api.scenarios import Scenario
    from mjforage.physics.vessel_moves import with_moves
    from mjforage.scenario.scenario_file import load_scenario

    run = (Path(source) / "run.json").is_file()
    of_run = {"policy": policy, "world": world}
    of_scenario = {"seed": seed, "map": map, "water": water, "set": set or None}
    for name, value in (of_scenario if run else of_run).items():
        if value is not None:
            kind, other = ("scenario", "run") if run else ("run", "scenario")
            raise UserError(f"--{name}: is for the export of a {kind}; {source} is a {other}")
    with working("export"):
        if run:
            load_run(source).export(out, to, policy=policy, world=world, episode=episode)
        else:
            scenario = Scenario.of(load_scenario(source, set, map, water), derive=with_moves)
            scenario.export(out, to, seed=seed or 0, episode=episode)
    output.print(f"export: {out}", soft_wrap=True)


@app.command
def stream(
    folder: Path,
    /,
    *,
    episode: int = 0,
    policy: str | None = None,
    world: str | None = None,
    port: Annotated[int, Parameter(validator=validators.Number(gte=0, lte=65535))] = 8765,
    speed: float = 10.0,
    known: Trusted = NOBODY,
) -> None:
    """Serve an episode of a run live to a viewer on this machine, such as Foxglove.

    It begins when a viewer has subscribed to a topic. The topics are those of `export --to mcap`.

    Parameters
    ----------
    folder
        Folder that evaluate or compare wrote.
    episode
        Number of the episode.
    policy
        Policy; default the first one of the run.
    world
        A world of the run; default its first.
    port
        Port of this machine; 0 for any that is free.
    speed
        Simulated seconds per second.
    """
    from mjforage.api.evaluating import load_run

    def ready(address: str) -> None:
        output.print(f"stream: {address}", soft_wrap=True)

    run = load_run(folder, policies=[policy] if policy else [])
    run.stream(policy=policy, world=world, episode=episode, port=port, speed=speed, ready=ready)
