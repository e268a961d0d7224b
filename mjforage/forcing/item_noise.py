"""The paper's noise of items: two uniforms per item and step, from one draw."""

import numpy as np

from mjforage.base.compiled import kernel
from mjforage.base.randomness import bits

_HALF = np.uint64(32)
_LOW = np.uint64(0xFFFFFFFF)
_TO_SYMMETRIC = 2.0 / (1 << 32)


@kernel
def to_symmetric(draw: np.uint64) -> tuple[float, float]:
    """Two uniforms in [-1, 1) from 64 random bits: (row, column) of an item's noise."""
    high, low = np.int64(draw >> _HALF), np.int64(draw & _LOW)
    return high * _TO_SYMMETRIC - 1.0, low * _TO_SYMMETRIC - 1.0


@kernel
def item_noise(key: np.uint64, item: int, step: int) -> tuple[float, float]:
    """Two uniforms in [-1, 1) for one item and step, from one draw: (row, column)."""
    return to_symmetric(bits(key, item, step))
