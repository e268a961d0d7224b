"""Layout of a batch: that of Gymnasium's own batch of the same environments."""

from functools import partial
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv

NAME = "mjforage/Foraging-v0"
NUM = 3
FEW = {"scenario": "published", "set": ("horizon=5", "items.mean=3", "items.std=1")}
MODES = list(AutoresetMode)


def pair(mode: AutoresetMode, **options: Any) -> tuple[Any, Any]:
    ours = gymnasium.make_vec(NAME, NUM, autoreset_mode=mode, **options)
    theirs = SyncVectorEnv([partial(gymnasium.make, NAME, **options)] * NUM, autoreset_mode=mode)
    return ours, theirs


def same(ours: Any, theirs: Any, path: str = "") -> None:
    """Alike in types, keys, dtypes and values."""
    assert type(ours) is type(theirs), path
    if isinstance(theirs, dict):
        assert sorted(ours) == sorted(theirs), path
        for key in theirs:
            same(ours[key], theirs[key], f"{path}/{key}")
        return
    if isinstance(theirs, np.ndarray):
        assert (ours.dtype, ours.shape) == (theirs.dtype, theirs.shape), path
    if isinstance(theirs, tuple) or getattr(theirs, "dtype", None) == np.object_:
        for i, (one, other) in enumerate(zip(ours, theirs, strict=True)):
            same(one, other, f"{path}[{i}]")
    elif isinstance(theirs, np.ndarray):
        np.testing.assert_array_equal(ours, theirs, path)
    else:
        assert ours == theirs, path


@pytest.mark.parametrize("mode", MODES)
def test_all_is_laid_out_as_gymnasium_does(mode: AutoresetMode) -> None:
    envs = pair(mode, **FEW)
    assert envs[0].metadata["autoreset_mode"] is envs[1].metadata["autoreset_mode"]
    same(envs[0].reset(seed=4), envs[1].reset(seed=4), "reset")
    random, ends = np.random.default_rng(1), 0
    apart = np.array([False, True, False])
    for step in range(14):
        if step == 2:  # from here on not all end at once
            same(*(env.reset(seed=9, options={"reset_mask": apart.copy()}) for env in envs))
        actions = random.integers(0, 9, (NUM, 4))
        found = [env.step(actions) for env in envs]
        same(found[0], found[1], f"step {step}")
        over = found[0][2] | found[0][3]
        ends += over.sum()
        assert over.sum() < NUM
        if mode is AutoresetMode.DISABLED and over.any():
            same(*(env.reset(options={"reset_mask": over.copy()}) for env in envs))
    assert ends > NUM
