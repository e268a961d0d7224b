"""The weights that ship."""

import hashlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from mjforage.graph_planner.networks import weights
from mjforage.graph_planner.policies import create_policy
from mjforage.mission.episode_log import EpisodeLog
from mjforage.mission.mission import Mission
from mjforage.mission.scoring import Scorer
from mjforage.mission.setup import Setup
from mjforage.scenario.scenario_file import load_scenario

SHIPPED = ("ddqn", "ddqn-reward", "ddqn-link", "mappo")
PAPER = {"pta_d": 99.41, "pta_c": 98.68, "csr": 0.946}
"""The paper's learned policy: more is better."""
PAPER_LOW = {"nt50": 0.281, "nt90": 0.512, "rmse_columns": 0.0010}
"""Less is better."""


@pytest.fixture(scope="module")
def published() -> Setup:
    return Setup.of(load_scenario("published"))


def scores(setup: Setup, policy: str, episodes: int) -> dict[str, float]:
    mission = Mission(setup)
    mission.reset(11, np.arange(episodes))
    scorer = Scorer(mission)
    mission.run(create_policy(policy), (scorer,))
    found = scorer.scores().scalars
    return {name: float(np.nanmean(found[name])) for name in (*PAPER, *PAPER_LOW)}


@pytest.mark.every_capability
@pytest.mark.parametrize("name", SHIPPED)
def test_they_beat_greedy_by_the_published_rules(published: Setup, name: str) -> None:
    learned, greedy = scores(published, name, 40), scores(published, "greedy", 40)
    assert learned["pta_c"] > greedy["pta_c"]
    assert learned["nt50"] < greedy["nt50"]
    assert learned["nt90"] < greedy["nt90"]


@pytest.mark.parametrize("name", ["published", "open-bay"])
def test_the_best_beats_the_papers_row_also_on_a_map_it_has_not_seen(name: str) -> None:
    found = scores(Setup.of(load_scenario(name)), "ddqn", 100)
    for column, value in PAPER.items():
        assert found[column] > value, column
    for column, value in PAPER_LOW.items():
        assert found[column] < value, column


def test_they_work_on_other_maps_and_fleets() -> None:
    crew = ("team.scouts.count=1", "team.foragers.count=3", "map.starts=[]")
    for map_file in ("open_bay", "channels"):
        setup = Setup.of(load_scenario("comb-port", ("horizon=40", *crew), map_file))
        for name in SHIPPED:
            assert scores(setup, name, 4)["pta_c"] > scores(setup, "random", 4)["pta_c"]


NODES = {
    "ddqn": "446b2b230374559c",
    "ddqn-reward": "8afff6205b9e60a2",
    "ddqn-link": "494eefc090a22679",
    "mappo": "5d792d500edb28c0",
}
"""Digests of the nodes of the agents in three episodes."""


@pytest.mark.every_capability
def test_decisions_are_the_same_on_every_processor(
    caplog: pytest.LogCaptureFixture,
) -> None:
    setup, found = Setup.of(load_scenario("comb-port", ("horizon=60",))), {}
    for name in SHIPPED:
        mission = Mission(setup)
        mission.reset(11, np.arange(3))
        log = EpisodeLog(mission)
        mission.run(create_policy(name), (log,))
        found[name] = hashlib.sha256(log.agent_node.tobytes()).hexdigest()[:16]
    assert found == NODES and not caplog.messages


def test_the_command_line_names_missing_weights(
    refused: Callable[..., str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(weights, "models_folder", lambda: tmp_path)
    words = refused("evaluate", "--policy", "ddqn-reward", "--out", tmp_path / "run")
    assert "weights ddqn-reward: not found as" in words
    assert not (tmp_path / "run").exists()
