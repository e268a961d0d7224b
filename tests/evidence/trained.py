"""Numbers of trainings: their weights as policies of runs, and their evaluations."""

import io
import shutil
from collections.abc import Iterable, Iterator, Sequence
from contextlib import chdir
from pathlib import Path

import numpy as np
import polars as pl
from matplotlib.figure import Figure
from numpy.typing import NDArray

from mjforage import metrics
from mjforage.metrics.statistics import NORMAL_95
from mjforage.view.page import style
from mjforage.view.page.figure import smaller
from tests.evidence.cells import beside, gap
from tests.evidence.piece import REPOSITORY, Cell, load
from tests.evidence.playing import Run, Runs, play

SCORES = {"pta_d": "PTA_D %", "pta_c": "PTA_C %", "nt50": "NT50", "nt90": "NT90"}
HIGHER = ("pta_d", "pta_c")  # is better
LEARNED = (*SCORES, "csr", "rmse_columns")
HARBOURS = ("combs:900", "basins:901", "channels:902", "islands:903")
CURVES = "docs/evidence/family-seeds.png"


def run_in(folder: Path, command: str) -> Run:
    """A run where the weights that are in a folder are policies by the names of their files."""
    with chdir(folder):
        return Run(play(f"mjforage evaluate {command}", runs=folder / "fresh"))


def gathered(folders: Iterable[Path], home: Path) -> list[str]:
    """Copy the last weights of trainings into one folder; the names that they have as policies."""
    home.mkdir(exist_ok=True)
    names = []
    for folder in folders:
        names.append(f"{folder.name}-last")
        shutil.copy(folder / "weights.safetensors", home / f"{names[-1]}.safetensors")
    return names


def together(run: Run, policies: Sequence[str], key: str) -> NDArray[np.float64]:
    """Mean of a metric over policies, episode by episode: (episode,)."""
    values: NDArray[np.float64] = np.mean([run.values(name, key) for name in policies], axis=0)
    return values


def flags(policies: Iterable[str]) -> str:
    """Policies as a command names them."""
    return " ".join(f"--policy {name}" for name in policies)


def seeds(runs: Runs) -> Iterator[list[Cell]]:
    """Of each seed the weights of its best evaluation, and what the last ones differ from them,
    in episodes that chose neither.
    """
    places = {
        "`published`": ["published --episodes 400"],
        "four harbours": [f"published --map harbour:{one} --episodes 100" for one in HARBOURS],
    }
    for label, folder in runs.folders.items():
        rows = evaluations(folder)
        best, last = rows.sort("rank")["updates"][0], rows["updates"][-1]
        for place, maps in places.items():
            chosen = "--policy best --policy weights --seed 7"
            played = [run_in(folder, f"{words} {chosen}") for words in maps]
            yield [f"{label}, {best:.0f} and {last:.0f} updates", place, *compared(played)]


def compared(maps: Sequence[Run]) -> Iterator[Cell]:
    """Best with paired differences, ± 1.96 SEM of strata, and the largest loss in SEM of best."""
    losses = {}
    for key, head in SCORES.items():
        best, last = ([run.values(name, key) for run in maps] for name in ("best", "weights"))
        differences = [after - before for after, before in zip(last, best, strict=True)]
        change = float(metrics.mean(np.concatenate(differences)))
        yield {
            "mean": float(metrics.mean(np.concatenate(best))),
            "gap": change,
            "half": NORMAL_95 * float(metrics.stratified_sem(differences)),
        }
        loss = -change if key in HIGHER else change
        losses[head.removesuffix(" %")] = loss / float(metrics.stratified_sem(best))
    most = max(losses, key=lambda head: losses[head])
    yield f"{losses[most]:.2f} ({most})" if losses[most] > 0 else "none"


def elsewhere(runs: Runs) -> Iterator[list[Cell]]:
    """Of each map the mean of the seeds' last weights, episode by episode, beside `ddqn`."""
    home = next(iter(runs.folders.values())).with_name("family-elsewhere")
    names = gathered(runs.folders.values(), home)
    others = load("weights-harbours").runs.items()  # maps that nothing was trained on
    played = {place: run["command"].split(" --policy")[0] for place, run in others}
    places = {"`published`": "mjforage evaluate published"} | played
    for place, words in places.items():
        episodes = 200 if place == "`published`" else 100
        words = words.removeprefix("mjforage evaluate ")
        run = run_in(home, f"{words} {flags(['ddqn', *names])} --episodes {episodes} --seed 7")
        pairs = [(together(run, names, key), run.values("ddqn", key)) for key in LEARNED]
        yield [place, *(beside(*pair) for pair in pairs)]


def tuned(runs: Runs) -> Iterator[list[Cell]]:
    """Of each world of training the mean of its seeds' last weights, episode by episode."""
    home = next(iter(runs.folders.values())).with_name("tuned-in-physics")
    last = {
        world: gathered((f for label, f in runs.folders.items() if label.startswith(world)), home)
        for world in ("graph", "physics")
    }
    policies = flags(["ddqn", *last["graph"], *last["physics"]])
    for place, world in (("MuJoCo", "physics"), ("graph", "graph")):
        run = run_in(home, f"comb-port-weather --world {world} {policies} --episodes 100 --seed 7")
        after = {
            trained: {key: together(run, names, key) for key in LEARNED}
            for trained, names in last.items()
        }
        for trained, words in (("graph", "in the graph world"), ("physics", "in MuJoCo")):
            head = f"`comb-port-weather`, {place}" if trained == "graph" else ""
            cells = [beside(after[trained][k], run.values("ddqn", k)) for k in LEARNED]
            yield [head, words, *cells]
        gaps = [gap(after["physics"][key], after["graph"][key]) for key in LEARNED]
        yield ["", "MuJoCo − graph", *gaps]


def evaluations(folder: Path) -> pl.DataFrame:
    """Evaluations of a training, in order."""
    return pl.read_parquet(folder / "evaluations.parquet").sort("updates")


def curves(runs: Runs) -> None:
    """Draw the evaluations over the updates, a standard error to each side."""
    looks = style.policy_styles(list(runs.folders))
    figure = Figure(figsize=(9.0, 2.6), layout="constrained")
    for axes, (key, head) in zip(figure.subplots(1, len(SCORES)), SCORES.items(), strict=True):
        for label, folder in runs.folders.items():
            rows, look = evaluations(folder), looks[label]
            at, value, error = (rows[name].to_numpy() for name in ("updates", key, f"{key}_sem"))
            axes.fill_between(at, value - error, value + error, color=look.colour, alpha=0.15, lw=0)
            axes.plot(at, value, look.marker, ls="-", color=look.colour, ms=3.5, label=label)
        axes.set_title(head, loc="left", fontsize=10, color=style.INK)
        axes.set_xlabel("updates", fontsize=8, color=style.INK)
        axes.spines[["top", "right"]].set_visible(False)
        axes.tick_params(colors=style.INK, labelsize=8)
    axes.legend(frameon=False, fontsize=8, labelcolor=style.INK)
    buffer = io.BytesIO()
    figure.savefig(buffer, dpi=100)
    (REPOSITORY / CURVES).write_bytes(smaller(buffer.getvalue()))
