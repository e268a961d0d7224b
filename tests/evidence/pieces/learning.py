"""docs/learning.md and docs/evidence/why-scores-fell.md."""

import io
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import polars as pl
from matplotlib.figure import Figure

from mjforage import metrics
from mjforage.metrics.statistics import NORMAL_95
from mjforage.view.page import style
from mjforage.view.page.picture import smaller
from tests.evidence.piece import REPOSITORY, Cell, Column, Piece, Row, average, beside
from tests.evidence.pieces import communication
from tests.evidence.pieces.policies import ELSEWHERE, LEARNED
from tests.evidence.pieces.trained import gathered, run_in, together
from tests.evidence.playing import Run, Runs, flags

PICTURE = "docs/evidence/family-seeds.png"
SEEDS = (1, 2, 3)
SCORES = {
    "pta_d": Column("PTA_D %", 2),
    "pta_c": Column("PTA_C %", 2),
    "nt50": Column("NT50", 3),
    "nt90": Column("NT90", 3),
}
_HIGHER = ("pta_d", "pta_c")  # is better
_HARBOURS = ("combs:900", "basins:901", "channels:902", "islands:903")
PLACES = {
    "`published`": ("published --episodes 400",),
    "four harbours": tuple(
        f"published --map harbour:{harbour} --episodes 100" for harbour in _HARBOURS
    ),
}
"""Where both weights of a training play: heads of rows, and the maps of each."""
_FAMILY = (
    "mjforage train ddqn --scenario published --updates 6000 --seed {seed} --teacher belief"
    " --also published:harbours:0-99 --also comb-port:harbours:channels:100-199"
    " --also comb-port:harbours:200-299"
    " --evaluate published --evaluate published:harbours:900-903"
    " --learning teacher_updates=20000 --learning warmup=8000 --learning capacity=150000"
    " --learning explore_from=0.05 --learning explore_to=0.02 --learning explore_updates=3000"
    " --learning num_envs=8 --learning updates_per_step=0.5 --learning gamma=0.95"
    " --learning target_rate=0.01 --learning priority=0 --learning margin_weight=30"
    " --learning learning_rate=5e-4 --learning rate_halves=1000"
    " --learning evaluate_every=500 --learning evaluate_episodes=400"
)

FAMILY = {f"seed {seed}": _FAMILY.format(seed=seed) for seed in SEEDS}

_LINKS = {
    "comb-port": (
        *("ideal", "32 nodes (128 m), quays block", "16 nodes, quays block", "8 nodes"),
        *("8 nodes, quays block", "latency 1 (disk without an end)", "loss 0.9", "none"),
    ),
    "open-bay": ("ideal", "16 nodes, quays block", "8 nodes"),
    "channels": ("ideal", "16 nodes, quays block", "8 nodes"),
}
TAUGHT = {
    f"`{scenario}`, {link}": communication.over(
        f"mjforage evaluate {scenario} --policy ddqn --policy ddqn-link --episodes 100 --seed 7",
        link,
    )
    for scenario, links in _LINKS.items()
    for link in links
}


def _taught(runs: Runs) -> Iterator[Row]:
    for label, run in runs.items():
        keys = ("pta_c", "nt90")
        other = [run.values("ddqn", key) for key in keys]
        own = [run.values("ddqn-link", key) for key in keys]
        yield [label, *map(average, other), *map(beside, own, other)]


def _evaluations(folder: Path) -> pl.DataFrame:
    return pl.read_parquet(folder / "evaluations.parquet").sort("updates")


def _seeds(runs: Runs) -> Iterator[Row]:
    """Of each seed the weights of its best evaluation, and what the last ones differ from them."""
    for label, folder in runs.folders.items():
        rows = _evaluations(folder)
        best, last = rows.sort("rank")["updates"][0], rows["updates"][-1]
        for place, maps in PLACES.items():
            played = [_fresh(folder, words) for words in maps]
            yield [f"{label}, {best:.0f} and {last:.0f} updates", place, *_compared(played)]


def _fresh(folder: Path, words: str) -> Run:
    """Episodes that chose neither of them, by the best weights of a training and by its last."""
    return run_in(folder, f"mjforage evaluate {words} --policy best --policy weights --seed 7")


def _elsewhere(runs: Runs) -> Iterator[Row]:
    """Of each map the mean of the seeds' last weights, episode by episode, beside `ddqn`."""
    home = next(iter(runs.folders.values())).with_name("family-elsewhere")
    seeds = gathered(runs.folders.values(), home)
    policies = flags(["ddqn", *seeds])
    own = {"`published`": ("mjforage evaluate published", 200)}
    others = {place: (played, 100) for place, played in ELSEWHERE.items()}
    for place, (played, episodes) in (own | others).items():
        run = run_in(home, f"{played} {policies} --episodes {episodes} --seed 7")
        cells = []
        for key in LEARNED:
            cells.append(beside(together(run, seeds, key), run.values("ddqn", key)))
        yield [place, *cells]


def _compared(maps: Sequence[Run]) -> Iterator[Cell]:
    """Best with paired differences, ± 1.96 SEM of strata, and the largest loss in SEM of best."""
    losses = {}
    for key, column in SCORES.items():
        best, last = ([run.values(name, key) for run in maps] for name in ("best", "weights"))
        differences = [after - before for after, before in zip(last, best, strict=True)]
        change = float(metrics.mean(np.concatenate(differences)))
        yield {
            "mean": float(metrics.mean(np.concatenate(best))),
            "gap": change,
            "half": NORMAL_95 * float(metrics.stratified_sem(differences)),
        }
        loss = -change if key in _HIGHER else change
        losses[column.head.removesuffix(" %")] = loss / float(metrics.stratified_sem(best))
    most = max(losses, key=lambda head: losses[head])
    yield f"{losses[most]:.2f} ({most})" if losses[most] > 0 else "none"


def _curves(runs: Runs) -> None:
    """Draw the evaluations over the updates, a standard error to each side."""
    looks = style.looks(list(runs.folders))
    figure = Figure(figsize=(9.0, 2.6), layout="constrained")
    for axes, (key, column) in zip(figure.subplots(1, len(SCORES)), SCORES.items(), strict=True):
        for label, folder in runs.folders.items():
            rows, look = _evaluations(folder), looks[label]
            at, value, error = (rows[name].to_numpy() for name in ("updates", key, f"{key}_sem"))
            axes.fill_between(at, value - error, value + error, color=look.colour, alpha=0.15, lw=0)
            axes.plot(at, value, look.marker, ls="-", color=look.colour, ms=3.5, label=label)
        axes.set_title(column.head, loc="left", fontsize=10, color=style.INK)
        axes.set_xlabel("updates", fontsize=8, color=style.INK)
        axes.spines[["top", "right"]].set_visible(False)
        axes.tick_params(colors=style.INK, labelsize=8)
    axes.legend(frameon=False, fontsize=8, labelcolor=style.INK)
    buffer = io.BytesIO()
    figure.savefig(buffer, dpi=100)
    (REPOSITORY / PICTURE).write_bytes(smaller(buffer.getvalue()))


PIECES = (
    Piece(
        "taught-links",
        TAUGHT,
        (
            *(Column("map, link"), Column("`ddqn`: PTA_C %", 2), Column("NT90", 3)),
            *(Column("`ddqn-link`: PTA_C %", 2), Column("NT90", 3)),
        ),
        _taught,
    ),
    Piece(
        "family-seeds",
        FAMILY,
        (
            *(Column("run: best and last weights"), Column("played on")),
            *SCORES.values(),
            Column("largest loss [SEM]"),
        ),
        _seeds,
        files=(PICTURE,),
        write=_curves,
        minutes=90,
    ),
    Piece(
        "family-elsewhere",
        FAMILY,
        (Column("map"), *LEARNED.values()),
        _elsewhere,
        minutes=20,
        shown=False,
    ),
)
