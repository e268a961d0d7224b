"""`mjforage study ...`: variants of a scenario, or benchmark tasks, on the same episodes."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import cyclopts
from cyclopts import Parameter

from mjforage.cli.console import FOLDER, app, output
from mjforage.cli.flags import (
    NOBODY,
    SAME_ONLY,
    THIS_PROCESS,
    By,
    Computing,
    GoingOn,
    Map,
    Metrics,
    Overrides,
    Policies,
    Resuming,
    Scenario,
    Trusted,
    WaterOf,
    Words,
)
from mjforage.cli.progress import bar, working
from mjforage.runs.studies.kinds import KINDS, STEP

if TYPE_CHECKING:
    from mjforage.api.studies import Study
    from mjforage.runs.studies.study import Study as Plan

study = cyclopts.App(
    name="study", help="Studies: many variants of a scenario on the same episodes, in one report."
)
app.command(study)


@dataclass(frozen=True)
class StudyOptions:
    """Options of every study.

    Parameters
    ----------
    world
        graph or physics, or a world between; repeat the flag for several.
    episodes
        Episodes per variant, policy and world; a larger number extends --out.
    seed
        Seed of the study; episode i is the same in every variant.
    out
        Study folder; default runs/SCENARIO-KIND. An unfinished study of the same settings is
        resumed.
    """

    world: Words = ("graph",)
    episodes: int = 100
    seed: int = 0
    map: Map = None
    water: WaterOf = None
    set: Overrides = ()
    metric: Metrics = ()
    out: Annotated[Path | None, FOLDER] = None


@dataclass(frozen=True)
class Draws:
    """Corruption of teams.

    Parameters
    ----------
    step
        Distance of the levels of corruption from 0 to 1.
    whole_team
        One draw corrupts the whole team, and random foragers still take a known item beside them:
        the rule of the published code, which made the paper's slopes. With --per-agent every agent
        has its own draw, as the paper defines it. Default per agent; for the paper whole team.
    """

    step: float = STEP
    whole_team: Annotated[bool | None, Parameter(negative=("--per-agent", "--no-whole-team"))] = (
        None
    )


DEFAULT, USUAL = StudyOptions(), Draws()
With = Annotated[StudyOptions, Parameter(name="*")]
Corrupted = Annotated[Draws, Parameter(name="*")]


def _add(kind: str, words: str) -> None:
    """Add a study of policies in variants of a scenario."""
    usual = KINDS[kind]

    @study.command(name=kind, help=words)
    def command(
        scenario: Scenario = usual.scenario,
        /,
        *,
        policy: Policies = usual.policies,
        choice: With = DEFAULT,
        by: By = THIS_PROCESS,
        again: GoingOn = SAME_ONLY,
        known: Trusted = NOBODY,
    ) -> None:
        _play(kind, scenario, policy, choice, by, again)


def _add_corrupting(kind: str, words: str) -> None:
    """Add a study of policies in which teams are corrupted."""
    usual = KINDS[kind]

    @study.command(name=kind, help=words)
    def command(
        scenario: Scenario = usual.scenario,
        /,
        *,
        policy: Policies = usual.policies,
        draws: Corrupted = USUAL,
        choice: With = DEFAULT,
        by: By = THIS_PROCESS,
        again: GoingOn = SAME_ONLY,
        known: Trusted = NOBODY,
    ) -> None:
        told = {"step": draws.step, "whole_team": draws.whole_team}
        options = {name: value for name, value in told.items() if value is not None}
        _play(kind, scenario, policy, choice, by, again, **options)


_add(
    "ablation",
    "Value of an agent of each team: marginal contributions (the paper's Tables 5 and 6).",
)
_add(
    "communication",
    "Cost of limited range, quays, latency, losses and budgets of a link, and value of a relay.",
)
_add(
    "sensing",
    "Cost of misses and false alarms, and of wrong assumptions about them.",
)
_add_corrupting(
    "corruption",
    "Performance as a team's actions become random: sensitivity slopes (CSSC).",
)
_add_corrupting("paper", "All tables and figures of the paper, with its numbers beside ours.")


@study.command
def board(
    *courses: str,
    policy: Policies = (),
    map: Words = (),
    episodes: int = 100,
    seed: int = 0,
    set: Overrides = (),
    metric: Metrics = (),
    out: Annotated[Path, FOLDER] = Path("runs/board"),
    by: By = THIS_PROCESS,
    again: GoingOn = SAME_ONLY,
    known: Trusted = NOBODY,
) -> None:
    """Every policy on the same episodes of several courses: scores, costs, and the best of each.

    Parameters
    ----------
    courses
        SCENARIO or SCENARIO@WORLD: a preset (see `mjforage scenarios`) or a TOML file, in the graph
        world unless another is named. Default: comb-port published open-bay channels
        comb-port-weather comb-port-radio comb-port-few comb-port-clusters comb-port@physics
        comb-port-weather@physics. Without
        --policy all policies that have a name play; one that cannot play a course is left out of
        it, and the page says why.
    map
        A course more: the rules of comb-port on this map, a name, grid or image; with a world as in
        harbour.csv@physics. Starts are those beside it, or drawn by chance; repeatable.
    episodes
        Episodes per course and policy; a larger number extends --out.
    seed
        Seed of the study; episode i of a course is the same for every policy.
    out
        Study folder. An unfinished study of the same settings is resumed.
    """
    from mjforage.api.studies import board as play
    from mjforage.base.references import with_options

    asked = by.asked()
    players, overrides = with_options("policy", policy, set)
    what: dict[str, Any] = {"maps": map, "overrides": overrides, "metrics": metric}
    what |= {"episodes": episodes, "seed": seed, "folder": out, **asked}
    _finish(lambda **how: play(courses, players, **what, **how), "board", again)


def _play(
    kind: str,
    scenario: str,
    policies: Sequence[str],
    choice: StudyOptions,
    by: Computing,
    again: Resuming,
    **options: object,
) -> None:
    """Compute a study of a scenario and draw its report."""
    from mjforage.api.studies import study as play
    from mjforage.base.references import with_options
    from mjforage.physics.vessel_moves import open_setup
    from mjforage.scenario.scenario_file import load_scenario

    asked = by.asked()
    players, overrides = with_options("policy", policies, choice.set)
    setup = open_setup(load_scenario(scenario, overrides, choice.map, choice.water))
    what: dict[str, Any] = {"world": choice.world, "metrics": choice.metric, "options": options}
    what |= {"episodes": choice.episodes, "seed": choice.seed, **asked}
    what["folder"] = choice.out or Path("runs") / f"{setup.scenario.name}-{kind}"
    _finish(lambda **how: play(kind, setup, players or None, **what, **how), kind, again)


def _finish(play: "Callable[..., Study]", kind: str, again: Resuming) -> None:
    """Compute a study and draw its report; what it is of is said before the first episode."""

    def begin(words: str, plan: "Plan") -> None:
        for name, reason in dict.fromkeys((one.policy, one.reason) for one in plan.left_out):
            same = [one for one in plan.left_out if (one.policy, one.reason) == (name, reason)]
            where = ", ".join(one.variant for one in same)
            output.print(f"left out of {where}: {reason}", soft_wrap=True)
        output.print(f"{words}: {len(plan.variants)} variants, {plan.episodes} episodes each")

    with bar(f"study {kind}", "episodes") as shown:
        done = play(progress=shown, resume=again.resume, begin=begin)
    if not done.complete:
        raise KeyboardInterrupt
    with working("drawing the report"):
        path = done.report()
    output.print(f"report: {path}", soft_wrap=True)
