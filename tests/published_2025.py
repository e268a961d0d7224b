"""Columns of the baselines of the paper of 2025: `python -m tests.published_2025 --map FILE ...`.

Prints mean and 1.96 standard errors of every column of every baseline on each map. A map brings its
own starts (`NAME.starts.csv` beside it); without `--map` it is the scenario's comb port. With
`--figures FILE`, a CSV of map, policy, column, mean and sem of another program, the difference in
standard errors z stands beside each, and the last line says how many are below 2 and 3.
"""

import argparse
import csv
import sys
from pathlib import Path

import numpy as np

import mjforage as mf

POLICIES = ("greedy-2025", "pso-2025", "lawnmower-2025", "walk-2025")
COLUMNS = [f"{kind}_{share}" for kind in ("mse", "ptc") for share in (33, 66, 100)]
Figures = dict[tuple[str, str, str], tuple[float, float]]


def figures_of(path: Path | None) -> Figures:
    """(map, policy, column) -> mean and standard error of the mean."""
    if path is None:
        return {}
    with path.open(encoding="utf-8", newline="") as file:
        return {
            (row["map"], row["policy"], row["column"]): (float(row["mean"]), float(row["sem"]))
            for row in csv.DictReader(file)
        }


def played(map_file: str | None, episodes: int, seed: int, jobs: int) -> Figures:
    """Columns of all baselines on one map."""
    scenario = mf.load_scenario("published-2025", **({"map": map_file} if map_file else {}))
    run = mf.evaluate(
        scenario,
        list(POLICIES),
        episodes=episodes,
        seed=seed,
        jobs=jobs,
        metrics=COLUMNS,
        record=(),
        progress=False,
    )
    found = run.episodes
    name, out = Path(map_file or scenario.map.name).stem, {}
    for policy in POLICIES:
        mine = found.filter(found["policy"] == policy)
        for column in COLUMNS:
            values = mine[column].to_numpy()
            sem = float(values.std(ddof=1) / np.sqrt(values.size))
            out[name, policy, column] = float(values.mean()), sem
    return out


def shown(ours: Figures, theirs: Figures) -> list[float]:
    """Print a line for each number; returns z of those that the other program has."""
    scores = []
    for place, (mean, sem) in ours.items():
        line = f"{place[0]:16} {place[1]:15} {place[2]:8} {mean:9.5f} +- {1.96 * sem:.5f}"
        if place in theirs:
            other, its_sem = theirs[place]
            scores.append((mean - other) / max(np.hypot(sem, its_sem), 1e-12))
            line += f"   {other:9.5f} +- {1.96 * its_sem:.5f}   z {scores[-1]:+.2f}"
        sys.stdout.write(line + "\n")
    return scores


def verdict(ours: Figures, theirs: Figures, scores: list[float]) -> tuple[str, bool]:
    """What the comparison counts to, and whether it holds: all |z| < 3, < 2 in nine of ten."""
    unplayed = sorted({place[0] for place in theirs} - {place[0] for place in ours})
    sizes, words = np.abs(scores), f"; no such map was played: {', '.join(unplayed)}"
    counts = f"|z| < 3 in {(sizes < 3).sum()}, < 2 in {(sizes < 2).sum()} of {sizes.size}"
    close = bool(sizes.size and (sizes < 3).all() and (sizes < 2).mean() >= 0.9)
    return counts + (words if unplayed else ""), close and not unplayed


def main() -> None:
    """Play and print; exit code 1 if the figures differ."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--map", nargs="*", default=[None], help="files of maps")
    parser.add_argument("--episodes", type=int, default=3000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--figures", type=Path, help="CSV: map,policy,column,mean,sem")
    given = parser.parse_args()
    theirs, scores = figures_of(given.figures), []
    ours: Figures = {}
    for map_file in given.map:
        found = played(map_file, given.episodes, given.seed, given.jobs)
        scores += shown(found, theirs)
        ours |= found
    if theirs:
        words, holds = verdict(ours, theirs, scores)
        sys.stdout.write(words + "\n")
        sys.exit(not holds)


if __name__ == "__main__":
    main()
