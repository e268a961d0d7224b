"""Round weights files to 14 bits of mantissa: `python -m tests.packaging.rounding FILE ...`.

float32 has 24, of which trained weights use all, so that no wheel packs them. With the last 10 at 0
a file is as large as before and two thirds of it in a wheel; a weight changes by 31 millionths of
itself at most. For networks that ship; their figures are of the rounded file.
"""

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from safetensors import safe_open
from safetensors.numpy import save_file

DROPPED = 10
"""Bits of the mantissa that are set to 0."""


def rounded(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the nearest numbers whose last bits are 0, halves away from 0."""
    bits = np.ascontiguousarray(values).view(np.uint32) + np.uint32(2 ** (DROPPED - 1))
    return (bits & np.uint32(2**32 - 2**DROPPED)).view(np.float32)


for path in map(Path, sys.argv[1:]):
    with safe_open(path, "np") as file:
        tensors = {name: rounded(file.get_tensor(name)) for name in list(file.keys())}
        save_file(tensors, path, metadata=file.metadata())
    path.chmod(0o644)  # safetensors leaves it to the owner alone
