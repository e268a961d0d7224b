"""`mjforage export`."""

from pathlib import Path
from typing import Annotated

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

    mjcf: scene.xml, which opens in MuJoCo without mjforage; tracks.csv; and README.md, with the
    forces that are not in the scene.

    Parameters
    ----------
    source
        Folder that evaluate or compare wrote; or name of a preset (see `mjforage scenarios`), or
        path of a TOML file.
    to
        Format: mjcf.
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
            scenario = Scenario.of(load_scenario(source, set, map, water))
            scenario.export(out, to, seed=seed or 0, episode=episode)
    output.print(f"export: {out}", soft_wrap=True)
