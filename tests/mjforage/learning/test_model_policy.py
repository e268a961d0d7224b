"""A model trained elsewhere plays in `evaluate` what it plays in its environment."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from numpy.typing import NDArray

import mjforage
from mjforage.base.errors import UserError
from mjforage.learning.environments.spaces import Arrays
from mjforage.learning.model_policy import ModelPolicy
from mjforage.mission.mission import Mission
from mjforage.mission.setup import Setup
from mjforage.physics.worlds import create_mission
from mjforage.scenario.scenario_file import load_scenario

SHORT = ("horizon=12",)


def scored(seen: Arrays) -> NDArray[np.float64]:
    """Values of moves by a fixed rule of all that is seen, illegal moves included."""
    moves, own = seen["moves"].astype(np.float64), seen["own"].astype(np.float64)
    rule = np.cos(np.arange(moves.shape[-1]) * 1.7) @ np.swapaxes(moves, -1, -2)
    drift = np.sin(np.arange(9) + 3.0 * own.sum(axis=-1, keepdims=True))
    found: NDArray[np.float64] = rule + drift + 0.5 * seen["action_mask"]
    return found


def own_taste(agent: NDArray[np.int64]) -> NDArray[np.float64]:
    """What each agent (row,) adds to the values of its moves."""
    taste: NDArray[np.float64] = np.sin(5.0 * agent[:, None] + np.arange(9))
    return taste


class InTurn(ModelPolicy):
    def decide(self, seen: Arrays, agents: NDArray[np.int64]) -> NDArray[Any]:
        return np.asarray(scored(seen).argmax(axis=-1))


class AtOnce(InTurn):
    trained_on = "mjforage/Foraging-v0"


class Each(InTurn):
    trained_on = "parallel_env"

    def decide(self, seen: Arrays, agents: NDArray[np.int64]) -> NDArray[Any]:
        return np.asarray((scored(seen) + own_taste(agents)).argmax(axis=-1))


class Values(InTurn):
    def decide(self, seen: Arrays, agents: NDArray[np.int64]) -> NDArray[Any]:
        return scored(seen)


def single(name: str) -> Callable[[], list[int]]:
    def play() -> list[int]:
        env: Any = gymnasium.make(name, scenario="comb-port", set=SHORT).unwrapped
        seen, over = env.reset(seed=7)[0], False
        while not over:
            seen, _, ended, late, _ = env.step(scored(seen).argmax(axis=-1))
            over = ended or late
        return [int(node) for node in env.core.mission.state.agent_node[0]]

    return play


def parallel() -> list[int]:
    env = mjforage.parallel_env(scenario="comb-port", set=SHORT)
    seen, _ = env.reset(seed=7)
    while env.agents:
        tastes = own_taste(np.array([env.possible_agents.index(agent) for agent in seen]))
        seen, *_ = env.step(
            {
                agent: int((scored(one) + taste).argmax())
                for (agent, one), taste in zip(seen.items(), tastes, strict=True)
            }
        )
    return [int(node) for node in env.core.mission.state.agent_node[0]]


def played(policy: ModelPolicy, episodes: list[int], world: str = "graph") -> Mission:
    mission = create_mission(Setup.of(load_scenario("comb-port", SHORT)), world)
    mission.reset(7, np.array(episodes))
    mission.run(policy)
    return mission


@pytest.mark.parametrize(
    ("policy", "environment"),
    [
        (InTurn, single("mjforage/SharedPolicy-v0")),
        (AtOnce, single("mjforage/Foraging-v0")),
        (Each, parallel),
    ],
)
def test_it_ends_where_the_environments_episode_ends(
    policy: type[ModelPolicy], environment: Callable[[], list[int]]
) -> None:
    assert played(policy(), [0]).state.agent_node[0].tolist() == environment()


@pytest.mark.parametrize("policy", [InTurn, AtOnce, Each, Values])
def test_the_batch_changes_nothing(policy: type[ModelPolicy]) -> None:
    whole = played(policy(), list(range(40))).state.agent_node
    np.testing.assert_array_equal(played(policy(), [37, 3]).state.agent_node, whole[[37, 3]])


@pytest.mark.parametrize(
    ("said", "words"),
    [
        (
            np.full(32, 9),
            r"gave int64 of shape \(1,\); expected whole numbers 0-8 of shape",
        ),
        (np.full((32, 9), np.nan), r"values of shape \(1, 9\) without NaN"),
        (np.zeros((32, 5)), r"gave float64 of shape \(1, 5\)"),
        (np.full(32, 1.0), r"gave float64 of shape \(1,\)"),
    ],
)
def test_what_is_neither_moves_nor_values_is_one_line(said: NDArray[Any], words: str) -> None:
    class Bad(ModelPolicy):
        def decide(self, seen: Arrays, agents: NDArray[np.int64]) -> NDArray[Any]:
            return said

    with pytest.raises(UserError, match=words):
        played(Bad(), [0])


def test_names_and_files_are_checked(tmp_path: Path) -> None:
    class Lost(InTurn):
        trained_on = "Foraging"

    with pytest.raises(UserError, match=r"Lost.trained_on = 'Foraging': unknown; choose mjforage/"):
        played(Lost(), [0])
    with pytest.raises(UserError, match=r"model .*gone.zip: there is no such file"):
        InTurn([tmp_path / "gone.zip"])
