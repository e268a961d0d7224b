"""A mission, a taught round and a batch in numba's simulator of CUDA, as on the processor.

On a machine with a GPU: on that.
"""

from typing import Any

import numpy as np

from mjforage.base.device import SIMULATED
from mjforage.base.randomness import episode_keys
from mjforage.graph_planner.policies import create_policy
from mjforage.learning.environments.cores import create_core
from mjforage.learning.environments.device_core import DeviceCore
from mjforage.learning.environments.options import EnvironmentOptions
from mjforage.learning.environments.vector import ForagingVectorEnv
from mjforage.learning.training.mappo.critic_features import critic_features
from mjforage.learning.training.rounds import Round
from mjforage.mission.setup import Setup
from mjforage.mission.trajectory import TrajectoryRecorder
from mjforage.physics.worlds import create_mission
from mjforage.scenario.scenario_file import load_scenario
from tests.mjforage.learning.environments.test_tensors import flat

CHANGES = ("horizon=4", "period_s=4", "items.mean=12", "items.std=3")
EPISODES = 2
NEAR = 0.95  # share of numbers on a GPU, where a rounding may change a decision


def played(device: str) -> list[Any]:
    """States, frames of the first episode, and what waits for the next decision.

    Episodes start anew in between, with fewer items and then with more than any before; the last
    goes on.
    """
    scenario = load_scenario("comb-port-gnss", [f"physics.device={device}", *CHANGES])
    frames: Any = TrajectoryRecorder()
    mission: Any = create_mission(Setup.of(scenario), "physics", frames)
    mission.reset(3, np.arange(EPISODES + 1))
    policy = create_policy("greedy")
    mission.prepare(policy)
    states = []
    for step in range(3):
        for row, number in ((), ((1, 0), (0, 0)), ((0, 0), (1, 1)))[step]:
            mission.restart(np.array([row]), episode_keys(11, np.array([number])))
        mission.advance(mission.ask(policy))
        states += [np.array(part) for part in mission.state]
    mission._dynamics._leave(None)
    rest = mission._dynamics._tracks, mission._dynamics._attempts
    kept = [np.array(part) for each in rest for part in each]
    return [*states, *kept, *(np.array(part) for frame in frames._parts for part in frame)]


def taught(device: str) -> list[Any]:
    """What agents see, what a teacher shows them and what it earns, decision after decision."""
    about = "horizon=3", "period_s=3", "items.mean=12", "items.std=0", f"physics.device={device}"
    core = create_core(EnvironmentOptions("comb-port-weather", "physics", set=about), EPISODES)
    assert isinstance(core, DeviceCore)
    lesson, told = Round([core], [np.arange(EPISODES)]), []
    lesson.start(episode_keys(5, np.arange(EPISODES)))
    lesson.teach("greedy")
    for _ in range(3):
        told += [one.clone().numpy() for one in lesson.see(np.arange(EPISODES)).values()]
        preferences, demonstrated = lesson.demonstrated()
        outcome = lesson.play(preferences)
        told += [np.array(part) for part in (preferences, demonstrated, lesson.masks, *outcome)]
        told += critic_features(lesson).values()
        told += [np.array(core.mission.node_drift_rc)]
    return [*told, np.array(lesson.collected)]


def stepped(device: str) -> list[Any]:
    """All that a batch of environments gives, in which one of them starts anew.

    It has fewer items than before, then more than any.
    """
    changes = {"horizon": 2, "period_s": 1, "items.mean": 6, "items.std": 3}
    how: Any = {"autoreset_mode": "Disabled", "device": device, "set": changes}
    env, told = ForagingVectorEnv(EPISODES, world="physics", **how), []
    told.append(flat(env.reset(seed=1)))
    for step in range(3):
        if step:
            told.append(flat(env.reset(options={"reset_mask": np.array([False, True])})))
        told.append(flat(env.step(np.full(env.action_space.shape or (), step))))
    return [np.array(one.numpy()) for each in told for one in each.values()]


def compare(wanted: list[Any], found: list[Any]) -> None:
    """Bit for bit in the simulator; on a GPU most numbers are the same but for rounding."""
    assert len(wanted) == len(found)
    for one, other in zip(wanted, found, strict=True):
        if SIMULATED or not one.size:
            assert one.tobytes() == other.tobytes()
        else:
            near = np.isclose(np.float64(one), np.float64(other), 1e-3, 1e-3, equal_nan=True)
            assert near.mean() >= NEAR, f"{near.mean():.3f} of {one.dtype} {one.shape}"


if __name__ == "__main__":
    for alike in (stepped, taught):
        compare(alike("warp-cpu"), alike("cuda"))
    known = played("warp-cpu")
    assert len(known) > 50
    assert np.abs(known[1] - known[16]).max() > 0.1, "they have gone somewhere"
    compare(known, played("cuda"))
