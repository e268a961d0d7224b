"""Records for kernels: a class names and explains the fields, numpy and numba lay them out."""

from collections.abc import Iterable
from typing import Any

import numpy as np


def record_type(names: Iterable[str]) -> "np.dtype[Any]":
    """A record of float64 fields, read and written by name in kernels and in Python alike."""
    return np.dtype((np.record, np.dtype([(name, np.float64) for name in names], align=True)))
