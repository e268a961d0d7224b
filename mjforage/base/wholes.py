"""Whole numbers in kernels, the same on a processor and on a GPU."""

import math

from mjforage.base.compiled import kernel


@kernel
def floor(value: float) -> int:
    """Largest whole number that is not above a value: `math.floor`, which CUDA leaves a float."""
    return int(math.floor(value))  # noqa: RUF046
