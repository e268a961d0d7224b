"""`Foraging-v0` in batches with hulls on a device: tensors in the place of arrays."""

from typing import Any, cast

import gymnasium
import numpy as np
import pytest
import torch

import mjforage
from mjforage.base.errors import UserError
from mjforage.learning.environments.tensors import Tensors
from mjforage.learning.environments.vector import ForagingVectorEnv
from mjforage.physics.warp_simulation import WarpSimulation

ID = "mjforage/Foraging-v0"
ABOUT: dict[str, Any] = {"scenario": "open-bay", "world": "physics", "set": {"horizon": 3}}
assert mjforage


def flat(value: Any, name: str = "") -> dict[str, Any]:
    """All tensors or arrays in something, by where they stand."""
    if isinstance(value, dict):
        parts = value.items()
    elif isinstance(value, tuple):
        parts = enumerate(value)  # type: ignore[assignment]
    else:
        return {name: value}
    return {key: one for k, part in parts for key, one in flat(part, f"{name}.{k}").items()}


@pytest.mark.parametrize("mode", ["NextStep", "SameStep"])
def test_a_batch_on_a_device_is_one_of_arrays_in_tensors(mode: str) -> None:
    """With MuJoCo as its engine bit for bit, to the end of the episodes and beyond."""
    about = {**ABOUT, "num_envs": 2, "autoreset_mode": mode}
    arrays = gymnasium.make_vec(ID, **about)
    tensors = gymnasium.make_vec(ID, device="cpu", copy=False, **about)
    known: Any = arrays.reset(seed=1)
    found: Any = tensors.reset(seed=1)
    arrays.action_space.seed(0)
    kept: list[tuple[Any, Any]] = []
    for _ in range(5):
        wanted, told = flat(known), flat(found)
        final = [name for name in wanted if name.endswith(".final_obs")]
        for name in final:
            each = {f"{name}.{key}": one for key, one in wanted[name][0].items()}
            wanted |= {
                key: np.stack((one, wanted[name][1][key.split(".")[-1]]))
                for key, one in each.items()
            }
            del wanted[name]
        assert wanted.keys() == told.keys()
        for name, one in wanted.items():
            assert isinstance(told[name], torch.Tensor)
            np.testing.assert_array_equal(told[name].numpy(), one, name)
        kept += [(each, each.clone()) for each in told.values()]
        actions = arrays.action_space.sample()
        known, found = arrays.step(actions), tensors.step(torch.as_tensor(actions))
    assert all(torch.equal(*pair) for pair in kept)


def test_tensors_have_memory_of_their_own() -> None:
    array = np.zeros(3)
    tensor = Tensors("cpu", "physics").of({"facts": (array,)})["facts"][0]
    array[:] = 1.0
    assert isinstance(tensor, torch.Tensor) and tensor.tolist() == [0.0] * 3


def test_hulls_move_in_warp() -> None:
    env: Any = gymnasium.make_vec(ID, 2, device="warp-cpu", **ABOUT)
    env.reset(seed=1)
    observation, reward, *_ = env.step(torch.full((2, 4), 2))
    assert isinstance(env, ForagingVectorEnv)
    dynamics = cast(Any, env)._core.mission._dynamics
    assert isinstance(dynamics._simulation, WarpSimulation)
    assert observation["local_map"].dtype == torch.float32 and reward.shape == (2,)
    mask = torch.tensor([False, True])
    _, info = env.reset(options={"reset_mask": mask})
    masks = [valid for name, valid in info.items() if name.startswith("_")]
    assert masks and all(torch.equal(valid, mask) for valid in masks)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"device": "gpu"}, "^device = 'gpu': unknown; choose cpu, warp-cpu, cuda$"),
        (
            {"device": "warp-cpu", "world": "graph"},
            "^device warp-cpu: the graph world has no hulls",
        ),
        ({"device": "cuda"}, "^device cuda: there is none here"),
        ({"device": "cpu", "set": "horizon=3"}, "^set = 'horizon=3': is str; give a mapping"),
    ],
)
def test_what_cannot_be_is_one_line(options: dict[str, Any], words: str) -> None:
    with pytest.raises(UserError, match=words):
        gymnasium.make_vec(ID, 2, **{**ABOUT, **options})
