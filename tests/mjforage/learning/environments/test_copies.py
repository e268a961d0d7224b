"""Copies of environments in memory: they go on to the bit, and have nothing in common."""

import copy
import multiprocessing
import pickle
from collections.abc import Callable
from functools import partial
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AsyncVectorEnv, SyncVectorEnv

import mjforage
from mjforage.base.compiled import kinds_of
from mjforage.learning.environments.copies import Copied
from tests.mjforage.walking import arrays, memories

SHORT = ("horizon=5",)
Make = Callable[[], Any]


def foraging(**options: Any) -> dict[str, Make]:
    told: dict[str, Any] = {"set": SHORT, **options}
    return {
        "Foraging": partial(gymnasium.make, "mjforage:mjforage/Foraging-v0", **told),
        "SharedPolicy": partial(gymnasium.make, "mjforage/SharedPolicy-v0", **told),
        "parallel": partial(mjforage.parallel_env, **told),
        "batch": partial(gymnasium.make_vec, "mjforage/Foraging-v0", num_envs=2, **told),
    }


LOSSY = ("link.loss=0.3", "link.burst=2", "link.latency=1")
RADIO = (*SHORT, "link.model=disk", "link.range_m=40", *LOSSY)
BLURRED = ("sensors.detection=0.7", "sensors.false_rate=0.01", "sensors.map=filtered")
ENVIRONMENTS: dict[str, Make] = {
    **{f"graph {name}": make for name, make in foraging().items()},
    **{
        f"physics {name}": make
        for name, make in foraging(world="physics").items()
        if name != "batch"
    },
    "paper": foraging(observation="paper", dtype="uint8")["Foraging"],
    "link": foraging(set=RADIO)["parallel"],
    "link, sensors": foraging(set=(*RADIO, *BLURRED))["batch"],
    "drawn": foraging(render_mode="rgb_array")["SharedPolicy"],
    "same step": foraging(autoreset_mode="SameStep", copy=False)["batch"],
    "waypoint": partial(gymnasium.make, "mjforage/Waypoint-v0"),
}
HOW: dict[str, Callable[[Any], Any]] = {
    "deepcopy": copy.deepcopy,
    "pickle": lambda env: pickle.loads(pickle.dumps(env)),  # noqa: S301
}


def flat(value: Any) -> Any:
    """A value, to be compared to the bit."""
    if isinstance(value, dict):
        return {key: flat(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [flat(one) for one in value]
    if isinstance(value, np.ndarray) and value.dtype != np.object_:
        return value.dtype, value.shape, value.tobytes()
    return [flat(one) for one in value] if isinstance(value, np.ndarray) else value


def played(env: Any, steps: int, seed: int) -> list[Any]:
    """All that an environment gives in some steps of random actions, over ends of episodes."""
    random, told = np.random.default_rng(seed), []
    for _ in range(steps):
        action: Any
        if hasattr(env, "possible_agents"):
            action = {agent: int(random.integers(9)) for agent in env.agents}
        elif env.action_space.dtype == np.float32:
            action = random.uniform(-1.0, 1.0, 2)
        else:
            action = random.integers(0, 9, env.action_space.shape)
        found = env.step(action)
        told.append(flat(found))
        if env.render_mode:
            told.append(flat(env.render()))
        over = np.all([*found[2].values()] if isinstance(found[2], dict) else found[2])
        late = np.all([*found[3].values()] if isinstance(found[3], dict) else found[3])
        if (over or late) and not hasattr(env, "num_envs"):
            told.append(flat(env.reset()))
    return told


def begun(make: Make) -> Any:
    env = make()
    env.reset(seed=3)
    played(env, 3, 0)
    return env


@pytest.mark.parametrize("how", HOW)
@pytest.mark.parametrize("name", ENVIRONMENTS)
def test_a_copy_goes_on_to_the_bit_and_disturbs_nobody(name: str, how: str) -> None:
    steps = 40 if "Shared" in name or name == "drawn" else 9
    alone, env = (begun(ENVIRONMENTS[name]) for _ in range(2))
    first, second = HOW[how](env), HOW[how](env)
    played(first, steps, 5)
    second_of_copy = HOW[how](second)
    wanted = played(alone, steps, 1)
    for one in (second, env, second_of_copy):
        assert played(one, steps, 1) == wanted
    assert flat(second.reset(seed=8)) == flat(env.reset(seed=8))


@pytest.mark.parametrize("how", HOW)
@pytest.mark.parametrize("name", ENVIRONMENTS)
def test_a_copy_has_memory_of_its_own_shared_as_before(name: str, how: str) -> None:
    env = begun(ENVIRONMENTS[name])
    other = HOW[how](env)
    before, after = (dict(arrays(each, "", {})) for each in (env, other))
    assert len(before) > 20 and before.keys() == after.keys()
    for path, array in before.items():
        twin = after[path]
        assert kinds_of(twin) == kinds_of(array), path
        assert twin.tobytes() == array.tobytes(), path
    assert memories(before) == memories(after)
    both = [*before.items(), *((f"copy{path}", array) for path, array in after.items())]
    for group in memories(dict(both)):
        across = {path.startswith("copy") for path in group}
        assert len(across) == 1 or not any(dict(both)[path].flags.writeable for path in group)


def play_there(envs: list[Any], pipe: Any) -> None:
    pipe.send([played(env, 9, 1) for env in envs])


def test_a_spawned_process_goes_on_to_the_bit() -> None:
    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe()
    envs = [begun(ENVIRONMENTS[name]) for name in ("graph batch", "physics parallel", "waypoint")]
    process = context.Process(target=play_there, args=(envs, there))
    process.start()
    told = here.recv()
    process.join()
    assert told == [played(env, 9, 1) for env in envs]


@pytest.mark.parametrize("world", ["graph", "physics"])
def test_workers_of_gymnasium_may_be_spawned(world: str) -> None:
    makes = [foraging(world=world)["Foraging"]] * 2
    apart, together = AsyncVectorEnv(makes, context="spawn"), SyncVectorEnv(makes)
    assert flat(apart.reset(seed=1)) == flat(together.reset(seed=1))
    assert played(apart, 7, 2) == played(together, 7, 2)
    apart.close()


def test_a_copy_before_the_first_episode_draws_the_same() -> None:
    env = mjforage.parallel_env(set=SHORT)
    other = copy.deepcopy(env)
    assert flat(other.reset()) == flat(env.reset())


class Halves(Copied):
    """Two views of memory that nobody can write."""

    def __init__(self) -> None:
        whole = np.arange(6.0)
        whole.flags.writeable = False
        self.first, self.last = whole[:4], whole[2:]


def test_views_of_one_read_only_array_are_of_one_in_a_copy() -> None:
    halves = pickle.loads(pickle.dumps(Halves()))  # noqa: S301  ours
    assert np.shares_memory(halves.first, halves.last)
    assert halves.first.tolist() == [0.0, 1.0, 2.0, 3.0] and halves.last[0] == 2.0
    assert not halves.first.flags.writeable
