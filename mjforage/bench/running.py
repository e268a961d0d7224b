"""Speeds on this machine, per CPU second of one core, compile time excluded.

Machines are shared: compare figures of one run, and two states of the code by `against`.
"""

import os
import statistics
import subprocess
import sys
from collections.abc import Callable, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass
from pathlib import Path

from mjforage.base.errors import UserError
from mjforage.bench import workloads
from mjforage.bench.workloads import WORKLOADS, Work, slice_of

REPEATS = 5

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Rate:
    """Work per CPU second of one core: the median of slices, and the quickest of them."""

    value: float
    quickest: float
    unit: str = ""


def rate(work: Work, unit: str = "", seconds: float = 0.5) -> Rate:
    """Measure `REPEATS` slices of at least so many seconds; a call before them compiles."""
    work()
    slices = [slice_of(work, seconds) for _ in range(REPEATS)]
    rates = [done / spent for done, spent in slices]
    return Rate(statistics.median(rates), max(rates), unit)


def bench(progress: Progress = lambda key: None, keys: Sequence[str] = ()) -> dict[str, Rate]:
    """Measure workloads, all of them if no keys are given; `progress` is called with each key."""
    found = {}
    for key in keys or WORKLOADS:
        progress(key)
        unit, make = WORKLOADS[key]
        found[key] = rate(make(), f"{unit} per CPU second of one core")
    return found


@dataclass(frozen=True)
class Comparison:
    """Rates of two checkouts [work per CPU second], and their ratios slice by slice."""

    key: str
    ours: float  # medians
    theirs: float
    ratio: float  # median of the ratios of slices in turn
    low: float  # quartiles of those
    high: float


class _Checkout:
    """A process that imports one checkout; `UserError` if the folder holds none."""

    def __init__(self, folder: Path) -> None:
        if not (folder / "mjforage" / "runs" / "evaluate.py").is_file():
            raise UserError(f"{folder}: is no checkout of mjforage")
        self.folder = folder
        self._process = subprocess.Popen(
            [sys.executable, "-P", str(workloads.__file__)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=os.environ | {"PYTHONPATH": str(folder.resolve())},
        )

    def rate(self, key: str, seconds: float) -> float:
        """Work per CPU second of one slice; `UserError` if that checkout cannot do it."""
        assert self._process.stdin is not None and self._process.stdout is not None
        with suppress(BrokenPipeError):  # it has ended: no answer comes
            self._process.stdin.write(f"{key} {seconds}\n")
            self._process.stdin.flush()
        answer = self._process.stdout.readline().split()
        if not answer:
            raise UserError(f"{self.folder}: cannot run {key!r}; its own message stands above")
        return float(answer[0]) / float(answer[1])

    def close(self) -> None:
        with suppress(BrokenPipeError):
            self._process.communicate()


def against(
    other: Path,
    slices: int = 9,
    seconds: float = 0.5,
    progress: Progress = lambda key: None,
    keys: Sequence[str] = (),
) -> list[Comparison]:
    """Compare this code with another checkout, in slices of CPU time in turn.

    Parameters
    ----------
    other : folder of the other checkout
    slices, seconds : of each side and workload, at least 2
    progress, keys : as of `bench`

    Raises
    ------
    UserError
        If there are fewer than 2 slices, or the folder holds no checkout or one that cannot do it.
    """
    if slices < 2:
        raise UserError(f"--slices {slices}: give at least 2")
    here, found = Path(__file__).resolve().parents[2], []
    with closing(_Checkout(here)) as ours, closing(_Checkout(other)) as theirs:
        for key in keys or WORKLOADS:
            progress(key)
            pairs = []
            for turn in range(slices):
                order = (ours, theirs) if turn % 2 == 0 else (theirs, ours)
                rates = {side: side.rate(key, seconds) for side in order}
                pairs.append((rates[ours], rates[theirs]))
            low, middle, high = statistics.quantiles([own / others for own, others in pairs], n=4)
            mine, its = (statistics.median(side) for side in zip(*pairs, strict=True))
            found.append(Comparison(key, mine, its, middle, low, high))
    return found
