"""Error and items removed after thirds of the steps, by hand from what happened."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from mjforage.cli.flags import METRIC
from mjforage.graph_planner.policies import create_policy
from mjforage.mission.mission import Mission, Observer
from mjforage.mission.scoring import METRICS, Scorer, chosen_metrics, import_specs_of
from mjforage.mission.setup import Setup
from mjforage.scenario.scenario_file import load_scenario

KEYS = [f"{kind}_{share}" for kind in ("mse", "ptc") for share in (33, 66, 100)]


class Watcher(Observer):
    """Works both out anew in every step of every episode, from the maps of cells."""

    def __init__(self) -> None:
        self.error: list[list[float]] = []
        self.removed: list[list[float]] = []

    def see(self, mission: Mission) -> None:
        graph, errors = mission.setup.graph, []
        for e in range(mission.keys.size):
            difference = np.zeros(graph.shape)
            truth = np.bincount(
                mission.state.item_node[e][mission.state.item_node[e] >= 0], minlength=len(graph)
            )
            difference[graph.navigable] = truth - mission.knowledge.belief[e]
            smooth = gaussian_filter(difference, 1.0, mode="reflect")
            errors.append(float(np.sqrt((smooth**2).mean(axis=0)).mean()))
        self.error.append(errors)
        collected = (mission.state.collected_by >= 0).sum(axis=1)
        self.removed.append((100.0 * collected / mission.initial.n_items).tolist())


def test_values_are_those_after_50_99_and_150_steps_and_the_last_one_is_held() -> None:
    mission, watcher = Mission(Setup.of(load_scenario("published-2025"))), Watcher()
    scorer = Scorer(mission, chosen_metrics(KEYS))
    mission.reset(5, np.arange(6))
    mission.run(create_policy("greedy"), (scorer, watcher))
    length = scorer.log.length
    assert length.min() < 120 and len(watcher.error) == length.max() + 1
    scores = scorer.scores().scalars
    for share, step in ((33, 50), (66, 99), (100, 150)):
        for e in range(6):
            at = min(step, int(length[e]))
            assert scores[f"mse_{share}"][e] == pytest.approx(watcher.error[at][e], abs=1e-12)
            assert scores[f"ptc_{share}"][e] == pytest.approx(watcher.removed[at][e], abs=1e-12)


def test_they_are_taken_where_they_are_named_and_in_other_processes_too() -> None:
    assert not {one.key for one in chosen_metrics()} & set(KEYS)
    assert {one.key for one in chosen_metrics(KEYS)} >= set(KEYS)
    assert import_specs_of(chosen_metrics(["mse_33"])) == ("mse_33",)
    assert all(key in (METRIC.help or "") for key in KEYS)
    assert METRICS.find("mse_33").unit == "items/node" and METRICS.find("ptc_33").unit == "%"
