"""`mjforage bench --against CHECKOUT`: this code's speed beside another's, in slices in turn.

Machines are shared: a slice of one side and a slice of the other, one after the other, meet the
same weather, and the median of their ratios is what can be told. Integer hashing goes first, which
both sides do alike: its ratio shows the noise, and its rate how fast the core is.
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
from mjforage.bench.slice_worker import NAMES

WORKER = Path(__file__).with_name("slice_worker.py")


@dataclass(frozen=True)
class Beside:
    """Rates of both sides, work per CPU second, and their ratios slice by slice."""

    name: str
    ours: float  # medians
    theirs: float
    ratio: float  # median of the ratios of slices in turn
    low: float  # quartiles of those
    high: float


class Side:
    """A process that imports one checkout."""

    def __init__(self, checkout: Path) -> None:
        """Start it.

        Raises
        ------
        UserError
            If the folder holds no checkout.
        """
        if not (checkout / "mjforage" / "runs" / "evaluate.py").is_file():
            raise UserError(f"{checkout}: is no checkout of mjforage")
        self.checkout = checkout
        self._process = subprocess.Popen(
            [sys.executable, "-P", str(WORKER)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=os.environ | {"PYTHONPATH": str(checkout.resolve())},
        )

    def rate(self, name: str, seconds: float) -> float:
        """Work per CPU second of one slice.

        Raises
        ------
        UserError
            If that checkout cannot do it.
        """
        assert self._process.stdin is not None and self._process.stdout is not None
        with suppress(BrokenPipeError):  # it has ended: no answer comes
            self._process.stdin.write(f"{name} {seconds}\n")
            self._process.stdin.flush()
        answer = self._process.stdout.readline().split()
        if not answer:
            raise UserError(f"{self.checkout}: cannot run {name!r}; its own message stands above")
        return float(answer[0]) / float(answer[1])

    def close(self) -> None:
        """Let it end."""
        with suppress(BrokenPipeError):
            self._process.communicate()


def against(
    other: Path,
    slices: int = 9,
    seconds: float = 0.5,
    progress: Callable[[str], None] = lambda name: None,
    names: Sequence[str] = (),
) -> list[Beside]:
    """Measure this code and another checkout's.

    Parameters
    ----------
    other : folder of the other checkout
    slices : of each side and workload
    seconds : of CPU time per slice, at least
    progress : called with the name of what is about to be measured
    names : of workloads; none: all

    Raises
    ------
    UserError
        If there are fewer than 2 slices, or the folder holds no checkout or one that cannot do it.
    """
    if slices < 2:
        raise UserError(f"--slices {slices}: give at least 2")
    here, found = Path(__file__).resolve().parents[2], []
    with closing(Side(here)) as ours, closing(Side(other)) as theirs:
        for name in names or NAMES:
            progress(name)
            pairs = []
            for side in (ours, theirs):
                side.rate(name, 0.0)
            for turn in range(slices):
                order = (ours, theirs) if turn % 2 == 0 else (theirs, ours)
                rates = {side: side.rate(name, seconds) for side in order}
                pairs.append((rates[ours], rates[theirs]))
            ratios = [ours_now / theirs_now for ours_now, theirs_now in pairs]
            low, middle, high = statistics.quantiles(ratios, n=4)
            mine, other_rates = (statistics.median(side) for side in zip(*pairs, strict=True))
            found.append(Beside(name, mine, other_rates, middle, low, high))
    return found
