"""How often intervals of means cover: `python -m tests.evidence.coverage --json FILE`.

Of a pool of episodes of `published`, samples are drawn without replacement, and the interval of
each is held against the mean over other episodes, of other seeds. Graph level, of one process.
"""

import argparse
import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
from numpy.typing import NDArray

import mjforage as mf
from mjforage.metrics import mean_interval
from mjforage.mission.scoring import Description, chosen_metrics, description
from mjforage.view.report.cells import ROUGH

SIZES = (20, 50, 100)
SAMPLES = 2000
Runs = tuple[tuple[int, int], ...]
"""Seed and number of episodes."""
SEEDS: dict[str, tuple[Runs, Runs]] = {
    "greedy": (((1, 4000), (2, 4000), (3, 4000)), ((4, 4000), (5, 4000), (6, 4000))),
    "levy": (((1, 4000), (2, 4000), (3, 4000)), ((4, 4000), (5, 4000), (6, 4000))),
    "belief": (((1, 4000),), ((2, 2000), (3, 2000), (4, 2000), (5, 2000))),
}
"""Policy -> runs of the truth, and of the pool."""
HORIZON = 150

Columns = dict[str, NDArray[np.float64]]
"""Metric -> (episode,)."""


def episodes(policy: str, seed: int, count: int) -> pl.DataFrame:
    """Metrics of a policy's episodes of `published`."""
    return mf.evaluate("published", policy, episodes=count, seed=seed, record=()).episodes


def columns(policy: str, runs: Runs) -> Columns:
    """Metrics of the episodes of several runs, one after another."""
    table = pl.concat(episodes(policy, seed, count).sort("episode") for seed, count in runs)
    keys = [one.key for one in chosen_metrics()]
    return {key: table[key].cast(pl.Float64).fill_null(np.nan).to_numpy() for key in keys}


def covered(
    truth: NDArray[np.float64], pool: NDArray[np.float64], metric: Description, samples: int
) -> Iterator[float]:
    """Share of samples of each size whose interval holds the mean of the truth."""
    for size in SIZES:
        random = np.random.default_rng(size)
        drawn = [random.choice(pool.size, size, replace=False) for _ in range(samples)]
        found = mean_interval(pool[np.array(drawn)], *metric.ends(HORIZON))
        mean = np.nanmean(truth)
        yield float(np.mean((found.low <= mean) & (mean <= found.high)))


def table(runs: Mapping[str, tuple[Runs, Runs]], samples: int = SAMPLES) -> list[list[Any]]:
    """Metric by metric the shares of every policy and size, None where it is constant."""
    sides = {}
    for policy, (those, others) in runs.items():
        sides[policy] = columns(policy, those), columns(policy, others)
    rows = []
    for metric in map(description, chosen_metrics()):
        shares: list[float | None] = []
        for truth, pool in ((one[metric.key], other[metric.key]) for one, other in sides.values()):
            constant = not np.isfinite(truth).any() or np.nanmax(truth) == np.nanmin(truth)
            shares += [None] * 3 if constant else list(covered(truth, pool, metric, samples))
        name = metric.plain if metric.bounded else f"{metric.plain} ({ROUGH})"
        if any(share is not None for share in shares):
            rows.append([name, *shares])
    return rows


def main(words: Sequence[str] | None = None) -> None:
    """Write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, required=True)
    path = parser.parse_args(words).json
    path.write_text(json.dumps(table(SEEDS)), "utf-8")


if __name__ == "__main__":
    main()
