"""Batches of `Foraging-v0` whose decisions are on a device."""

from typing import Any
from unittest.mock import patch

import numpy as np
import pytest
import torch

from mjforage.base.cached import warn_once
from mjforage.base.errors import UserError
from mjforage.learning.environments import vector
from mjforage.learning.environments.core import EnvironmentCore
from mjforage.learning.environments.device_core import DeviceCore
from mjforage.learning.environments.options import EnvironmentOptions
from mjforage.learning.environments.rewards.decisions import TimePassed
from mjforage.learning.environments.vector import ForagingVectorEnv
from mjforage.physics.simulation import InstabilityError
from tests.mjforage.learning.environments.test_tensors import flat

ENVS = 3
CASES: tuple[dict[str, Any], ...] = (
    {
        "scenario": "comb-port-weather",
        "set": {"sensors.camera_fov_deg": 127},
        "autoreset_mode": "SameStep",
    },
    {
        "scenario": "comb-port",
        "reward": "ddqn",
        "set": {
            "faults.rate_per_h": 300,
            "corruption.team": "foragers",
            "corruption.epsilon": 0.5,
            "rules.start_seen": False,
        },
    },
    {
        "scenario": "comb-port-gnss",
        "reward": {"published": 0.5, "blocked": 1.0, "early": 1.0},
        "dtype": "uint8",
    },
    {
        "scenario": "open-bay",  # some items are collected
        "set": {
            "team.foragers.energy": 3,
            "team.foragers.capacity": 1,
            "items.mean": 300,
            "period_s": 8,
        },
        "autoreset_mode": "Disabled",
    },
)


def played(device: str = "warp-cpu", **about: Any) -> tuple[Any, list[dict[str, Any]]]:
    """All that a batch gives in six steps, in which episodes end and start anew."""
    changes = {"horizon": 3, "period_s": 4, **about.pop("set", {})}
    env: Any = ForagingVectorEnv(ENVS, world="physics", device=device, set=changes, **about)
    rng, told = np.random.default_rng(0), [flat(env.reset(seed=1))]
    for _ in range(6):
        actions: Any = torch.as_tensor(rng.integers(0, 9, env.action_space.shape))
        told.append(flat(env.step(actions)))
        env._core.come_back()
        mission = env._core.mission
        told[-1]["load"] = torch.tensor(mission._dynamics._simulation.load)
        for arrays in (mission.state, mission.knowledge, mission.ledger):
            kept = zip(arrays._fields, arrays, strict=True)
            told[-1] |= {name: torch.tensor(one) for name, one in kept if name != "known_at"}
    return env._core, told


def on_the_host(options: EnvironmentOptions, envs: int, threads: int) -> EnvironmentCore:
    return EnvironmentCore(options, envs, threads=threads)


@pytest.mark.parametrize("about", CASES)
def test_a_batch_on_a_device_is_one_of_the_host(about: dict[str, Any]) -> None:
    """Bit for bit: observations, masks, rewards and all of `info`."""
    with patch.object(vector, "create_core", on_the_host):
        _, known = played(**about)
    core, found = played(**about)
    assert isinstance(core, DeviceCore)
    for step, (one, other) in enumerate(zip(known, found, strict=True)):
        assert one.keys() == other.keys()
        for name, wanted in one.items():
            assert torch.equal(wanted, other[name]), f"step {step}: {name}"


def test_what_is_no_number_is_refused_on_a_device() -> None:
    """Preferences, and places of items, in the decision in which they occur."""
    env: Any = ForagingVectorEnv(2, world="physics", device="warp-cpu", set={"horizon": 1})
    env.reset(seed=0)
    with pytest.raises(UserError, match="policy: gives preferences that are NaN"):
        env._core.play(np.full((2, 4, 9), np.nan))
    simulation = env._core.mission._dynamics._simulation
    simulation._afloat.v[1, 3] = np.nan
    with pytest.raises(InstabilityError, match=r"item 3; check the wind"):
        env._core.play(np.zeros((2, 4, 9)))


class Later(TimePassed):
    """A term of somebody who has changed one of ours."""

    def __call__(self, step: Any) -> Any:
        return 2.0 * super().__call__(step)


class Nothing:
    """A term of somebody who knows of no device."""

    def __call__(self, step: Any) -> Any:
        return np.zeros(step.mission.state.agent_node.shape)


def test_what_has_no_kernels_is_played_by_the_host(caplog: pytest.LogCaptureFixture) -> None:
    """A term, an observation or a link without them; hulls are on the device all the same."""
    term, later = f"{__name__}:Nothing", f"{__name__}:Later"
    others: tuple[tuple[dict[str, Any], str], ...] = (
        ({"reward": {term: 1.0, "removed": 1.0}}, f"reward {term}"),
        ({"reward": {later: 1.0}}, f"reward {later}"),
        ({"observation": "paper"}, "observation paper"),
        ({"set": {"link.model": "none"}}, "a link"),
        ({"set": {"physics.items": "graph", "physics.capture": "node"}}, "items without bodies"),
    )
    warn_once.cache_clear()
    for about, words in others:
        core, _ = played(scenario="comb-port", **about)
        assert type(core) is EnvironmentCore
        assert caplog.messages[-1].startswith(f"device warp-cpu: has no kernels for {words}; ")
