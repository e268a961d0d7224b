"""Round a weights file to 16 bits of mantissa: `python -m tests.packaging.rounding FILE ...`.

float32 has 24, of which trained weights use all, so that no wheel packs them. With the last 8 at 0
a file is as large as before and a quarter smaller in a wheel; a weight changes by 8 millionths of
itself at most. For networks that ship; their figures are of the rounded file.
"""

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from safetensors import safe_open
from torch import from_numpy

from mjforage.learning.training.files import save_tensors

DROPPED = 8
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
    """Round a weights file in place; its one note stays as it is.

    Raises
    ------
    ValueError
        If the file's header has several notes, as the first weights had: equal content would then
        not be equal bytes.
    """
    with safe_open(path, "np") as file:
        (note,) = (file.metadata() or {}).items()
        tensors = {name: from_numpy(rounded(file.get_tensor(name))) for name in file.keys()}  # noqa: SIM118
    save_tensors(path, tensors, note)


if __name__ == "__main__":
    for named in sys.argv[1:]:
        round_file(Path(named))
