"""`mjforage study board`: every policy on the same episodes of several courses, in one table."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from mjforage.cli.computing import THIS_PROCESS, By
from mjforage.cli.console import FOLDER, output, working
from mjforage.cli.resume_flags import SAME_ONLY, GoingOn
from mjforage.cli.studying import Names, Policies, carry_out, study
from mjforage.cli.trust_flags import NOBODY, Trusted

if TYPE_CHECKING:
    from mjforage.runs.study import Study


@dataclass(frozen=True)
class BoardOptions:
    """What the board is told.

    Parameters
    ----------
    map
        A course more: the rules of comb-port on this map, a name, grid or image; with a world as in
        harbour.csv@physics. Starts are those beside it, or drawn by chance; repeatable.
    episodes
        Episodes per course and policy; what --out holds goes on to more.
    seed
        Seed of the study; episode i of a course is the same for every policy.
    set
        Override KEY=VALUE in every course, in TOML syntax, or policy.greedy.distance=2 for an
        option of a policy; repeatable.
    metric
        A metric to take beside ours: MODULE:CLASS of your own, or one of a package; repeatable.
    out
        Study folder. An unfinished study of the same settings is resumed.
    """

    map: Names = ()
    episodes: int = 100
    seed: int = 0
    set: Names = ()
    metric: Names = ()
    out: Annotated[Path, FOLDER] = Path("runs/board")


DEFAULT = BoardOptions()
With = Annotated[BoardOptions, Parameter(name="*")]


@study.command
def board(
    *courses: str,
    policy: Policies = (),
    choice: With = DEFAULT,
    by: By = THIS_PROCESS,
    again: GoingOn = SAME_ONLY,
    known: Trusted = NOBODY,
) -> None:
    """Every policy on the same episodes of several courses: scores, costs, and who is best where.

    Parameters
    ----------
    courses
        SCENARIO or SCENARIO@WORLD: a preset (see `mjforage scenarios`) or a TOML file, in the graph
        world unless another is named. Default: comb-port published open-bay channels
        comb-port-weather comb-port-radio comb-port@physics comb-port-weather@physics.
    policy
        A policy (see `mjforage policies`), MODULE:CLASS of your own, or NAME for weights
        NAME.safetensors here; with options as in "greedy(distance=2)". Several may follow the flag;
        one that cannot play a course is refused. Default: all that have a name; who cannot play a
        course is left out of it, and the page says why.
    """
    from mjforage.base.references import with_options
    from mjforage.runs.board import board as planned
    from mjforage.runs.courses import courses_of

    by.workers  # noqa: B018  what is wrong with them is said first
    players, overrides = with_options("policy", policy, choice.set)
    with working("checking who can play"):
        plan = planned(
            courses_of(courses, choice.map, overrides),
            players,
            episodes=choice.episodes,
            seed=choice.seed,
            metrics=choice.metric,
        )
    carry_out(plan, choice.out, _words(plan), by, again)


def _words(plan: "Study") -> str:
    """What the board is, and who is left out of it, a line for each reason."""
    names = dict.fromkeys(name for one in plan.variants for name in one.policies)
    reasons = dict.fromkeys((one.policy, one.reason) for one in plan.left_out)
    for name, reason in reasons:
        where = [one.variant for one in plan.left_out if (one.policy, one.reason) == (name, reason)]
        output.print(f"left out of {', '.join(where)}: {reason}", soft_wrap=True)
    return f"board of {len(names)} policies"
