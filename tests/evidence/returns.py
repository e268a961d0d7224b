"""Numbers of the default reward: returns of policies, and what a model has learnt from it."""

import json
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.evidence.cells import average, mean
from tests.evidence.piece import Cell
from tests.evidence.playing import FIGURES, Runs
from tests.mjforage.learning.reward_table import correlation, ranks

MEASURES = {"return": "return", "pta_c": "PTA_C %", "nt90": "NT90 %"}


def rewards(runs: Runs) -> Iterator[list[Cell]]:
    """Of each scenario and world three rows: return, PTA_C and NT90 of each policy."""
    for world in runs.folders:
        for scenario, policies in figures(runs, world).items():
            found = {
                policy: {key: np.array(values) for key, values in one.items()}
                for policy, one in policies.items()
            }
            right = [good for *_, good in ranks(found)]
            first: list[Cell] = [f"`{scenario}`", world]
            last: list[Cell] = [f"{sum(right)} of {len(right)}", {"mean": correlation(found)}]
            for key, words in MEASURES.items():
                yield [*first, words, *(mean(one[key]) for one in found.values()), *last]
                first, last = ["", ""], ["", ""]


def learnt(runs: Runs) -> Iterator[list[Cell]]:
    """Of each seed of learning the PTA_C of the model and of `random`, and of all seeds."""
    seeds = figures(runs, "")
    for one in seeds:
        yield [f"{one['seed']}", *beside_random(one["model"], one["random"])]
    models: NDArray[np.float64] = np.mean([one["model"] for one in seeds], axis=0)
    yield ["mean", *beside_random(models, seeds[0]["random"])]


def beside_random(model: Any, random: Any) -> Iterator[Cell]:
    """Both, and how many times as much the model collects."""
    yield mean(model)
    yield mean(random)
    yield average([np.mean(model) / np.mean(random)])


def figures(runs: Runs, label: str) -> Any:
    """JSON of a command."""
    return json.loads((runs.folders[label] / FIGURES).read_text("utf-8"))
