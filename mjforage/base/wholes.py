"""Whole numbers in kernels, the same on a processor and on a GPU."""

import math

from mjforage.base.compiled import kernel

_EVEN = 1.5 * 2.0**52  # beside it, numbers are whole


@kernel
def rounded(value: float) -> float:
    """The nearest whole number, of two the even one, below 2**51: `np.round`, which CUDA lacks."""
    return (value + _EVEN) - _EVEN


@kernel
def floor(value: float) -> int:
    """Largest whole number that is not above a value: `math.floor`, which CUDA leaves a float."""
    return int(math.floor(value))  # noqa: RUF046
