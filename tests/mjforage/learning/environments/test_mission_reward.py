"""The default reward: which policies it ranks first, its potentials, and sums of an episode."""

from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

import mjforage
from mjforage.base.errors import UserError
from mjforage.learning.environments.options import EnvironmentOptions
from mjforage.learning.environments.rewards import reward_weights
from mjforage.learning.training.hyperparameters import Hyperparameters
from tests.mjforage.learning.reward_table import correlation, played, ranks

FEW = ("horizon=40", "items.mean=6", "items.std=1")


def moves(env: gymnasium.Env[Any, Any], rng: np.random.Generator) -> Any:
    """Random legal moves, of an agent or of all."""
    mask = env.unwrapped.core.masks[0]  # type: ignore[attr-defined]
    if isinstance(env.action_space, gymnasium.spaces.Discrete):
        mask = env.unwrapped.action_masks()  # type: ignore[attr-defined]
    return np.argmax(rng.random(mask.shape) * mask, axis=-1)


def test_returns_rank_policies_as_the_mission_does() -> None:
    names = ("stay", "random", "levy", "greedy", "belief")
    found = {name: played("comb-port", name, 10) for name in names}
    pairs = list(ranks(found))
    assert len(pairs) >= 9 and all(right for *_, right in pairs)
    assert correlation(found) > 0.98
    assert found["belief"]["collected"] == pytest.approx(found["belief"]["pta_c"])


def test_names_of_rewards() -> None:
    published = {"belief": 2.12, "removed": 5.91, "idleness": 2.23, "distance": -1.7}
    assert reward_weights("published") == published
    assert reward_weights("ddqn") == Hyperparameters().reward
    assert EnvironmentOptions().weights == reward_weights("mission")
    terms = reward_weights({"fresh": 0.0, "mission": 2.0, "blocked": -1})
    assert terms == {
        "collected": 200.0,
        "early": 20.0,
        "known": 8.0,
        "reach": 40.0,
        "blocked": -1.0,
    }
    assert reward_weights({"ddqn": 2, "published": 1})["removed"] == 2 * 0.5 + 5.91
    discounted = {f"{name}(gamma=0.9)" for name in ("known", "reach", "fresh")}
    assert {*reward_weights("mission(gamma=0.9)")} == {"collected", "early", *discounted}
    with pytest.raises(UserError, match="reward mission = 'x': give a finite number"):
        EnvironmentOptions(reward={"mission": "x"})  # type: ignore[dict-item]
    for wrong, said in {"mision": "did you mean mission?", "mission(gama=1)": "gamma"}.items():
        with pytest.raises(UserError, match=said):
            EnvironmentOptions(reward=wrong)
    with pytest.raises(UserError, match=r"gamma = 1\.5: give 0 to 1"):
        gymnasium.make("mjforage/Foraging-v0", reward="mission(gamma=1.5)")


def at_the_start(name: str, turns: int, seed: int, energy: float, horizon: int) -> dict[str, float]:
    """The potentials of the first state, found from the rewards of an episode of random moves."""
    gamma, names = 0.9, ("known", "reach", "fresh")
    stores = (f"team.{team}.energy={energy}" for team in ("scouts", "foragers"))
    few = (*FEW, f"horizon={horizon}", "team.scouts.moves=1", *stores)
    reward = {f"{term}(gamma={g})": 1.0 for term in names for g in (gamma, 1.0)}
    env = gymnasium.make(f"mjforage/{name}", set=few, reward=reward)
    env.reset(seed=3)
    rng, discount, over = np.random.default_rng(seed), 1.0, False
    gained, changed = dict.fromkeys(names, 0.0), dict.fromkeys(names, 0.0)
    while not over:
        *_, terminated, truncated, info = env.step(moves(env, rng))
        for term in names:
            gained[term] += discount * info.get(f"reward/{term}(gamma={gamma})", 0.0)
            changed[term] += info.get(f"reward/{term}(gamma=1)", 0.0)
        discount, over = discount * gamma, terminated or truncated
    assert terminated == (energy < 300.0)
    if terminated:
        return {term: -value for term, value in changed.items()}
    first = gamma ** (turns - 1)  # the discount of the first reward
    return {
        term: (discount * changed[term] - gained[term] / first) / (1.0 - discount) for term in names
    }


@pytest.mark.parametrize(("name", "turns"), [("Foraging-v0", 1), ("SharedPolicy-v0", 4)])
def test_potentials_add_to_the_discounted_return_what_no_move_changes(
    name: str, turns: int
) -> None:
    """Minus the potential of the first state, and that of the last where it is truncated, which is
    what a value that learners go on from is less by; at an end there is no more to come.
    """
    worth = at_the_start(name, turns, 0, 300.0, 40)
    assert worth["fresh"] > 0.01
    assert at_the_start(name, turns, 1, 300.0, 40) == pytest.approx(worth)
    assert at_the_start(name, turns, 0, 5.0, 300) == pytest.approx(worth)


def test_an_agent_that_is_over_has_no_potential() -> None:
    few = (*FEW, "team.scouts.moves=1", "team.scouts.energy=2")
    env = mjforage.parallel_env(set=few, reward={"fresh(gamma=1)": 1.0})
    env.reset(seed=3)
    rng = np.random.default_rng(0)
    first: dict[str, bool] = {}
    sums: dict[str, float] = {}
    while env.agents:
        masks = env.core.masks[0]
        chosen = dict(
            zip(env.possible_agents, (rng.random(masks.shape) * masks).argmax(1), strict=True)
        )
        *_, truncated, infos = env.step(chosen)
        sums |= {agent: infos[agent]["episode_terms/fresh(gamma=1)"] for agent in infos}
        first |= {agent: truncated[agent] for agent in infos}
    assert first == {"scouts_0": False, "scouts_1": False, "foragers_0": True, "foragers_1": True}
    assert sums["scouts_0"] == sums["scouts_1"] < -0.002
    assert sums["foragers_0"] == sums["foragers_1"] > 0.0


@pytest.mark.parametrize("name", ["Foraging-v0", "SharedPolicy-v0"])
def test_an_episode_has_sums_of_its_terms(name: str) -> None:
    env = gymnasium.make(f"mjforage/{name}", set=FEW)
    rng = np.random.default_rng(0)
    for seed in (3, None):
        env.reset(seed=seed)
        total, over, by_term = 0.0, False, dict.fromkeys(reward_weights("mission"), 0.0)
        while not over:
            _, reward, terminated, truncated, info = env.step(moves(env, rng))
            total, over = total + float(reward), terminated or truncated
            for term in by_term:
                by_term[term] += info.get(f"reward/{term}", 0.0)
        sums = {term: info[f"episode_terms/{term}"] for term in by_term}
        assert sums == pytest.approx(by_term)
        assert sum(sums.values()) == pytest.approx(total)
        assert sums["collected"] == pytest.approx(info["pta_c"])


@pytest.mark.parametrize("mode", list(AutoresetMode))
def test_a_batch_has_the_sums_of_each_episode(mode: AutoresetMode) -> None:
    """The last ones of an episode: where Gymnasium has an episode's last info."""
    envs = gymnasium.make_vec("mjforage/Foraging-v0", 2, autoreset_mode=mode, set=FEW)
    envs.reset(seed=3)
    rng, returns, ended = np.random.default_rng(0), np.zeros(2), 0
    for _ in range(90):
        _, rewards, terminated, truncated, info = envs.step(rng.integers(0, 9, (2, 4)))
        returns += rewards
        over = terminated | truncated
        last = info["final_info"] if mode is AutoresetMode.SAME_STEP and over.any() else info
        for env in np.flatnonzero(over):
            keys = [f"episode_terms/{term}" for term in reward_weights("mission")]
            assert all(last[f"_{key}"][env] for key in keys)
            assert sum(last[key][env] for key in keys) == pytest.approx(returns[env])
        returns[over], ended = 0.0, ended + over.sum()
        if mode is AutoresetMode.DISABLED and over.any():
            envs.reset(options={"reset_mask": over})
    assert ended >= 4
