"""How fast work goes here: several slices of it, per CPU second of one core."""

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass

REPEATS = 5


@dataclass(frozen=True)
class Rate:
    """Work per CPU second of one core, over slices of it.

    Attributes
    ----------
    median : what to expect of this machine at this hour
    quickest : nearest to what the code can do, because what else a shared machine does only slows
    """

    median: float
    quickest: float

    def times(self, factor: float) -> "Rate":
        """The same in another unit."""
        return Rate(self.median * factor, self.quickest * factor)


def rate(work: Callable[[], float], before: Callable[[], object] = lambda: None) -> Rate:
    """Measure `REPEATS` slices of work; one before them compiles and is not counted.

    Parameters
    ----------
    work : does a slice and returns how much that was
    before : puts back, not counted, what a slice changes, so that all are of the same work
    """
    before()
    work()
    slices = []
    for _ in range(REPEATS):
        before()
        started = time.process_time()
        done = work()
        slices.append(done / (time.process_time() - started))
    return Rate(statistics.median(slices), max(slices))
