"""Round a weights file to 14 bits of mantissa: `python -m tests.packaging.rounding FILE ...`.

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
    """Return the nearest numbers whose last bits are 0, halves away from 0.

    Parameters
    ----------
    values : finite numbers of any shape
    """
    bits = np.ascontiguousarray(values).view(np.uint32)
    kept = np.uint32(2**32 - 2**DROPPED)
    return ((bits + np.uint32(2 ** (DROPPED - 1))) & kept).view(np.float32)


def round_file(path: Path) -> None:
    """Round a weights file in place; its notes stay as they are."""
    with safe_open(path, "np") as file:
        notes = file.metadata()
        tensors = {name: rounded(file.get_tensor(name)) for name in list(file.keys())}
    save_file(tensors, path, metadata=notes)
    path.chmod(0o644)  # safetensors leaves it to the owner alone


if __name__ == "__main__":
    for named in sys.argv[1:]:
        round_file(Path(named))
