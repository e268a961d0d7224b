"""A batch on several threads is the batch on one, to the bit."""

from collections.abc import Callable
from functools import partial
from threading import get_ident
from typing import Any

import gymnasium
import mujoco
import numpy as np
import pytest

from mjforage.base.randomness import episode_keys
from mjforage.graph_planner.policies import create_policy
from mjforage.mission.dynamics import Transition
from mjforage.mission.mission import Mission, Observer
from mjforage.mission.setup import Setup
from mjforage.physics.dynamics.threaded_dynamics import ThreadedDynamics
from mjforage.physics.simulation import InstabilityError
from mjforage.physics.worlds import create_mission
from mjforage.scenario.scenario_file import load_scenario

SETUP = Setup.of(load_scenario("comb-port-weather", ["horizon=12", "items.std=20"]))


class Shown(Observer):
    """All of the truth, as bytes."""

    def __init__(self) -> None:
        self.bytes: list[bytes] = []

    def see(self, mission: Mission) -> None:
        """Take it."""
        parts = *mission.state, *mission.truth, *mission.ledger, mission.node_drift_rc
        self.bytes.append(b"".join(np.ascontiguousarray(part).tobytes() for part in parts))


def shown(threads: int, world: str) -> list[bytes]:
    """Everything in three episodes, of which two are started anew in between."""
    mission, found = create_mission(SETUP, world, threads=threads), Shown()
    mission.start(episode_keys(4, np.arange(3)))
    player = create_policy("greedy")
    for step in range(6):
        if step == 3:
            mission.restart(np.array([2, 1]), episode_keys(4, np.array([8, 9])))
        mission.prepare(player)
        mission.advance(mission.ask(player))
        found.see(mission)
    return found.bytes


@pytest.mark.parametrize("world", ["physics", "hulls"])
def test_results_do_not_depend_on_the_number_of_threads(world: str) -> None:
    one = shown(1, world)
    assert len({*one}) == len(one)
    for threads in (2, 5):
        assert shown(threads, world) == one


def test_parts_of_a_batch_move_on_threads_of_their_own() -> None:
    """All but in the first decision, which compiles; as many as an environment is asked for."""
    envs: Any = gymnasium.make_vec(
        "mjforage/Foraging-v0", 3, threads=2, world="hulls", set=("horizon=5",)
    )
    envs.reset(seed=3)
    seen: list[int] = []

    def noted(advance: Callable[..., Transition], *about: Any) -> Transition:
        seen.append(get_ident())
        return advance(*about)

    parts = envs.unwrapped._core.mission._dynamics._parts
    assert [own for _, own in parts] == [slice(0, 1), slice(1, 3)]
    for part, _ in parts:
        part.advance = partial(noted, part.advance)
    envs.step(envs.action_space.sample())
    assert seen == [get_ident()] * 2
    envs.step(envs.action_space.sample())
    first, second = seen[2:]
    assert first != second and get_ident() in (first, second)


@pytest.mark.parametrize("again", [False, True])
def test_the_error_of_an_episode_is_that_of_its_batch(again: bool) -> None:
    """Also of one that was started in a batch, beside one of another part."""
    mission = create_mission(SETUP, "physics", threads=2)
    mission.reset(3, np.array([7, 12]))
    dynamics, preferences = mission._dynamics, np.zeros((2, 4, 9))
    assert isinstance(dynamics, ThreadedDynamics)
    if again:
        episodes = np.array([6, 12])
        names = [f"3, episode {episode}" for episode in episodes]
        mission.restart(np.arange(2), episode_keys(3, episodes), names)
    mission.advance(preferences)
    handler = mujoco.get_mju_user_warning()
    second: Any = dynamics._parts[1][0]
    second._simulation.place_vessels(second._simulation.vessel_pose, np.full((1, 4, 3), 1e12))
    with pytest.raises(InstabilityError, match="seed 3, episode 12"):
        mission.advance(preferences)
    assert mujoco.get_mju_user_warning() is handler
