"""Whole episodes: determinism, exact reset, spaces, masks, ends."""

from functools import cache
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import mjforage
from mjforage.base.errors import UserError
from mjforage.graph_planner.policies import create_policy

FEW = ("horizon=20", "items.mean=3", "items.std=1", "items.covariance_node2=4")
NAMES = ("mjforage/Foraging-v0", "mjforage/SharedPolicy-v0", "mjforage/Waypoint-v0")


def make(name: str, **options: Any) -> gymnasium.Env[Any, Any]:
    if name != "mjforage/Waypoint-v0":
        options = {"scenario": "published", "set": FEW} | options
    return gymnasium.make(name, **options)


def flat(observation: Any) -> bytes:
    if isinstance(observation, dict):
        return b"".join(observation[name].tobytes() for name in sorted(observation))
    return bytes(observation.tobytes())


def plain(info: dict[str, Any]) -> dict[str, Any]:
    """Facts as numbers and lists of them."""
    return {name: np.asarray(value).tolist() for name, value in info.items()}


def episode(env: gymnasium.Env[Any, Any], seed: int | None, actions: int) -> list[Any]:
    """Everything that an episode shows, under random actions."""
    random = np.random.default_rng(actions)
    observation, info = env.reset(seed=seed)
    shown: list[Any] = [flat(observation), plain(info)]
    for _ in range(400):
        if isinstance(env.action_space, gymnasium.spaces.Box):
            action: Any = random.uniform(-1, 1, 2).astype(np.float32)
        else:
            action = random.integers(0, 9, env.action_space.shape)
        observation, reward, terminated, truncated, info = env.step(action)
        shown.append((flat(observation), reward, terminated, truncated, plain(info)))
        if terminated or truncated:
            return shown
    raise AssertionError("an episode without an end")


@pytest.mark.parametrize("name", NAMES)
def test_a_seed_is_an_episode_and_nothing_remains_of_the_one_before(name: str) -> None:
    used = make(name)
    episode(used, 5, 1)  # leaves whatever it leaves
    used.reset(seed=6)
    used.step(used.action_space.sample())  # and an episode half played
    assert episode(used, 3, 2) == episode(make(name), 3, 2)
    assert episode(used, 3, 2) != episode(used, 4, 2)


@pytest.mark.parametrize("more", [(), ("link.model=disk", "link.range_m=32")])
def test_the_parallel_view_repeats_and_changes_nothing_that_it_gave(more: tuple[str, ...]) -> None:
    """Whole episodes, fresh and after another; `parallel_seed_test` checks one step only."""
    envs = [mjforage.parallel_env(set=(*FEW, *more)) for _ in range(2)]
    used, random, given = envs[0], np.random.default_rng(0), []
    used.reset(seed=1)
    used.step(dict.fromkeys(used.agents, 0))
    found: list[Any] = [env.reset(seed=3) for env in envs]
    while True:
        for agent, seen in found[0][0].items():
            assert used.observation_space(agent).contains(seen)
            assert flat(seen) == flat(found[1][0][agent])
            given.append((seen, flat(seen)))
        assert found[0][1:] == found[1][1:]
        state, other = (env.state() for env in envs)
        assert used.state_space.contains(state) and flat(state) == flat(other)
        given.append((state, flat(state)))
        if not used.agents:
            break
        actions = {agent: int(random.integers(9)) for agent in used.agents}
        found = [env.step(actions) for env in envs]
    assert all(flat(seen) == before for seen, before in given)


def test_a_seed_has_many_episodes() -> None:
    one, other = make(NAMES[0]), make(NAMES[0])
    one.reset(seed=8)
    other.reset(seed=8)
    second = episode(one, None, 0)
    assert second == episode(other, None, 0)
    assert second != episode(one, None, 0)


SENSORS = ("sensors.detection=0.7", "sensors.false_rate=0.02", "sensors.map=filtered")
RADIO = ("link.model=disk", "link.range_m=40", "link.loss=0.3", "link.burst=2", "link.latency=2")


HULLS: dict[str, Any] = {
    "scenario": "comb-port-weather",
    "world": "physics",
    "map": np.ones((6, 6)),
    "set": ("horizon=7", "items.mean=2", "items.std=2", "items.covariance_node2=1"),
}
KINDS: dict[str, dict[str, Any]] = {
    "plain": {"set": FEW},
    "noisy": {"set": (*FEW, *SENSORS)},
    "radio": {"set": (*FEW, *SENSORS, *RADIO)},
    "hulls": HULLS,
    "hulls on threads, radio": HULLS | {"set": (*HULLS["set"], *SENSORS, *RADIO), "threads": 2},
    "hulls, items of the graph": HULLS | {"world": "calibrated"},
}


@pytest.mark.parametrize("mode", AutoresetMode)
@pytest.mark.parametrize("kind", KINDS)
def test_sub_environments_are_single_environments_to_the_bit(
    mode: AutoresetMode, kind: str
) -> None:
    """Ends, final observations and rewards included: the bootstrap mask is what one env shows."""
    num_envs, options = 3, {"scenario": "published", **KINDS[kind]}
    batch: Any = gymnasium.make_vec(NAMES[0], num_envs, autoreset_mode=mode, **options)
    assert batch.metadata["autoreset_mode"] is mode
    options.pop("threads", None)
    singles = [make(NAMES[0], **options) for _ in range(num_envs)]
    together, info = batch.reset(seed=7)
    for i, env in enumerate(singles):
        assert shown_of(*env.reset(seed=7 + i)) == of_env(together, i, info)
    random, again, ends, apart = np.random.default_rng(0), [False] * num_envs, 0, False
    for step in range(20 if "world" in options else 50):
        if step == 3:  # from here on not all end at once
            together, info = batch.reset(options={"reset_mask": np.array([False, True, False])})
            assert shown_of(*singles[1].reset()) == of_env(together, 1, info)
            again[1] = False
        actions = random.integers(0, 9, (num_envs, 4))
        together, rewards, terminated, truncated, info = batch.step(actions)
        over = terminated | truncated
        apart |= bool(over.any() and not over.all())
        restarted = [i for i in range(num_envs) if again[i]]
        for i in restarted:
            assert rewards[i] == 0.0 and not over[i]
        for i in {*range(num_envs)} - {*restarted}:
            *seen, reward, ended, late, infos = singles[i].step(actions[i])
            assert infos["agent_rewards"].sum() == pytest.approx(reward)
            assert (reward, ended, late) == (rewards[i], terminated[i], truncated[i])
            last = together, i, info
            if over[i] and mode is AutoresetMode.SAME_STEP:
                assert info["_final_obs"][i] and info["_final_info"][i]
                last = info["final_obs"], i, info["final_info"]
                restarted.append(i)
            assert shown_of(seen[0], infos) == of_env(*last)
            ends += bool(over[i])
        again = [mode is AutoresetMode.NEXT_STEP and bool(one) for one in over]
        if mode is AutoresetMode.DISABLED and over.any():
            together, info = batch.reset(options={"reset_mask": over})
            restarted = np.flatnonzero(over).tolist()
            assert info["_step"].tolist() == over.tolist()
        for i in restarted:
            assert shown_of(*singles[i].reset()) == of_env(together, i, info)
    assert ends >= 2 * num_envs and apart


def shown_of(observation: Any, info: dict[str, Any]) -> tuple[bytes, dict[str, Any]]:
    """All that one environment shows."""
    return flat(observation), plain(info)


def of_env(together: Any, i: int, info: dict[str, Any]) -> tuple[bytes, dict[str, Any]]:
    """The same of one of a batch, as its info has it."""
    own = [name for name in info if f"_{name}" in info and not name.startswith("final_")]
    infos = plain({name: info[name][i] for name in own if info[f"_{name}"][i]})
    if isinstance(together, dict):
        together = {name: each[i] for name, each in together.items()}
    else:
        together = together[i]
    return flat(together), infos


PLACES = [
    *((name, kind, "graph") for name in NAMES[:2] for kind in ("egocentric", "paper")),
    (NAMES[2], "", ""),
    (NAMES[0], "egocentric", "physics"),
    (NAMES[1], "paper", "physics"),
]


@pytest.mark.parametrize("place", PLACES, ids="-".join)
@settings(max_examples=8)
@given(data=st.data())
def test_no_observation_leaves_its_space(place: tuple[str, str, str], data: st.DataObject) -> None:
    """Nor does anything but an action pass for one."""
    env = environment(*place)
    observation, _ = env.reset(seed=data.draw(st.integers(0, 2**31)))
    assert env.observation_space.contains(observation)
    inside, outside = actions_of(env.action_space)
    for _ in range(data.draw(st.integers(1, 25))):
        if data.draw(st.integers(0, 4)) == 0:
            with pytest.raises(UserError, match=r"^action"):
                env.step(data.draw(outside))
        observation, reward, terminated, truncated, _ = env.step(data.draw(inside))
        assert env.observation_space.contains(observation)
        assert np.isfinite(float(reward))
        if terminated or truncated:
            break


@cache
def environment(name: str, kind: str, world: str) -> gymnasium.Env[Any, Any]:
    return make(name, **({"observation": kind, "world": world} if kind else {}))


def actions_of(
    space: gymnasium.Space[Any],
) -> tuple[st.SearchStrategy[Any], st.SearchStrategy[Any]]:
    """Of a space and outside it: one entry of the wrong kind or size, or another shape."""
    shape = space.shape or ()
    if isinstance(space, gymnasium.spaces.Box):
        good: st.SearchStrategy[Any] = st.floats(-1, 1, width=32)
        bad: st.SearchStrategy[Any] = st.sampled_from([np.nan, np.inf, -np.inf])
    else:
        good = st.integers(0, 8)
        bad = st.integers(-(2**62), -1) | st.integers(9, 2**62) | st.floats(-1e9, 1e9)
    size = int(np.prod(shape))
    inside = st.lists(good, min_size=size, max_size=size).map(lambda x: np.reshape(x, shape))

    def spoiled(action: NDArray[Any], entry: Any, place: int) -> NDArray[Any]:
        values = action.reshape(-1).astype(type(entry))
        values[place] = entry
        return values.reshape(shape)

    one_wrong = st.builds(spoiled, inside, bad, st.integers(0, size - 1))
    return inside, one_wrong | inside.map(lambda action: np.stack((action, action)))


def test_a_mask_says_what_is_legal() -> None:
    """An agent that chooses by its mask is never corrected in SharedPolicy-v0."""
    env, random = make(NAMES[1], set=("horizon=30",)), np.random.default_rng(0)
    observation, _ = env.reset(seed=0)
    over, corrected = False, 0
    while not over:
        legal = np.flatnonzero(observation["action_mask"])
        observation, _, terminated, truncated, info = env.step(random.choice(legal))
        corrected += info.get("illegal", 0)
        over = terminated or truncated
    assert corrected == 0
    assert env.unwrapped.action_masks().dtype == np.bool_  # type: ignore[attr-defined]


def test_illegal_choices_are_counted() -> None:
    env = make(NAMES[0])  # its rules have no staying put
    env.reset(seed=0)
    *_, info = env.step(np.full(4, 8))
    assert info["illegal"] == 4
    free = make(NAMES[0], scenario="comb-port")
    free.reset(seed=0)
    *_, info = free.step(np.full(4, 8))
    assert info["illegal"] == 0


def test_named_terms_add_up() -> None:
    weights = dict.fromkeys(("removed", "idleness", "distance", "approach", "time", "belief"), 0.5)
    for name in NAMES[:2]:
        env = make(name, reward=weights, scenario="comb-port", set=("horizon=15",))
        env.reset(seed=1)
        for _ in range(60):
            _, reward, terminated, truncated, info = env.step(env.action_space.sample())
            parts = [value for key, value in info.items() if key.startswith("reward/")]
            assert reward == pytest.approx(sum(parts), abs=1e-12)
            assert not parts or len(parts) == len(weights)
            if terminated or truncated:
                break


def test_ends_are_told_apart() -> None:
    full = make(NAMES[0], set=("horizon=5",))
    assert episode(full, 0, 0)[-1][2:4] == (False, True)  # the horizon, with items left
    few = ("horizon=400", "items.mean=1", "items.std=0", "items.covariance_node2=0")
    env = make(NAMES[0], set=few)
    policy, core = create_policy("greedy"), env.unwrapped.core  # type: ignore[attr-defined]
    env.reset(seed=0)
    policy.reset(core.setup.task, core.mission.keys)
    over = False
    while not over:
        action = core.mission.decide(policy.act(core.mission.observation)).direction[0]
        _, _, over, late, info = env.step(action)
        assert not late
    assert info["pta_c"] == 100.0  # nothing is left


@pytest.mark.parametrize(
    ("scenario", "store"),
    [("comb-port", "team.foragers.energy=3"), ("published", "team.scouts.energy=3.9")],
)
def test_an_agent_without_energy_is_over_and_the_others_go_on(scenario: str, store: str) -> None:
    """In `published` a scout has one move of two nodes, of which none is made shorter."""
    env = mjforage.parallel_env(scenario=scenario, set=(store, "horizon=12"))
    seen, _ = env.reset(seed=0)
    gone = 0
    while env.agents:
        before = set(env.agents)
        actions = {a: int(np.flatnonzero(seen[a]["action_mask"])[0]) for a in env.agents}
        seen, _, terminated, truncated, _ = env.step(actions)
        gone += sum(terminated.values())
        assert before - set(env.agents) == {a for a in before if terminated[a] or truncated[a]}
    assert gone == 2  # both of a team, of four agents


def test_rewards_of_agents_are_those_of_the_parallel_view() -> None:
    options: dict[str, Any] = {"scenario": "published", "set": FEW, "reward": "ddqn"}
    fleet, batch = mjforage.parallel_env(**options), gymnasium.make_vec(NAMES[0], 1, **options)
    fleet.reset(seed=3)
    batch.reset(seed=3)
    random, unlike = np.random.default_rng(0), 0
    while fleet.agents:
        moves = random.integers(0, 9, 4)
        _, rewards, *_ = fleet.step(dict(zip(fleet.possible_agents, moves.tolist(), strict=True)))
        *_, info = batch.step(moves[None])
        assert info["agent_rewards"][0].tolist() == [*rewards.values()]
        unlike += len({*rewards.values()}) > 1
    assert unlike
