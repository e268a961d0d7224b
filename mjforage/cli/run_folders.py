"""Commands that make, read and draw run folders."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypedDict

from cyclopts import Parameter

from mjforage.cli.computing import THIS_PROCESS, By, Computing
from mjforage.cli.console import FOLDER, Water, app, bar, output, print_table, working
from mjforage.cli.resume_flags import SAME_ONLY, GoingOn, Resuming
from mjforage.cli.trust_flags import NOBODY, Trusted

if TYPE_CHECKING:
    from mjforage.mission.setup import Setup

Policies = Annotated[list[str], Parameter(name="--policy", negative="")]
ShownPolicies = Annotated[tuple[str, ...], Parameter(name="--policy", negative="")]
Metrics = Annotated[tuple[str, ...], Parameter(name="--metric", negative="")]
Overrides = Annotated[tuple[str, ...], Parameter(name="--set", negative="")]


class Plan(TypedDict):
    """What a run is besides its scenario and its policies."""

    worlds: tuple[str, ...]
    episodes: int
    seed: int
    metrics: tuple[str, ...]
    kept: tuple[str | int, ...]


@app.command
def evaluate(
    scenario: str = "comb-port",
    /,
    *,
    policy: Policies,
    metric: Metrics = (),
    world: str = "graph",
    episodes: int = 100,
    seed: int = 0,
    map: str | None = None,
    water: Water | None = None,
    set: Overrides = (),
    replay: str = "first,median,worst",
    by: By = THIS_PROCESS,
    again: GoingOn = SAME_ONLY,
    known: Trusted = NOBODY,
    out: Annotated[Path | None, FOLDER] = None,
) -> None:
    """Run policies on the same episodes; write logs, tables, figures and report.html.

    Parameters
    ----------
    scenario
        Name of a preset (see `mjforage scenarios`) or path of a TOML file.
    policy
        A policy (see `mjforage policies`), MODULE:CLASS of your own, or NAME for weights
        NAME.safetensors here; with options as in "greedy(distance=2)". Several may follow the flag.
    metric
        A metric to take beside ours: MODULE:CLASS of your own, or one of a package; repeatable.
    world
        graph or physics, or a world between: hulls, debris, intake (see `mjforage compare`).
    episodes
        Episodes per policy; what --out holds goes on to more.
    seed
        Seed of the run; episode i is the same world for every policy.
    map
        Map that replaces the scenario's grid: a name, harbour:KIND:SEED[:ROWSxCOLUMNS], table,
        grid or image. All else stays, starts too unless it is a generated harbour: drawn there.
    water
        Which cells of that file are water, light or dark: pixels of an image, 1 or 0 of a table.
    set
        Override KEY=VALUE in TOML syntax, for example team.scouts.count=3, or
        policy.greedy.distance=2 for an option of a policy; repeatable.
    replay
        Episodes whose replays are kept for the report, of every world and policy: numbers and
        first, median, worst, best by the share collected, such as 0,3,worst; or none. Each is
        played once more. A finished run is added to by the same command.
    out
        Run folder; default runs/SCENARIO. An unfinished run of the same settings is resumed.
    """
    from mjforage.base.references import with_options
    from mjforage.mission.setup import Setup
    from mjforage.runs.kept import parse_kept
    from mjforage.scenario.scenario_file import load_scenario

    policy, set = with_options("policy", policy, set)
    setup = Setup.of(load_scenario(scenario, set, map, water))
    folder = out or Path("runs") / setup.scenario.name
    plan: Plan = {
        "worlds": (world,),
        "episodes": episodes,
        "seed": seed,
        "metrics": metric,
        "kept": parse_kept(replay),
    }
    _play("evaluate", setup, policy, folder, plan, by, again)


@app.command
def compare(
    scenario: str = "comb-port",
    /,
    *,
    policy: Policies,
    metric: Metrics = (),
    ladder: bool = False,
    episodes: int = 20,
    seed: int = 0,
    map: str | None = None,
    water: Water | None = None,
    set: Overrides = (),
    replay: str = "first,median,worst",
    by: By = THIS_PROCESS,
    again: GoingOn = SAME_ONLY,
    known: Trusted = NOBODY,
    out: Annotated[Path | None, FOLDER] = None,
) -> None:
    """Run policies on the same episodes at graph level and in MuJoCo; report the reality gap.

    Parameters
    ----------
    scenario
        Name of a preset (see `mjforage scenarios`) or path of a TOML file.
    policy
        A policy (see `mjforage policies`), MODULE:CLASS of your own, or NAME for weights
        NAME.safetensors here; with options as in "greedy(distance=2)". Several may follow the flag.
    metric
        A metric to take beside ours: MODULE:CLASS of your own, or one of a package; repeatable.
    ladder
        Also the worlds between, one piece of reality more in each: hulls, debris, intake.
    episodes
        Episodes per policy and world; what --out holds goes on to more.
    seed
        Seed of the run; episode i is the same in every world and for every policy.
    map
        Map that replaces the scenario's grid: a name, harbour:KIND:SEED[:ROWSxCOLUMNS], table,
        grid or image. All else stays, starts too unless it is a generated harbour: drawn there.
    water
        Which cells of that file are water, light or dark: pixels of an image, 1 or 0 of a table.
    set
        Override KEY=VALUE in TOML syntax, for example weather.gust_intensity=0.2; repeatable.
    replay
        Episodes whose replays are kept for the report, of every world and policy: numbers and
        first, median, worst, best by the share collected, such as 0,3,worst; or none. Each is
        played once more. A finished run is added to by the same command.
    out
        Run folder; default runs/SCENARIO-gap. An unfinished run of the same settings is resumed.
    """
    from mjforage.base.references import with_options
    from mjforage.mission.setup import Setup
    from mjforage.physics.worlds import ladder_of
    from mjforage.runs.kept import parse_kept
    from mjforage.scenario.scenario_file import load_scenario

    policy, set = with_options("policy", policy, set)
    setup = Setup.of(load_scenario(scenario, set, map, water))
    worlds = ladder_of(setup.scenario) if ladder else ("graph", "physics")
    folder = out or Path("runs") / f"{setup.scenario.name}-gap"
    plan: Plan = {
        "worlds": worlds,
        "episodes": episodes,
        "seed": seed,
        "metrics": metric,
        "kept": parse_kept(replay),
    }
    _play("compare", setup, policy, folder, plan, by, again)


def _play(
    words: str,
    setup: "Setup",
    policies: list[str],
    folder: Path,
    plan: Plan,
    by: Computing,
    again: Resuming,
) -> None:
    """Run, show the headline table and draw the report."""
    from mjforage.graph_planner.policies import is_upper_bound
    from mjforage.runs.evaluate import evaluate as run
    from mjforage.view.report import terminal_table, write_report

    shares = ", ".join(f"{n} reach {share:.0%}" for n, share in setup.reachable_shares.items())
    rows, columns = setup.graph.shape
    output.print(
        f"{setup.scenario.name} on map {setup.grid.name} ({rows} x {columns}, "
        f"{len(setup.graph)} nodes; {shares} of them)"
    )
    with bar(words, "episodes") as shown:
        summary = run(
            setup,
            policies,
            folder,
            **plan,
            workers=by.workers,
            progress=shown,
            resume=again.resume,
        )
    bounds = {policy for found in summary.values() for policy in found if is_upper_bound(policy)}
    print_table(terminal_table(summary, bounds))
    with working("drawing the report"):
        path = write_report(folder)
    output.print(f"report: {path}", soft_wrap=True)


@app.command
def report(
    folder: Path,
    /,
    *others: Path,
    out: Annotated[Path | None, FOLDER] = None,
    tables: str = "",
    figures: str = "",
    policy: ShownPolicies = (),
    page: Path | None = None,
    known: Trusted = NOBODY,
) -> None:
    """Draw tables, figures and report.html again, from the logs of a run or study alone.

    With two run folders: one page with the replays of both and their paired differences, if they
    share episodes, which is the same seed, map and items.

    Parameters
    ----------
    folder
        Folder that evaluate, compare or study wrote.
    others
        A second run, to compare the first with.
    out
        Folder for the page on two runs; default FOLDER/compared-with-NAME.
    tables
        Write every table of one run or study into tables/ as well, in these formats: latex csv
        markdown.
    figures
        Write every figure of one run or study into figures/ in these formats: pdf png svg; letters
        stay text.
    policy
        Show these policies of a run alone; repeatable. By default all, or of more than 20 the best
        and the worst.
    page
        Write a board (`mjforage study board`) as one Markdown page here too, its figures beside it.
    """
    from mjforage.base.errors import UserError
    from mjforage.view.report import Exports, write_pair, write_report
    from mjforage.view.report.studies import is_study, write_study_report
    from mjforage.view.report.studies.board_page import write_board_page

    wanted = Exports.of(tables, figures)
    if len(others) > 1:
        raise UserError(f"report of {1 + len(others)} folders: name one, or two runs to compare")
    if out is not None and not others:
        raise UserError(f"--out {out}: is for a page on two runs; name two run folders")
    if others and (tables or figures):
        raise UserError("--tables and --figures: are of one run or study; name one folder")
    if page is not None and not folder.is_dir():
        raise UserError(f"--page {page}: {folder} is not there; name the folder of a board")
    if page is not None and (others or not is_study(folder)):
        raise UserError(f"--page {page}: is for a board; name the folder of one")
    if policy and (others or is_study(folder)):
        raise UserError(f"--policy {policy[0]}: is for the report of one run; name its folder")
    for one in (folder, *others) if others else ():
        if is_study(one):
            raise UserError(f"{one}: holds a study; name two runs, such as those in its variants/")
    with working("drawing the report"):
        if others:
            path = write_pair(folder, others[0], out)
        elif is_study(folder):
            if page is not None:
                write_board_page(folder, page)
            path = write_study_report(folder, wanted)
        else:
            path = write_report(folder, wanted, policy)
    output.print(f"report: {path}", soft_wrap=True)
