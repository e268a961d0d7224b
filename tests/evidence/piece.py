"""What a piece of evidence is: its commands, how its table comes from what they leave, its form.

Numbers are one thing and their form another. `docs/evidence/data/NAME.json` holds the numbers of a
piece in full and where they come from; columns say how they are shown. So a page can be drawn
again without a run, and no number on it is anybody's typing.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from numpy.typing import ArrayLike

from mjforage import metrics

if TYPE_CHECKING:
    from tests.evidence.playing import Runs

REPOSITORY = Path(__file__).parents[2]

Cell = str | dict[str, float] | None
"""Words, a number with what is known of it, or nothing.

Keys of a number: `mean` of the episodes, `gap` to another mean over the same episodes, `half` of
the interval ± 1.96 SEM of the last of these, or the ends `low` and `high` of its interval; `n`
episodes in which all of that is defined. Undefined numbers are left out.
"""
Row = Sequence[Cell]


class Column(NamedTuple):
    """Head of a column and the form of its numbers."""

    head: str
    digits: int = 0  # decimals; of a difference at most, as its interval needs no more
    significant: bool = False  # digits, not decimals


@dataclass(frozen=True)
class Piece:
    """A table of pages, or files that are written whole, or both."""

    name: str  # of its data and its regions
    runs: Mapping[str, str]  # what a run is called here -> its command, as a page shows it
    columns: tuple[Column, ...] = ()
    rows: "Callable[[Runs], Iterable[Row]]" = field(default=lambda runs: ())
    files: tuple[str, ...] = ()  # that are written whole, from the repository's folder
    write: "Callable[[Runs], object]" = field(default=lambda runs: None)
    minutes: float = 0.0  # of one core, reckoned, of commands that leave no run to tell them
    shown: bool = True  # whether its region has the commands; not, where one before it has them


def average(values: ArrayLike) -> Cell:
    """Mean of (episode,) values."""
    return defined(mean=metrics.mean(values), n=metrics.count(values))


def mean(values: ArrayLike) -> Cell:
    """Mean of (episode,) values, ± 1.96 SEM."""
    found = {"mean": metrics.mean(values), "half": metrics.half_width_95(values)}
    return defined(**found, n=metrics.count(values))


def gap(values: ArrayLike, others: ArrayLike) -> Cell:
    """Mean of the differences of (episode,) values, entry by entry, ± 1.96 SEM."""
    differences = metrics.statistics.defined(values) - metrics.statistics.defined(others)
    found = {"gap": metrics.mean(differences), "half": metrics.half_width_95(differences)}
    return defined(**found, n=metrics.count(differences))


def beside(values: ArrayLike, others: ArrayLike) -> Cell:
    """Mean of (episode,) values, and what they differ from others, ± 1.96 SEM."""
    difference = gap(values, others)
    assert isinstance(difference, dict)
    return {**defined(mean=metrics.mean(values)), **difference}


def interval(values: ArrayLike, others: ArrayLike) -> Cell:
    """Mean of the differences of (episode,) values, with its bootstrap 95 % interval."""
    found = metrics.paired_difference(values, others, 0)
    return defined(gap=found.value, low=found.low, high=found.high, n=found.n)


def defined(**numbers: ArrayLike) -> dict[str, float]:
    """Those numbers that are defined; counts stay whole."""
    found = {key: float(value) for key, value in numbers.items()}  # type: ignore[arg-type]
    return {
        key: int(value) if key == "n" else value for key, value in found.items() if value == value
    }
