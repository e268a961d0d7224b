"""The command that trains policies."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from mjforage.base.errors import UserError
from mjforage.cli.console import FOLDER, app, errors, output
from mjforage.cli.flags import NOBODY, SAME_ONLY, GoingOn, Trusted, Water
from mjforage.cli.progress import bar

if TYPE_CHECKING:
    from mjforage.learning.training.progress import Row

Pairs = Annotated[tuple[str, ...], Parameter(negative="")]


@app.command
def train(
    algorithm: str,
    /,
    *,
    scenario: str = "published",
    world: str | None = None,
    initial: Annotated[str, Parameter(name="--from")] = "",
    hours: float | None = None,
    updates: int | None = None,
    seed: int = 0,
    map: str | None = None,
    water: Water | None = None,
    set: Pairs = (),
    also: Pairs = (),
    evaluate: Pairs = (),
    learning: Pairs = (),
    teacher: str = "",
    device: str = "auto",
    again: GoingOn = SAME_ONLY,
    known: Trusted = NOBODY,
    out: Annotated[Path | None, FOLDER] = None,
) -> None:
    """Train a policy; the same command resumes a run that was stopped.

    Parameters
    ----------
    algorithm
        ddqn (Double DQN), mappo (multi-agent PPO), a name that an installed package brings, or
        MODULE:CLASS of your own; pip install 'mjforage[learn]' brings what training needs.
    scenario
        Name of a preset (see `mjforage scenarios`) or path of a TOML file.
    world
        World of episodes and evaluations: graph (the default) or physics, or a world between.
    initial
        Policy, such as ddqn, or FILE.safetensors whose weights the networks begin with; they are
        evaluated first. Give also how much to explore, such as --learning explore_from=0.1.
    hours
        Stop after the round of episodes in which the run has lasted so long, evaluations included.
    updates
        Stop after the round of episodes in which each network has been updated so often.
    seed
        Seed of the run.
    map
        Map that replaces the scenario's grid: a name, harbour:KIND:SEED[:ROWSxCOLUMNS], table,
        grid or image.
    water
        Cells of that file that are water, light or dark: pixels of an image, 1 or 0 of a table.
    set
        Override KEY=VALUE of the scenario, not of those of --also and --evaluate; repeatable.
    also
        Train on this SCENARIO, or SCENARIO:MAP, in turn; repeatable. A map has its own starts.
        SCENARIO:harbours:0-39 takes the next of these generated harbours whenever its turn comes.
    evaluate
        Evaluate on this SCENARIO, SCENARIO:MAP or SCENARIO:harbours:900-909 instead of the first
        scenario; repeatable: all maps share the episodes of an evaluation.
    learning
        Override KEY=VALUE of the learning hyperparameters, such as num_envs=32, reward.removed=2,
        reward.MODULE:CLASS=1 or observation=MODULE:CLASS of your own; repeatable.
    teacher
        Policy that shows moves at first, as --policy of evaluate; give also --learning
        teacher_updates=N. For ddqn, mappo, and algorithms of yours that ask it.
    device
        auto, cpu or cuda; a run stays on the kind of device where it began.
    out
        Folder of the run; default runs/ALGORITHM-SCENARIO.
    """
    from mjforage.api.training import train as play
    from mjforage.base.extras import require
    from mjforage.base.references import with_options
    from mjforage.physics.vessel_moves import open_setup
    from mjforage.scenario.scenario_file import load_scenario

    require(f"train {algorithm}", "torch", "tensorboard")
    teachers, set = with_options("policy", [teacher] if teacher else [], set)
    chosen = load_scenario(scenario, set, map, water)
    changes = dict(_pair(text) for text in learning)
    told = {"teacher": "".join(teachers), "initial": initial, "world": world}
    changes |= {name: value for name, value in told.items() if value}
    folder = out or Path("runs") / f"{algorithm.rpartition(':')[2]}-{chosen.name}"
    unit = "updates" if updates is not None else "minutes"
    with bar("train", unit) as shown:
        play(
            algorithm,
            open_setup(chosen),
            folder=folder,
            updates=updates,
            hours=hours,
            seed=seed,
            settings=changes,
            also=also,
            evaluate=evaluate,
            device=device,
            resume=again.resume,
            progress=shown,
            report=_report,
        )
    output.print(f"run: {folder}", soft_wrap=True)


def _pair(text: str) -> tuple[str, Any]:
    """KEY=VALUE as TOML has it; a bare word is text."""
    from mjforage.base.references import assigned

    key, separator, value = _parted(text)
    if not separator or not key.strip():
        raise UserError(f"--learning {text}: expected KEY=VALUE, for example num_envs=32")
    return key.strip(), assigned(value)["value"]


def _parted(text: str) -> tuple[str, str, str]:
    """Key, sign and value; a sign in parentheses is of an option, as in reward.MINE(a=2)=1."""
    depth = 0
    for place, sign in enumerate(text):
        depth += (sign == "(") - (sign == ")")
        if sign == "=" and depth == 0:
            return text[:place], "=", text[place + 1 :]
    return text, "", ""


def _report(table: str, row: "Row") -> None:
    from mjforage.learning.training.run import CHECKPOINT, FINISHED

    if table == "evaluations":
        output.print(
            f"{row['updates']:>8.0f} updates {row['seconds'] / 60:6.1f} min: "
            f"PTA_D {row['pta_d']:.2f} %, PTA_C {row['pta_c']:.2f} %, "
            f"NT50 {row['nt50']:.3f}, NT90 {row['nt90']:.3f}, "
            f"RMSE columns {row['rmse_columns']:.4f}, CSR {row['csr']:.3f}"
        )
    elif table == CHECKPOINT:
        errors.print(
            f"train: goes on after {row['updates']:.0f} updates, {row['seconds'] / 60:.1f} min"
        )
    elif table == FINISHED:
        errors.print(
            f"train: was finished, after {row['updates']:.0f} updates, {row['seconds'] / 60:.1f} "
            "min; give more --updates or --hours to go on, --fresh to begin anew"
        )
    elif errors.is_interactive:
        errors.print(
            f"round {row['rounds']:.0f}: {row['updates']:.0f} updates, PTA_C {row['pta_c']:.1f} %, "
            f"loss {row['loss']:.4f}"
        )
