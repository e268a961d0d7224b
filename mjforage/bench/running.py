"""Speeds on this machine, per CPU second of one core, compile time excluded.

Machines are shared: compare figures of one run, by their ratios. Those of several threads are per
second, and count where as many cores are free.
"""

import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from mjforage.bench.workloads import WORKLOADS, Work

REPEATS = 5

Progress = Callable[[str], None]
Clock = Callable[[], float]


def slice_of(work: Work, seconds: float, clock: Clock = time.process_time) -> tuple[float, float]:
    """Work done in at least so many seconds of a clock, and the seconds that it took."""
    done, started = 0.0, clock()
    while (spent := clock() - started) < seconds:
        done += work()
    return done, spent


@dataclass(frozen=True)
class Rate:
    """Work per second: the median of slices, and the quickest of them."""

    value: float
    quickest: float
    unit: str = ""


def rate(
    work: Work, unit: str = "", seconds: float = 0.5, clock: Clock = time.process_time
) -> Rate:
    """Measure `REPEATS` slices of at least so many seconds; a call before them compiles."""
    work()
    slices = [slice_of(work, seconds, clock) for _ in range(REPEATS)]
    rates = [done / spent for done, spent in slices]
    return Rate(statistics.median(rates), max(rates), unit)


def bench(progress: Progress = lambda key: None, keys: Sequence[str] = ()) -> dict[str, Rate]:
    """Measure workloads, all of them if no keys are given; `progress` is called with each key."""
    found = {}
    for key in keys or WORKLOADS:
        progress(key)
        unit, make, threads = WORKLOADS[key]
        if threads == 1:
            found[key] = rate(make(), f"{unit} per CPU second of one core")
        else:
            unit = f"{unit} per second on {threads} cores"
            found[key] = rate(make(), unit, clock=time.perf_counter)
    return found
