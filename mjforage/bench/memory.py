"""Peak memory of a piece of work, measured in a process of its own."""

import multiprocessing
import resource
import sys
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

_STATUS = Path("/proc/self/status")


def peak_memory_mb(work: Callable[[], object]) -> float:
    """Peak resident memory [MB] of a fresh process that imports `work` and calls it once.

    Parameters
    ----------
    work : a function of a module, or a `functools.partial` of one
    """
    fresh = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=fresh) as pool:
        return pool.submit(_peak_after, work).result()


def _peak_after(work: Callable[[], object]) -> float:
    work()
    return _own_peak_mb()


def _own_peak_mb() -> float:
    """Peak resident memory of this process [MB].

    Linux hands the peak of `getrusage` on from parent to child, that of the status file not.
    """
    if _STATUS.exists():
        line = next(row for row in _STATUS.read_text().splitlines() if row.startswith("VmHWM"))
        return int(line.split()[1]) / 1024.0
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1e6 if sys.platform == "darwin" else 1e3)
