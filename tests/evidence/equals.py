"""How often equal policies are all bold: `python -m tests.evidence.equals --json FILE`.

Levy walks with thirteen streams of random numbers, on the same episodes of `published`.
"""

import argparse
import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import polars as pl
from numpy.typing import NDArray

import mjforage as mf
from mjforage.graph_planner.policies.walks import LevyPolicy
from mjforage.mission.scoring import describe
from mjforage.mission.task import Observation
from mjforage.view.report.best_marks import best_and_alike

POLICIES, TABLES, EPISODES = 13, 200, 50
KEYS = ("pta_c", "rmse", "nt90", "csr")


def stream(number: int) -> type[LevyPolicy]:
    """Levy walks that draw from a stream of their own."""

    class Own(LevyPolicy):
        def act(self, observation: Observation) -> NDArray[np.float64]:
            keys = observation.keys + np.uint64(number * 0x9E3779B9)
            return super().act(observation._replace(keys=keys))

    return Own


def episodes(number: int, count: int) -> pl.DataFrame:
    """Metrics of the episodes of a stream."""
    run = mf.evaluate("published", {f"levy-{number}": stream(number)}, episodes=count, record=())
    return run.episodes


def shares(
    policies: int = POLICIES, tables: int = TABLES, size: int = EPISODES
) -> dict[str, float]:
    """Metric -> share of the tables in which all are bold."""
    found = [episodes(number, tables * size).sort("episode") for number in range(policies)]
    result = {}
    for key in KEYS:
        values = np.array([one[key].cast(pl.Float64).fill_null(np.nan) for one in found])
        parts = values.reshape(policies, tables, size).swapaxes(0, 1)
        better = describe(key).better
        whole = [len(best_and_alike(dict(enumerate(one)), better)) == policies for one in parts]
        result[key] = float(np.mean(whole))
    return result


def main(words: Sequence[str] | None = None) -> None:
    """Write the shares."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, required=True)
    path = parser.parse_args(words).json
    path.write_text(json.dumps([[describe(k).plain, v] for k, v in shares().items()]), "utf-8")


if __name__ == "__main__":
    main()
