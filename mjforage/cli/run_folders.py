"""Commands that make, read and draw run folders."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from mjforage.cli.console import FOLDER, app, output, print_table
from mjforage.cli.flags import (
    NOBODY,
    POLICY,
    SAME_ONLY,
    THIS_PROCESS,
    By,
    Computing,
    Episodes,
    GoingOn,
    Map,
    Metrics,
    Overrides,
    Resuming,
    Scenario,
    Seed,
    Trusted,
    WaterOf,
)
from mjforage.cli.progress import bar, working
from mjforage.runs.selection import USUAL, parse_selection

if TYPE_CHECKING:
    from mjforage.api.run import Run
    from mjforage.mission.setup import Setup

Policies = Annotated[list[str], POLICY]
ShownPolicies = Annotated[tuple[str, ...], Parameter(name="--policy", negative="")]


@dataclass(frozen=True)
class RunOptions:
    """Options of evaluate and compare.

    Parameters
    ----------
    replay
        Episodes that are recorded for the report, of every world and policy: numbers and first,
        median, worst, best by the share collected, such as 0,3,worst; or none. Each is played once
        more. A finished run is added to by the same command.
    detect
        Also print how many episodes a difference of this size in PTA_C [%] needs to be found in
        80 % of the runs, by the spread of the differences of this run.
    device
        Engine of the hulls: cpu, or MuJoCo Warp on this processor (warp-cpu) or on a GPU (cuda).
    """

    metric: Metrics = ()
    seed: Seed = 0
    map: Map = None
    water: WaterOf = None
    set: Overrides = ()
    replay: str = ",".join(str(one) for one in USUAL)
    detect: float | None = None
    device: str | None = None


DEFAULT = RunOptions()
With = Annotated[RunOptions, Parameter(name="*")]


@app.command
def evaluate(
    scenario: Scenario = "comb-port",
    /,
    *,
    policy: Policies,
    world: str = "graph",
    episodes: Episodes = 100,
    choice: With = DEFAULT,
    by: By = THIS_PROCESS,
    again: GoingOn = SAME_ONLY,
    known: Trusted = NOBODY,
    out: Annotated[Path | None, FOLDER] = None,
) -> None:
    """Run policies on the same episodes; write logs, tables, figures and report.html.

    Parameters
    ----------
    world
        graph or physics, or a world between: hulls, debris, intake (see `mjforage compare`).
    out
        Run folder; default runs/SCENARIO. An unfinished run of the same settings is resumed.
    """
    from mjforage.api.evaluating import evaluate as play

    setup, players = _setup(scenario, policy, choice)
    folder = out or Path("runs") / setup.scenario.name
    what: dict[str, Any] = {"world": world, "episodes": episodes}  # a word, which it checks
    _play("evaluate", partial(play, setup, players, **what), setup, folder, choice, by, again)


@app.command
def compare(
    scenario: Scenario = "comb-port",
    /,
    *,
    policy: Policies,
    ladder: bool = False,
    episodes: Episodes = 20,
    choice: With = DEFAULT,
    by: By = THIS_PROCESS,
    again: GoingOn = SAME_ONLY,
    known: Trusted = NOBODY,
    out: Annotated[Path | None, FOLDER] = None,
) -> None:
    """Run policies on the same episodes at graph level and in MuJoCo; report the reality gap.

    Parameters
    ----------
    ladder
        Also the fidelity levels between, each with one effect more: hulls, debris, intake.
    out
        Run folder; default runs/SCENARIO-gap. An unfinished run of the same settings is resumed.
    """
    from mjforage.api.evaluating import compare as play

    setup, players = _setup(scenario, policy, choice)
    folder = out or Path("runs") / f"{setup.scenario.name}-gap"
    call = partial(play, setup, players, ladder=ladder, episodes=episodes)
    _play("compare", call, setup, folder, choice, by, again)


def _setup(scenario: str, policies: Sequence[str], choice: RunOptions) -> "tuple[Setup, list[str]]":
    from mjforage.base.references import with_options
    from mjforage.physics.vessel_moves import open_setup
    from mjforage.scenario.scenario_file import load_scenario

    players, overrides = with_options("policy", policies, choice.set)
    return open_setup(load_scenario(scenario, overrides, choice.map, choice.water)), players


def _play(
    words: str,
    play: "Callable[..., Run]",
    setup: "Setup",
    folder: Path,
    choice: RunOptions,
    by: Computing,
    again: Resuming,
) -> None:
    """Run, show the headline table and draw the report."""
    from mjforage.base.errors import UserError
    from mjforage.runs.run_info import load_run, read_json
    from mjforage.view.report import needed_table, terminal_table

    recorded = parse_selection(choice.replay)
    if choice.detect is not None and not 0 < choice.detect < math.inf:
        raise UserError(f"--detect {choice.detect:g}: give a difference above 0, such as 1.0")
    shares = ", ".join(f"{n} reach {share:.0%}" for n, share in setup.reachable_shares.items())
    rows, columns = setup.graph.shape
    output.print(
        f"{setup.scenario.name} on map {setup.grid.name} ({rows} x {columns}, "
        f"{len(setup.graph)} nodes; {shares} of them)"
    )
    how: dict[str, Any] = {"seed": choice.seed, "metrics": choice.metric, "record": recorded}
    how |= {"resume": again.resume, "device": choice.device, **by.asked()}
    with bar(words, "episodes") as progress:
        run = play(folder=folder, progress=progress, **how)
    if not run.complete:
        raise KeyboardInterrupt
    about = load_run(folder / "run.json")
    print_table(terminal_table(read_json(folder / "summary.json"), about.bounds, about.told))
    if choice.detect is not None:
        print_table(needed_table(run.episodes_needed(choice.detect), choice.detect))
    with working("drawing the report"):
        path = run.report()
    output.print(f"report: {path}", soft_wrap=True)


@app.command
def answer(folders: Annotated[list[Path], Parameter(negative="")], /) -> None:
    """Print how long it took to collect 50, 90 and 99 % of the items, of one run or of several.

    Fleets side by side are runs of the same scenario, such as with --set team.foragers.count=4.

    Parameters
    ----------
    folders
        Folders that evaluate or compare wrote.
    """
    from mjforage.view.report import clearing_table, load_logs, plain_table

    table = clearing_table(*map(load_logs, folders))
    print_table(plain_table(table))
    output.print(table.notes[0], soft_wrap=True)


@app.command
def report(
    folder: Path,
    /,
    *,
    tables: str = "",
    figures: str = "",
    policy: ShownPolicies = (),
    page: Path | None = None,
    known: Trusted = NOBODY,
) -> None:
    """Draw tables, figures and report.html again, from the logs of a run or study alone.

    Parameters
    ----------
    folder
        Folder that evaluate, compare or study wrote.
    tables
        Write every table into tables/ as well, in these formats: latex csv markdown.
    figures
        Write every figure into figures/ in these formats: pdf png svg; letters stay text.
    policy
        Show these policies of a run alone; repeatable. By default all, or of more than 20 the best.
    page
        Write a board (`mjforage study board`) as one Markdown page here too, its figures beside it.
    """
    from mjforage.api.evaluating import load_run
    from mjforage.api.studies import Study
    from mjforage.base.errors import UserError
    from mjforage.view.report.studies import is_study

    formats: dict[str, Any] = {"tables": _listed(tables), "figures": _listed(figures)}
    if page is not None and not folder.is_dir():
        raise UserError(f"--page {page}: {folder} is not there; name the folder of a board")
    if page is not None and not is_study(folder):
        raise UserError(f"--page {page}: is for a board; name the folder of one")
    if policy and is_study(folder):
        raise UserError(f"--policy {policy[0]}: is for the report of one run; name its folder")
    with working("drawing the report"):
        if is_study(folder):
            study = Study(folder)
            if page is not None:
                study.board_page(page)
            path = study.report(**formats)
        else:
            path = load_run(folder).report(policies=policy, **formats)
    output.print(f"report: {path}", soft_wrap=True)


def _listed(text: str) -> list[str]:
    """Words of a text with commas between them."""
    return [word.strip() for word in text.split(",")] if text.strip() else []
