"""docs/evidence/why-scores-fell.md."""

from collections.abc import Iterator
from typing import Any

import polars as pl
from matplotlib.figure import Figure

from mjforage.view.page import style
from tests.evidence.piece import REPOSITORY, Cell, Column, Piece, Row
from tests.evidence.playing import Runs

PICTURE = "docs/evidence/family-seeds.png"
SEEDS = (1, 2, 3)
SCORES = {
    "pta_d": Column("PTA_D %", 2),
    "pta_c": Column("PTA_C %", 2),
    "nt50": Column("NT50", 3),
    "nt90": Column("NT90", 3),
}
_BETTER = {"pta_d": 1.0, "pta_c": 1.0, "nt50": -1.0, "nt90": -1.0}  # sign of an improvement
_FAMILY = (
    "mjforage train ddqn --scenario published --updates 5000 --seed {seed} --teacher belief"
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


def _evaluations(runs: Runs, label: str) -> pl.DataFrame:
    return pl.read_parquet(runs.folders[label] / "evaluations.parquet").sort("updates")


def _seeds(runs: Runs) -> Iterator[Row]:
    """Of each seed the best evaluation, the last, and how many SEM of the best lie between."""
    for label in runs.folders:
        rows = _evaluations(runs, label)
        best, last = (
            rows.row(int(rows["rank"].arg_min() or 0), named=True),
            rows.row(-1, named=True),
        )
        yield [label, "best", *_evaluation(best), None]
        behind = {
            column.head: sign * (best[key] - last[key]) / best[f"{key}_sem"]
            for (key, sign), column in zip(_BETTER.items(), SCORES.values(), strict=True)
        }
        most = max(behind, key=lambda head: behind[head])
        yield ["", "last", *_evaluation(last), f"{behind[most]:.2f} ({most.removesuffix(' %')})"]


def _evaluation(row: dict[str, Any]) -> list[Cell]:
    scores: list[Cell] = [{"mean": row[key], "half": 1.96 * row[f"{key}_sem"]} for key in SCORES]
    return [{"mean": row["updates"]}, *scores]


def _curves(runs: Runs) -> None:
    """Draw the evaluations over the updates, a standard error to each side."""
    looks = style.looks(list(runs.folders))
    figure = Figure(figsize=(9.0, 2.6), layout="constrained")
    for axes, (key, column) in zip(figure.subplots(1, 4), SCORES.items(), strict=True):
        for label in runs.folders:
            rows = _evaluations(runs, label)
            at, value, error = (rows[name].to_numpy() for name in ("updates", key, f"{key}_sem"))
            look = looks[label]
            axes.fill_between(at, value - error, value + error, color=look.colour, alpha=0.15, lw=0)
            axes.plot(at, value, look.marker, ls="-", color=look.colour, ms=3.5, label=label)
        axes.set_title(column.head, loc="left", fontsize=10, color=style.INK)
        axes.set_xlabel("updates", fontsize=8, color=style.INK)
        axes.spines[["top", "right"]].set_visible(False)
        axes.tick_params(colors=style.INK, labelsize=8)
    axes.legend(frameon=False, fontsize=8, labelcolor=style.INK)
    figure.savefig(REPOSITORY / PICTURE, dpi=100)


PIECES = (
    Piece(
        "family-seeds",
        {f"seed {seed}": _FAMILY.format(seed=seed) for seed in SEEDS},
        (
            *(Column("run"), Column("weights"), Column("updates"), *SCORES.values()),
            Column("last behind best, at most [SEM]"),
        ),
        _seeds,
        files=(PICTURE,),
        write=_curves,
        minutes=150,
    ),
)
