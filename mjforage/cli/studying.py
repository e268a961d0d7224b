"""`mjforage study ...`: what parts, agents and teams are worth, over variants of a scenario."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import cyclopts
from cyclopts import Parameter

from mjforage.cli.computing import THIS_PROCESS, By, Computing
from mjforage.cli.console import FOLDER, Water, app, bar, output, working
from mjforage.cli.resume_flags import SAME_ONLY, GoingOn, Resuming
from mjforage.cli.trust_flags import NOBODY, Trusted

if TYPE_CHECKING:
    from mjforage.runs.study import Study, Variant
    from mjforage.scenario.scenario import Scenario

study = cyclopts.App(
    name="study", help="Studies: many variants of a scenario on the same episodes, in one report."
)
app.command(study)

Names = Annotated[tuple[str, ...], Parameter(negative="")]
Policies = Annotated[tuple[str, ...], Parameter(name="--policy", negative="")]
PAPER = ("ddqn", "ddqn-reward", "greedy", "levy", "wanderer")
INFORMED = ("greedy", "belief", "ddqn")


@dataclass(frozen=True)
class StudyOptions:
    """What every study is told.

    Parameters
    ----------
    world
        graph or physics, or a world between; repeat the flag for several.
    episodes
        Episodes per variant, policy and world; what --out holds goes on to more.
    seed
        Seed of the study; episode i is the same in every variant.
    map
        Map that replaces the scenario's grid: a name, harbour:KIND:SEED[:ROWSxCOLUMNS], table,
        grid or image. All else stays, starts too unless it is a generated harbour: drawn there.
    water
        Which cells of that file are water, light or dark: pixels of an image, 1 or 0 of a table.
    set
        Override KEY=VALUE in TOML syntax, for example team.scouts.count=3, or
        policy.greedy.distance=2 for an option of a policy; repeatable.
    metric
        A metric to take beside ours: MODULE:CLASS of your own, or one of a package; repeatable.
    out
        Study folder; default runs/SCENARIO-KIND. An unfinished study of the same settings is
        resumed.
    """

    world: Names = ("graph",)
    episodes: int = 100
    seed: int = 0
    map: str | None = None
    water: Water | None = None
    set: Names = ()
    metric: Names = ()
    out: Annotated[Path | None, FOLDER] = None


@dataclass(frozen=True)
class Draws:
    """How teams are corrupted.

    Parameters
    ----------
    step
        Distance of the levels of corruption from 0 to 1.
    whole_team
        One draw corrupts the whole team, and random foragers still take a known item beside them:
        the rule of the published code, which made the paper's slopes. Without it every agent has
        its own draw, as defined.
    """

    step: float = 0.05
    whole_team: bool = False


@dataclass(frozen=True)
class PaperDraws:
    """How teams are corrupted, unless told otherwise as in the paper's runs.

    Parameters
    ----------
    step
        Distance of the levels of corruption from 0 to 1.
    whole_team
        One draw corrupts the whole team, and random foragers still take a known item beside them:
        the rule of the published code, which made the paper's slopes. With --per-agent every agent
        has its own draw, as the paper defines it.
    """

    step: float = 0.05
    whole_team: Annotated[bool, Parameter(negative=("--per-agent", "--no-whole-team"))] = True


DEFAULT, USUAL, AS_PRINTED = StudyOptions(), Draws(), PaperDraws()
With = Annotated[StudyOptions, Parameter(name="*")]
Corrupted = Annotated[Draws, Parameter(name="*")]
Printed = Annotated[PaperDraws, Parameter(name="*")]


@study.command
def parts(
    scenario: str = "published",
    /,
    *,
    choice: With = DEFAULT,
    by: By = THIS_PROCESS,
    again: GoingOn = SAME_ONLY,
    known: Trusted = NOBODY,
) -> None:
    """What each part of the belief planner is worth, and what wrong assumptions cost it.

    Parameters
    ----------
    scenario
        Name of a preset (see `mjforage scenarios`) or path of a TOML file.
    """
    from mjforage.runs import variants

    _play("parts", scenario, (), lambda base, _: variants.parts(base), choice, by, again)


@study.command
def ablation(
    scenario: str = "published",
    /,
    *,
    policy: Policies = PAPER,
    choice: With = DEFAULT,
    by: By = THIS_PROCESS,
    again: GoingOn = SAME_ONLY,
    known: Trusted = NOBODY,
) -> None:
    """What an agent of each team is worth: marginal contributions (the paper's Tables 5 and 6).

    Parameters
    ----------
    scenario
        Name of a preset (see `mjforage scenarios`) or path of a TOML file.
    policy
        A policy (see `mjforage policies`), MODULE:CLASS of your own, or NAME for weights
        NAME.safetensors here; with options as in "greedy(distance=2)". Several may follow the flag.
    """
    from mjforage.runs import variants

    _play("ablation", scenario, policy, variants.ablation, choice, by, again)


@study.command
def corruption(
    scenario: str = "published",
    /,
    *,
    policy: Policies = PAPER,
    draws: Corrupted = USUAL,
    choice: With = DEFAULT,
    by: By = THIS_PROCESS,
    again: GoingOn = SAME_ONLY,
    known: Trusted = NOBODY,
) -> None:
    """How performance falls as a team's actions become random: sensitivity slopes (CSSC).

    Parameters
    ----------
    scenario
        Name of a preset (see `mjforage scenarios`) or path of a TOML file.
    policy
        A policy (see `mjforage policies`), MODULE:CLASS of your own, or NAME for weights
        NAME.safetensors here; with options as in "greedy(distance=2)". Several may follow the flag.
    """
    from mjforage.runs import variants

    def varied(base: "Scenario", players: Sequence[str]) -> "tuple[Variant, ...]":
        return variants.corruption(base, players, draws.step, draws.whole_team)

    _play("corruption", scenario, policy, varied, choice, by, again, **asdict(draws))


@study.command
def paper(
    scenario: str = "published",
    /,
    *,
    policy: Policies = PAPER,
    draws: Printed = AS_PRINTED,
    choice: With = DEFAULT,
    by: By = THIS_PROCESS,
    again: GoingOn = SAME_ONLY,
    known: Trusted = NOBODY,
) -> None:
    """All tables and figures of the paper, with its numbers beside ours.

    Parameters
    ----------
    scenario
        Name of a preset (see `mjforage scenarios`) or path of a TOML file.
    policy
        A policy (see `mjforage policies`), MODULE:CLASS of your own, or NAME for weights
        NAME.safetensors here; with options as in "greedy(distance=2)". Several may follow the flag.
    """
    from mjforage.runs import variants

    def varied(base: "Scenario", players: Sequence[str]) -> "tuple[Variant, ...]":
        return variants.paper(base, players, draws.step, draws.whole_team)

    _play("paper", scenario, policy, varied, choice, by, again, **asdict(draws))


@study.command
def communication(
    scenario: str = "comb-port",
    /,
    *,
    policy: Policies = INFORMED,
    choice: With = DEFAULT,
    by: By = THIS_PROCESS,
    again: GoingOn = SAME_ONLY,
    known: Trusted = NOBODY,
) -> None:
    """What range, quays, latency, losses and budgets of a link take, and what a relay is worth.

    Parameters
    ----------
    scenario
        Name of a preset (see `mjforage scenarios`) or path of a TOML file.
    policy
        A policy (see `mjforage policies`), MODULE:CLASS of your own, or NAME for weights
        NAME.safetensors here; with options as in "greedy(distance=2)". Several may follow the flag.
    """
    from mjforage.runs.communication import communication as varied

    _play("communication", scenario, policy, varied, choice, by, again)


@study.command
def sensing(
    scenario: str = "comb-port",
    /,
    *,
    policy: Policies = INFORMED,
    choice: With = DEFAULT,
    by: By = THIS_PROCESS,
    again: GoingOn = SAME_ONLY,
    known: Trusted = NOBODY,
) -> None:
    """What misses and false alarms take, and what wrong assumptions about them cost the planner.

    Parameters
    ----------
    scenario
        Name of a preset (see `mjforage scenarios`) or path of a TOML file.
    policy
        A policy (see `mjforage policies`), MODULE:CLASS of your own, or NAME for weights
        NAME.safetensors here; with options as in "greedy(distance=2)". Several may follow the flag.
    """
    from mjforage.runs.sensing import sensing as varied

    _play("sensing", scenario, policy, varied, choice, by, again)


def _play(
    kind: str,
    scenario: str,
    policies: Sequence[str],
    varied: "Callable[[Scenario, Sequence[str]], tuple[Variant, ...]]",
    choice: StudyOptions,
    by: Computing,
    again: Resuming,
    **options: object,
) -> None:
    """Compute a study and draw its report."""
    from mjforage.base.references import with_options
    from mjforage.mission.setup import Setup
    from mjforage.runs.identity import pinned
    from mjforage.runs.study import Study
    from mjforage.scenario.scenario_file import load_scenario

    by.workers  # noqa: B018  what is wrong with them is said first
    players, overrides = with_options("policy", policies, choice.set)
    setup = pinned(Setup.of(load_scenario(scenario, overrides, choice.map, choice.water)))
    variants = varied(setup.scenario, players)
    worlds, episodes, seed = tuple(choice.world), choice.episodes, choice.seed
    plan = Study(kind, setup, variants, worlds, episodes, seed, options, tuple(choice.metric))
    folder = choice.out or Path("runs") / f"{setup.scenario.name}-{kind}"

    words = f"{kind} study of {setup.scenario.name} on map {setup.grid.name}"
    carry_out(plan, folder, words, by, again)


def carry_out(plan: "Study", folder: Path, words: str, by: Computing, again: Resuming) -> None:
    """Compute a study and draw its report.

    Parameters
    ----------
    words : what it is, said before the first episode
    """
    from mjforage.runs.study import run_study
    from mjforage.view.report.studies import write_study_report

    workers = by.workers

    def begin() -> None:
        output.print(f"{words}: {len(plan.variants)} variants, {plan.episodes} episodes each")

    with bar(f"study {plan.kind}", "episodes") as shown:
        run_study(plan, folder, workers=workers, progress=shown, begin=begin, resume=again.resume)
    with working("drawing the report"):
        path = write_study_report(folder)
    output.print(f"report: {path}", soft_wrap=True)
