"""Training on variants: what episodes draw, what is stored of them, resuming, errors."""

from typing import Any

import numpy as np
import pytest
import torch

from mjforage.base.errors import UserError
from mjforage.base.randomness import episode_keys
from mjforage.graph_planner.encodings import create_encoder
from mjforage.graph_planner.policies import create_policy
from mjforage.learning.environments.options import EnvironmentOptions
from mjforage.learning.training.algorithm import TRAINED
from mjforage.learning.training.hyperparameters import Hyperparameters, changed
from mjforage.learning.training.tasks import TrainingTask, variants
from mjforage.learning.training.trainer import Trainer
from mjforage.mission.mission import Mission
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.scenario_file import load_scenario

TINY = {"num_envs": 6, "capacity": 2000, "batch": 16, "warmup": 40, "evaluate_episodes": 2}
VARY = {"vary.link.range_m": [16, 1e6], "vary.link.latency": [0, 1]}


def scenario(link: str = "link.model=disk") -> Scenario:
    return load_scenario("comb-port", ("horizon=12", link))


def trainer(**changes: object) -> Trainer:
    return Trainer([scenario()], changed(Hyperparameters(), TINY | changes), seed=3)


def test_variants_are_all_combinations() -> None:
    found = variants(scenario(), {"link.range_m": (16, 1e6), "link.latency": (0, 1)})
    links = [(one.link.model, one.link.range_m, one.link.latency) for one in found]
    assert links == [("disk", 16, 0), ("disk", 16, 1), ("disk", 1e6, 0), ("disk", 1e6, 1)]
    assert {one.horizon for one in found} == {12}


def test_values_are_drawn_alike_often_and_by_the_episode_alone() -> None:
    """Of two values each is drawn by half of 400 episodes, +- 4 deviations of a coin (40)."""
    task = TrainingTask(EnvironmentOptions(scenario()), 400, {"link.latency": (0, 1)})
    round_of_all = task.round(episode_keys(0, np.arange(400)))
    sizes = [own.size for own in round_of_all.envs]
    assert sum(sizes) == 400 and abs(sizes[0] - 200) <= 40
    of_some = task.round(episode_keys(0, np.arange(7, 400)))
    for whole, part in zip(round_of_all.envs, of_some.envs, strict=True):
        np.testing.assert_array_equal(whole[whole >= 7] - 7, part)


def test_what_is_stored_is_what_each_agent_knew() -> None:
    """Every agent's pictures are of its own row of a mission that plays the same episode alone."""
    one = trainer(**VARY)
    keys = episode_keys(TRAINED + 3, np.arange(6))
    one.play_round()
    assert len(one.round.cores) > 1
    differ = 0
    for core, envs in zip(one.round.cores, one.round.envs, strict=True):
        for env in envs:
            mission = Mission(core.setup)
            mission.start(keys[[env]])
            encoder = create_encoder("egocentric", core.setup.task)
            encoder.reset(4)
            for step in range(12):
                levels = {
                    n: v.copy()
                    for n, v in encoder.see(mission.owner_observation, np.arange(4)).items()
                }
                moves = np.zeros((1, 4, 9))
                for team, learner in one.learners.items():
                    memory = learner.memory
                    for place, agent in enumerate(one.agents[team]):
                        row = step * memory.streams + env * one.agents[team].size + place
                        for name, level in levels.items():
                            np.testing.assert_array_equal(
                                memory.levels[name][row], level[agent, agent], f"{name} {step}"
                            )
                            differ += (level[agent, agent] != level[agent - 1, agent]).any()
                        moves[0, agent, memory.moves[row]] = 1.0
                mission.advance(moves)
    assert differ > 0  # rows do not all know the same


def test_a_round_without_a_link_is_a_round_of_one_row() -> None:
    """Drawing among one value only plays, and learns, what the scenario itself does."""
    plain, drawn = trainer(), trainer(**{"vary.link.range_m": [1e6]})
    for each in (plain, drawn):
        each.play_round()
    for team, learner in plain.learners.items():
        other = drawn.learners[team].tensors()
        for name, value in learner.tensors().items():
            assert torch.equal(value, other[name]), name


def test_a_teacher_knows_what_each_agent_knows() -> None:
    """Its moves are those that it makes by the holders' rows, not by what all know together."""
    one = trainer(**VARY, teacher="greedy", teacher_updates=1000)
    one.play_round()  # all of it is the teacher's
    for core, envs in zip(one.round.cores, one.round.envs, strict=True):
        mission = Mission(core.setup)
        mission.start(episode_keys(TRAINED + 3, np.arange(6))[envs])
        mission.run(create_policy("greedy"))
        np.testing.assert_array_equal(mission.state.agent_node, core.mission.state.agent_node)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"vary.link.range_m": []},
            r"learning settings: vary.link.range_m = \[\]: no values",
        ),
        ({"vary.link.range_m": [-3]}, "learning settings, vary: link.range_m = -3 should be "),
        (
            {"vary.link.rang_m": [3]},
            "learning settings, vary: unknown key link.rang_m; did you",
        ),
        ({"vary.link.range_m": 3}, r"learning settings: vary.link.range_m = 3 should be"),
        ({"vary.seeds": [3]}, "learning settings, vary: unknown key seeds"),
        ({"vary.link.latency": list(range(257))}, "vary makes 257 scenarios of one; give at most"),
        ({"vary.team.scouts.count": [1, 2]}, "fleets or arrays .* differ"),
    ],
)
def test_what_cannot_be_drawn_is_refused(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(UserError, match=words):
        trainer(**changes)


def test_a_key_that_needs_a_link_names_it() -> None:
    settings = changed(Hyperparameters(), TINY | {"vary.link.range_m": [16]})
    with pytest.raises(UserError, match=r"link.range_m = 16.* without a link; give link.model"):
        Trainer([scenario("link.model=ideal")], settings)
