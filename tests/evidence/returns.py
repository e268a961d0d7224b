"""Numbers of the default reward: returns of policies, and what a model has learnt from it."""

import json
from collections.abc import Iterator
from typing import Any

import numpy as np

from tests.evidence.cells import average, beside, mean
from tests.evidence.piece import Cell
from tests.evidence.playing import FIGURES, Runs
from tests.mjforage.learning.reward_table import Values, correlation, ranks

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
    """PTA_C of the model and of `random`, and how many times as much the model collects."""
    for seed, model, random in of_seeds(runs):
        yield [seed, mean(model), mean(random), average([np.mean(model) / np.mean(random)])]


def learnt_on_hulls(runs: Runs) -> Iterator[list[Cell]]:
    """PTA_C of the model, what it is above that of `random`, and that."""
    for seed, model, random in of_seeds(runs):
        yield [seed, beside(model, random), mean(random)]


def of_seeds(runs: Runs) -> Iterator[tuple[str, Values, Values]]:
    """PTA_C of the model and of `random` for each seed of learning, then of the mean over seeds."""
    seeds = figures(runs, "")
    models = np.array([one["model"] for one in seeds])
    random = np.array(seeds[0]["random"])  # the same for all
    yield from ((f"{one['seed']}", model, random) for one, model in zip(seeds, models, strict=True))
    yield "mean", models.mean(axis=0), random


def figures(runs: Runs, label: str) -> Any:
    """JSON of a command."""
    return json.loads((runs.folders[label] / FIGURES).read_text("utf-8"))
