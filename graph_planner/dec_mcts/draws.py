"""Draws one after the other from a key: the steps of SplitMix64, see `randomness`."""

import numpy as np

from mjforage.base.compiled import inlined, kernel
from mjforage.base.randomness import UInt64Array, bits, mix, to_uniform

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)


@kernel
def begin(key: np.uint64, index: int, step: int) -> UInt64Array:
    """State (1,) of the draws of (stream key, index, step)."""
    state = np.empty(1, np.uint64)
    state[0] = bits(key, index, step)
    return state


@inlined
def draw(state: UInt64Array) -> float:
    """The next float64 in [0, 1)."""
    state[0] += _GOLDEN
    return to_uniform(mix(state[0]))
