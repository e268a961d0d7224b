"""Rates of batches of hulls, with an environment and without one, on one core and on two.

    python -m tests.mjforage.bench.hulls_in_turn --json found.json

measures the workloads of `mjforage bench` for hulls slice by slice in turn, so that a ratio is of
slices that followed each other. A slice of two threads in which there were no two free cores is
NaN.
"""

import argparse
import json
import math
import os
import time
from collections.abc import Sequence
from pathlib import Path

from mjforage.bench.running import slice_of
from mjforage.bench.workloads import WORKLOADS
from tests.controllers.proving_ground import say

COLUMNS = ("physics_batch_{}", "environment_physics_{}", "environment_physics_{}_threads_2")
SIZES = (1, 16, 64)
BUSY = 0.1  # cores that others may use beside two threads


def rates(keys: Sequence[str], rounds: int, seconds: float) -> dict[str, list[float]]:
    """Rates of each key (round,) [environment steps per CPU second, of threads per second]."""
    works = {key: WORKLOADS[key].make() for key in keys}
    for work in works.values():
        work()  # compiles
    found: dict[str, list[float]] = {key: [] for key in keys}
    for _ in range(rounds):
        for key, work in works.items():
            threads, before = WORKLOADS[key].threads > 1, others()
            clock = time.perf_counter if threads else time.process_time
            done, spent = slice_of(work, seconds, clock)
            crowded = threads and others() - before > BUSY * spent
            found[key].append(math.nan if crowded else done / spent)
    return found


def others() -> float:
    """CPU time of other processes since the machine has started [s]."""
    with Path("/proc/stat").open() as file:
        user, nice, system, _, _, interrupts, late, *_ = map(int, file.readline().split()[1:])
    ticks = user + nice + system + interrupts + late
    return ticks / os.sysconf("SC_CLK_TCK") - time.process_time()


def main(words: Sequence[str] | None = None) -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(prog="python -m tests.mjforage.bench.hulls_in_turn")
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--seconds", type=float, default=0.5, help="of a slice, at least")
    parser.add_argument("--json", type=Path)
    chosen = parser.parse_args(words)
    keys = [key.format(size) for size in SIZES for key in COLUMNS]
    found = rates([key for key in keys if key in WORKLOADS], chosen.rounds, chosen.seconds)
    for key, values in found.items():
        say(f"{key}: {', '.join(f'{value:.1f}' for value in values)}")
    if chosen.json:
        chosen.json.write_text(json.dumps(found) + "\n", "utf-8")


if __name__ == "__main__":
    main()
