"""Ours pass every check of environments; each check rejects a bad one, its own."""

from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium import spaces
from pettingzoo import ParallelEnv

import mjforage
from mjforage.testing import ConformanceError, check_environment
from mjforage.testing.environment_checks import ENVIRONMENT_CHECKS

SHORT = ("horizon=6",)


class Walk(gymnasium.Env[Any, Any]):
    """A walk on 0 to 9, from a random place; the ends close one way each."""

    render_mode = None

    def __init__(self) -> None:
        places = spaces.Box(0.0, 9.0, (1,), np.float32)
        mask = spaces.Box(0, 1, (2,), np.int8)
        self.observation_space = spaces.Dict({"place": places, "action_mask": mask})
        self.action_space = spaces.Discrete(2)

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        super().reset(seed=seed)
        self.place, self.steps = int(self.np_random.integers(1, 3)), 0
        return self.seen(), {}

    def seen(self) -> Any:
        return {"place": np.array([self.place], np.float32), "action_mask": self.mask()}

    def mask(self) -> Any:
        return np.array([self.place > 0, self.place < 9], np.int8)

    def illegal(self, action: Any) -> bool:
        return not self.mask()[action]

    def step(self, action: Any) -> Any:
        if not self.action_space.contains(action):
            raise ValueError(f"action {action}: give 0 or 1")
        illegal = int(self.illegal(action))
        if not illegal:
            self.place += 2 * int(action) - 1
        self.steps += 1
        terms = {"reward/place": 0.5 * self.place, "reward/time": -0.1}
        info = {**terms, "illegal": illegal}
        return self.seen(), sum(terms.values()), self.steps > 20, False, info


class Endless(Walk):
    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        return super().reset(seed=seed)[0]


class Chancy(Walk):
    def step(self, action: Any) -> Any:
        seen, _, *rest, info = super().step(action)
        chance = float(np.random.default_rng().random()) if self.steps > 3 else 0.0
        return seen, chance, *rest, {"illegal": info["illegal"]}


class Remembering(Walk):
    episodes = -1

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        found = super().reset(seed=seed)
        self.episodes += 1
        return found

    def step(self, action: Any) -> Any:
        seen, _, *rest, info = super().step(action)
        return seen, float(self.episodes > 0), *rest, {"illegal": info["illegal"]}


class Stray(Walk):
    def seen(self) -> Any:
        found = super().seen()
        found["place"] += 10.0 * (self.steps > 3)
        return found


class Shared(Walk):
    kept: Any = None

    def seen(self) -> Any:
        found = super().seen()
        if self.kept is None or self.steps < 3:
            self.kept = found
        self.kept["place"][:] = found["place"]
        self.kept["action_mask"] = found["action_mask"]
        return {"place": self.kept["place"], "action_mask": found["action_mask"]}


class Uncounted(Walk):
    def step(self, action: Any) -> Any:
        seen, reward, *rest = super().step(action)
        return seen, reward + 1.0, *rest


class Undefined(Walk):
    def step(self, action: Any) -> Any:
        seen, _, *rest, _ = super().step(action)
        return seen, float("nan") if self.steps > 3 else 0.0, *rest, {}


class Strict(Walk):
    """Counts what its mask calls legal."""

    def illegal(self, action: Any) -> bool:
        return bool(action == 1) or not self.mask()[action]


class Closed(Walk):
    def mask(self) -> Any:
        return super().mask() * np.int8(self.steps < 3)

    def illegal(self, action: Any) -> bool:
        return not super().mask()[action]


BAD = [
    (Endless, "api", "does not pass check_env of Gymnasium: "),
    (Chancy, "seed", "at step 4 for one seed, .* draw all chance from the seed of reset"),
    (Remembering, "seed", "gave reward 0.0 and 1.0 .* let reset forget everything"),
    (Stray, "space", r"at step 4 that is not in its space Dict"),
    (Shared, "memory", "changed place of step 2 afterwards; give a copy"),
    (Uncounted, "rewards", "but its terms in info .reward/place, reward/time. add up to"),
    (Undefined, "rewards", "gave the reward nan at step 4; give a finite number"),
    (Strict, "mask", "counted 1 illegal actions at step .*, which its mask had called legal"),
    (Closed, "mask", "gave a mask without a legal action at step 3; allow one"),
]


@pytest.mark.parametrize(("env", "check", "words"), BAD)
def test_a_bad_environment_is_rejected_by_its_check(env: Any, check: str, words: str) -> None:
    with pytest.raises(ConformanceError, match=words) as caught:
        check_environment(env)
    assert caught.value.check == check and "\n" not in str(caught.value)


def test_every_check_has_a_bad_environment() -> None:
    names = {check.__name__.removeprefix("check_") for check in ENVIRONMENT_CHECKS}
    assert names == {check for _, check, _ in BAD}


class Meeting(ParallelEnv[str, Any, int]):  # type: ignore[misc]
    """Two walk for six steps."""

    metadata = {"name": "meeting"}  # noqa: RUF012
    possible_agents = ["a", "b"]  # noqa: RUF012
    render_mode = None

    def __init__(self) -> None:
        self.spaces = {agent: spaces.Discrete(3) for agent in self.possible_agents}

    def observation_space(self, agent: str) -> Any:
        return self.spaces[agent]

    def action_space(self, agent: str) -> Any:
        return self.spaces[agent]

    def reset(self, seed: int | None = None, options: Any = None) -> Any:
        self.agents, self.steps = list(self.possible_agents), 0
        return dict.fromkeys(self.agents, np.int64(0)), {agent: {} for agent in self.agents}

    def step(self, actions: dict[str, int]) -> Any:
        if any(action not in self.spaces[agent] for agent, action in actions.items()):
            raise ValueError(f"actions {actions}: give each 0, 1 or 2")
        self.steps += 1
        agents, over = self.agents, self.steps > 5
        self.agents = [] if over else agents
        rewards = dict.fromkeys(agents, 0.0)
        flags = dict.fromkeys(agents, over), dict.fromkeys(agents, False)
        return dict.fromkeys(agents, np.int64(0)), rewards, *flags, {agent: {} for agent in agents}


class Boundless(Meeting):
    def step(self, actions: dict[str, int]) -> Any:
        seen, rewards, *rest = super().step(actions)
        return seen, {**rewards, "b": float("inf")}, *rest


class Agentless(Meeting):
    def step(self, actions: dict[str, int]) -> Any:
        seen, rewards, *rest = super().step(actions)
        return {"a": seen["a"]}, rewards, *rest


class Told(Meeting):
    """Its critic is told the step."""

    state_space = spaces.Box(0.0, 6.0, (1,), np.float32)

    def state(self) -> Any:
        return np.array([self.steps], np.float32)


class Guessing(Told):
    def state(self) -> Any:
        return np.array([np.random.default_rng().random()], np.float32)


class Counting(Told):
    """Its critic is told of episodes before."""

    episodes = -1

    def reset(self, seed: int | None = None, options: Any = None) -> Any:
        self.episodes += 1
        return super().reset(seed, options)

    def state(self) -> Any:
        return np.array([self.episodes], np.float32)


class Growing(Told):
    def state(self) -> Any:
        return np.zeros(1 + self.steps // 3, np.float32)


class Living(Told):
    """Gives its critic the array that it goes on with."""

    def reset(self, seed: int | None = None, options: Any = None) -> Any:
        self.live = np.zeros(1, np.float32)
        return super().reset(seed, options)

    def state(self) -> Any:
        self.live[0] = self.steps
        return self.live


BAD_MEETINGS = [
    (Boundless, r"rewards: .*the reward of b inf at step 1"),
    (Agentless, r"api: .*does not pass parallel_api_test of PettingZoo"),
    (Guessing, r"seed: .*gave observation state\(\) .* draw all chance from"),
    (Counting, r"seed: .*gave observation state\(\) .* let reset forget everything"),
    (Growing, r"space: .*an observation of state\(\) at step 3 that is not in its space Box"),
    (Living, r"memory: .*changed state\(\) of step 0 afterwards; give a copy"),
]


@pytest.mark.parametrize(("env", "words"), BAD_MEETINGS)
def test_parallel_environments_are_checked_agent_by_agent_and_their_state(
    env: Any, words: str
) -> None:
    with pytest.raises(ConformanceError, match=words):
        check_environment(env)


@pytest.mark.parametrize("env", [Walk, Meeting, Told])
def test_a_good_one_of_a_users_own_passes(env: Any) -> None:
    check_environment(env)


@pytest.mark.parametrize(
    ("env", "options"),
    [
        ("mjforage/Foraging-v0", {"set": SHORT}),
        ("mjforage/SharedPolicy-v0", {"set": SHORT, "observation": "paper"}),
        ("mjforage/Waypoint-v0", {}),
        (mjforage.parallel_env, {"set": SHORT}),
        (mjforage.parallel_env, {"set": (*SHORT, "link.model=disk", "link.range_m=32")}),
    ],
)
def test_ours_pass(env: Any, options: dict[str, Any]) -> None:
    check_environment(env, steps=12, **options)
