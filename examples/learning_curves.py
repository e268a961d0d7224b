"""Draw the evaluations of training runs beside Greedy and the paper's learned policy.

    python examples/learning_curves.py curves.png runs/ddqn/evaluations.parquet \
        models/weights/ddqn-evaluations.csv

takes any number of runs; lower is better in all three columns.
"""

import sys
from pathlib import Path

import polars as pl
from matplotlib.figure import Figure

from mjforage.view.page import style

COLUMNS = {"nt50": "NT50", "nt90": "NT90", "left": "items left [%]"}
LEVELS = {  # by the published rules: ours of Greedy (200 episodes), and the paper's row
    "Greedy": {"nt50": 0.331, "nt90": 0.604, "left": 3.0},
    "paper's DRL": {"nt50": 0.281, "nt90": 0.512, "left": 1.32},
}


def name_of(path: Path) -> str:
    """Label of a run: the name of its file, or of its folder where all files have one name."""
    label = path.stem.removesuffix("-evaluations")
    return path.parent.name if label == "evaluations" else label


def read(path: Path) -> pl.DataFrame:
    """Evaluations of a run, with the share of items left."""
    rows = pl.read_csv(path) if path.suffix == ".csv" else pl.read_parquet(path)
    return rows.with_columns(left=100.0 - pl.col("pta_c"))


def main(picture: Path, runs: list[Path]) -> None:
    """Draw."""
    looks = style.policy_styles([name_of(path) for path in runs])
    figure = Figure(figsize=(9.0, 2.8), layout="constrained")
    for axes, (column, name) in zip(figure.subplots(1, 3), COLUMNS.items(), strict=True):
        for (level, values), dash in zip(LEVELS.items(), (":", "--"), strict=True):
            axes.axhline(
                values[column], color=style.INK, linestyle=dash, linewidth=1.0, label=level
            )
        for path in runs:
            rows, label = read(path), name_of(path)
            marker, colour = looks[label].marker, looks[label].colour
            axes.plot(
                rows["updates"], rows[column], marker, ls="-", color=colour, ms=4, label=label
            )
        axes.set_xlabel("updates")
        axes.set_title(name, loc="left", fontsize=10, color=style.INK)
        axes.set_ylim(bottom=0.0)
        axes.spines[["top", "right"]].set_visible(False)
        axes.tick_params(colors=style.INK, labelsize=8)
    axes.legend(frameon=False, fontsize=8, labelcolor=style.INK)
    figure.savefig(picture, dpi=100)


if __name__ == "__main__":
    main(Path(sys.argv[1]), [Path(name) for name in sys.argv[2:]])
