"""Three updates through each library that people bring, without an adapter of ours."""

from collections.abc import Callable
from functools import partial
from typing import Any

import gymnasium
import pytest
import torch
from stable_baselines3 import DQN, PPO
from torch import nn

import mjforage

SHARED = "mjforage/SharedPolicy-v0"
TOLD: dict[str, Any] = {"scenario": "published", "set": {"horizon": 6}}
UPDATES = 3
pytestmark = pytest.mark.filterwarnings("ignore:PettingZoo in TorchRL is tested")


def moved(before: dict[str, torch.Tensor], module: nn.Module) -> bool:
    """True if weights are finite and have changed."""
    after = module.state_dict()
    assert all(bool(torch.isfinite(value).all()) for value in after.values())
    return any(not torch.equal(before[name], value) for name, value in after.items())


def kept(module: nn.Module) -> dict[str, torch.Tensor]:
    return {name: value.clone() for name, value in module.state_dict().items()}


def test_agents_are_grouped_by_their_teams() -> None:
    libraries = pytest.importorskip("torchrl.envs.libs.pettingzoo")
    env = libraries.PettingZooWrapper(mjforage.parallel_env(**TOLD), use_mask=True)
    assert env.group_map == {
        "scouts": ["scouts_0", "scouts_1"],
        "foragers": ["foragers_0", "foragers_1"],
    }


@pytest.mark.parametrize("name", ["Foraging-v0", "SharedPolicy-v0", "Waypoint-v0"])
def test_torchrl_makes_the_ids(name: str) -> None:
    """It gives every environment an argument of its own, and takes it back if that is refused."""
    libraries = pytest.importorskip("torchrl.envs.libs.gym")
    env = libraries.GymEnv(f"mjforage/{name}")
    assert env.rollout(3).batch_size == (3,)


def _actor(group: str) -> Any:
    """A masked policy of a group, which reads what an agent knows of itself."""
    from tensordict.nn import ProbabilisticTensorDictModule, ProbabilisticTensorDictSequential
    from tensordict.nn import TensorDictModule as Module
    from torchrl.modules import MaskedCategorical

    mask = (group, "action_mask")
    logits = Module(
        nn.Linear(12, 9), in_keys=[(group, "observation", "own")], out_keys=[(group, "logits")]
    )
    choice = ProbabilisticTensorDictModule(
        in_keys={"logits": (group, "logits"), "mask": mask},
        out_keys=[(group, "action")],
        distribution_class=MaskedCategorical,
        return_log_prob=True,
        log_prob_key=(group, "log_prob"),
    )
    return ProbabilisticTensorDictSequential(logits, choice)


@pytest.mark.parametrize("several", [False, True])
def test_torchrl_trains_with_masks(several: bool) -> None:
    libraries = pytest.importorskip("torchrl.envs.libs.pettingzoo")
    from tensordict.nn import TensorDictSequential
    from torchrl.envs import SerialEnv

    def make() -> Any:
        return libraries.PettingZooWrapper(mjforage.parallel_env(**TOLD), use_mask=True, seed=1)

    torch.manual_seed(0)
    env = SerialEnv(2, make) if several else make()
    actors = {group: _actor(group) for group in ("scouts", "foragers")}
    policy = TensorDictSequential(*actors.values())
    before, optimiser = kept(policy), torch.optim.SGD(policy.parameters(), lr=0.01)
    for _ in range(UPDATES):
        episode = env.rollout(6, policy, break_when_any_done=False)
        loss: Any = torch.zeros(())
        for group, actor in actors.items():
            chosen = episode[group, "action"].unsqueeze(-1)
            assert bool(episode[group, "action_mask"].gather(-1, chosen).all())
            reward = episode["next", group, "reward"].squeeze(-1)
            loss = (
                loss - (actor.get_dist(episode).log_prob(episode[group, "action"]) * reward).mean()
            )
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
    assert moved(before, policy)


@pytest.mark.parametrize(
    "make",
    [
        partial(PPO, n_steps=8, batch_size=8, n_epochs=1),
        partial(DQN, learning_starts=4, train_freq=4, batch_size=4, buffer_size=64),
    ],
)
def test_stable_baselines_trains(make: Callable[..., Any]) -> None:
    model = make("MultiInputPolicy", gymnasium.make(SHARED, **TOLD), seed=0, device="cpu")
    before = kept(model.policy)
    model.learn(8 * UPDATES)
    assert model._n_updates >= UPDATES and moved(before, model.policy)


def test_sb3_contrib_trains_with_masks() -> None:
    contrib = pytest.importorskip("sb3_contrib")
    env: Any = gymnasium.make(SHARED, **TOLD)
    options: dict[str, Any] = {"n_steps": 8, "batch_size": 8, "n_epochs": 1, "device": "cpu"}
    model = contrib.MaskablePPO("MultiInputPolicy", env, seed=0, **options)
    before = kept(model.policy)
    model.learn(8 * UPDATES)
    assert model._n_updates == UPDATES and moved(before, model.policy)
    seen, _ = env.reset(seed=2)
    masks = env.unwrapped.action_masks()
    assert masks[int(model.predict(seen, action_masks=masks)[0])]
