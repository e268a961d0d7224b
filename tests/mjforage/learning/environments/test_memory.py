"""Levels instead of values, and observations in memory that is used again."""

from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

import mjforage
from mjforage.base.errors import UserError

FEW = ("horizon=6", "items.mean=3", "items.std=1", "items.covariance_node2=4")
NAMES = ("local_map", "global_map", "moves", "own")


def batch(**options: Any) -> Any:
    return gymnasium.make_vec("mjforage/Foraging-v0", num_envs=3, set=FEW, **options)


def test_levels_are_the_values_times_255_in_every_environment() -> None:
    ids = "mjforage/Foraging-v0", "mjforage/SharedPolicy-v0"
    for name in ids:
        plain, raw = (gymnasium.make(name, set=FEW, dtype=t) for t in ("float32", "uint8"))
        values, levels = plain.reset(seed=1)[0], raw.reset(seed=1)[0]
        assert raw.observation_space.contains(levels)
        for array in NAMES:
            assert levels[array].dtype == np.uint8 and values[array].dtype == np.float32
            np.testing.assert_array_equal(levels[array] * np.float32(1 / 255), values[array])
    several = mjforage.parallel_env(set=FEW, dtype="uint8")
    observations, _ = several.reset(seed=1)
    assert all(several.observation_space(a).contains(o) for a, o in observations.items())
    with pytest.raises(UserError, match="dtype = 'float16': unknown; choose float32, uint8"):
        gymnasium.make(ids[0], dtype="float16")


@pytest.mark.parametrize("dtype", ["float32", "uint8"])
@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_memory_that_is_used_again_shows_the_same(dtype: str, mode: AutoresetMode) -> None:
    fresh, again = (batch(dtype=dtype, autoreset_mode=mode, copy=copy) for copy in (True, False))
    random = np.random.default_rng(0)
    first, _ = fresh.reset(seed=2)
    kept = {name: first[name].copy() for name in NAMES}
    (shown, _), shared = again.reset(seed=2), False
    for _ in range(15):
        actions = random.integers(0, 9, (3, 4))
        one, *_, info = fresh.step(actions)
        other, *_, same = again.step(actions)
        assert again.observation_space.contains(other)
        for name in NAMES:
            np.testing.assert_array_equal(one[name], other[name])
            shared |= np.shares_memory(other[name], shown[name])
            assert not np.shares_memory(one[name], first[name])
            for i in np.flatnonzero(info.get("_final_obs", ())):
                last, again_last = (part["final_obs"][i][name] for part in (info, same))
                np.testing.assert_array_equal(last, again_last)
                assert not np.shares_memory(again_last, other[name])
        shown = other
    assert shared
    for name in NAMES:
        np.testing.assert_array_equal(first[name], kept[name])
