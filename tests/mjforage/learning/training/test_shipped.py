"""The weights that ship."""

import copy
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import torch
from numpy.typing import NDArray

from mjforage.graph_planner.networks import weights
from mjforage.graph_planner.networks.inference import values_of
from mjforage.graph_planner.networks.q_network import MoveNetwork
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


@pytest.mark.every_capability
def test_decisions_do_not_depend_on_the_batch(published: Setup) -> None:
    nodes = []
    for episodes in (np.arange(5), np.array([3])):
        mission = Mission(published)
        mission.reset(2, episodes)
        log = EpisodeLog(mission)
        mission.run(create_policy("ddqn-reward"), (log,))
        nodes.append(log.agent_node[int(np.flatnonzero(episodes == 3)[0])])
    assert nodes[0].tobytes() == nodes[1].tobytes()


@pytest.mark.every_capability
@pytest.mark.parametrize("name", [one for one in SHIPPED if one != "mappo"])
def test_values_are_those_of_double_precision_on_every_processor(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Up to rounding, of which each type of processor has its own: where two moves are worth the
    same to 1e-5, decisions may differ.
    """
    errors = []

    def both(network: MoveNetwork, levels: dict[str, NDArray[np.uint8]]) -> NDArray[np.float32]:
        exact = copy.deepcopy(network).double()
        for part in exact.modules():
            if not list(part.children()):
                part.register_forward_pre_hook(lambda _, given: tuple(x.double() for x in given))
        with torch.no_grad():
            wanted = exact({key: torch.from_numpy(level) for key, level in levels.items()})
        found = values_of(network, levels)
        errors.append(np.abs(found - wanted.numpy()).max())
        return found

    monkeypatch.setattr("mjforage.graph_planner.networks.inference.values_of", both)
    mission = Mission(Setup.of(load_scenario("comb-port", ("horizon=20",))))
    mission.reset(11, np.arange(2))
    mission.run(create_policy(name))
    assert len(errors) >= 20 and max(errors) < 1e-5


def test_the_command_line_names_missing_weights(
    refused: Callable[..., str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(weights, "models_folder", lambda: tmp_path)
    words = refused("evaluate", "--policy", "ddqn-reward", "--out", tmp_path / "run")
    assert "weights ddqn-reward: not found as" in words
    assert not (tmp_path / "run").exists()
