"""Commands that make, read and draw run folders."""

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from mjforage.cli.console import app, bar, errors, output

Policies = Annotated[list[str], Parameter(name="--policy", negative="")]
Overrides = Annotated[tuple[str, ...], Parameter(name="--set", negative="")]


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
    with bar("episodes") as shown:
        summary = run(
            setting,
            policy,
            folder,
            episodes=episodes,
            seed=seed,
            jobs=jobs,
            worlds=(world,),
            progress=shown,
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
