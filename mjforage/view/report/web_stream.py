"""Arrays of a replay as a short text: whole numbers, their changes, deflated, in base64.

The page reads it back with ``player/decode.js``. Numbers stand one after another as unsigned
LEB128 (seven bits a byte, lowest first); signed ones are folded first: 0, -1, 1, -2 -> 0, 1, 2, 3.
"""

import base64
import zlib
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.int64]


def packed(parts: Sequence[Ints]) -> str:
    """Numbers of 0 or more, below 2**32, as text."""
    numbers = np.concatenate([part.ravel() for part in parts]).astype(np.int64)
    deflated = zlib.compress(_leb128(numbers).tobytes(), 9)
    return base64.b64encode(deflated).decode("ascii")


def _leb128(numbers: Ints) -> NDArray[np.uint8]:
    sizes = np.ones_like(numbers)
    for shift in (7, 14, 21, 28):
        sizes += numbers >> shift > 0
    first = np.cumsum(sizes) - sizes
    result = np.zeros(int(sizes.sum()), np.uint8)
    for place in range(5):
        there = sizes > place
        more = np.where(sizes[there] > place + 1, 0x80, 0)
        result[first[there] + place] = (numbers[there] >> 7 * place & 0x7F) | more
    return result


def folded(numbers: Ints) -> Ints:
    """Signed numbers as unsigned ones, small staying small."""
    return np.where(numbers < 0, -2 * numbers - 1, 2 * numbers)


def thinned(frames: int, stride: int) -> Ints:
    """Every `stride`-th of so many frames, and the last."""
    wanted: Ints = np.minimum(np.arange(0, frames - 1 + stride, stride), frames - 1)
    return wanted


def track(values: NDArray[np.floating], quantum: float) -> list[Ints]:
    """Courses (time, ...) in units of `quantum`: the order of differences, then those, time last.

    Steady motion is shorter in second differences, noise in first ones: whichever sums to less.
    """
    whole = np.moveaxis(np.rint(values.astype(np.float64) / quantum).astype(np.int64), 0, -1)
    first = np.diff(whole, prepend=0)
    second = np.diff(first, prepend=0)
    order = 2 if np.abs(second).sum() < np.abs(first).sum() else 1
    return [np.array([order]), folded(second if order == 2 else first)]


def changes(layer: NDArray[np.integer]) -> list[Ints]:
    """Grids (step, row, column) of numbers of 0 or more, by what changes; before them all is 0.

    For each step how many cells change; then the cells, as the distance from the one before (the
    first of a step from the grid's start); then their new values.
    """
    flat = layer.reshape(len(layer), -1)
    changed = np.empty(flat.shape, np.bool_)
    changed[:1] = flat[:1] != 0
    np.not_equal(flat[1:], flat[:-1], out=changed[1:])
    step, cell = np.nonzero(changed)
    counts = np.bincount(step, minlength=len(flat)).astype(np.int64)
    gaps = np.diff(cell, prepend=0)
    opening = (np.cumsum(counts) - counts)[counts > 0]
    gaps[opening] = cell[opening]
    return [counts, gaps, flat[step, cell].astype(np.int64)]
