"""Painting of a picture in bands of rows at once, with the same pixels as without bands."""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache

_MOST_THREADS = 4


@lru_cache(maxsize=1)
def _pool() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(_threads(), "bands")


def _threads() -> int:
    return min(_MOST_THREADS, os.cpu_count() or 1)


def in_bands(height: int, paint: Callable[[int, int], None]) -> None:
    """Call `paint(first, end)` for bands of rows that together make up `height`.

    `paint` should be a compiled kernel, which runs without Python's lock.
    """
    count = min(_threads(), height)
    edges = [height * band // count for band in range(count + 1)]
    for done in [_pool().submit(paint, *edges[k : k + 2]) for k in range(count)]:
        done.result()
