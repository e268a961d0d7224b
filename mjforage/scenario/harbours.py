"""Generated harbours: maps that are functions of a kind, a seed and a size, and so need no file.

``harbour:combs:7`` is one of a size that its seed decides, ``harbour:combs:7:60x46`` one of 60 rows
and 46 columns, ``harbours:0-39`` those of seeds 0 to 39, each kind in turn, and
``harbours:channels:0-39`` those of one kind. By convention seeds below 1000 are for training, 1000
to 1009 are held back for judging.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy import ndimage

from mjforage.base.errors import UserError
from mjforage.base.randomness import Stream, episode_keys, stream_key
from mjforage.base.views import read_only
from mjforage.scenario.harbour_shapes import KINDS, Cells, Draw, drawn

ONE, MANY = "harbour:", "harbours:"
LEAST, MOST = 30, 120  # rows, columns
CELLS = 7200  # of a size that is drawn: its nodes have a table of distances
MOST_OF_A_FAMILY = 1000  # harbours
_BELOW = 1 << 63  # seeds
_FORMS = (
    f"harbour:KIND:SEED or harbour:KIND:SEED:ROWSxCOLUMNS, KIND one of {', '.join(KINDS)}, "
    f"ROWS and COLUMNS {LEAST} to {MOST}"
)


class Harbour(NamedTuple):
    """Reference to a generated harbour."""

    kind: str
    seed: int
    rows: int
    columns: int

    @property
    def name(self) -> str:
        """Name of the map: the reference with its size."""
        return f"{ONE}{self.kind}:{self.seed}:{self.rows}x{self.columns}"


def is_harbour(reference: str) -> bool:
    """True if a reference is of generated harbours, well formed or not, and not of a file."""
    return reference.startswith((ONE, MANY))


def is_family(reference: str) -> bool:
    """True if a reference is of several generated harbours."""
    return reference.startswith(MANY)


def harbour(reference: str) -> Harbour:
    """The harbour that a reference names.

    Raises `UserError` if it is not well formed, or names a family.
    """
    if is_family(reference):
        first = family(reference)[0]
        raise UserError(
            f"map {reference!r}: several maps, which only `maps`, batches of Foraging-v0 (make_vec "
            "without vectorization_mode) and trainings take (in also and evaluate, as "
            f"SCENARIO:{reference}); give one, such as {first}"
        )
    kind, seed, size, *more = [*reference.removeprefix(ONE).split(":"), "", ""]
    number, sides = _whole(seed), [_whole(side) or 0 for side in size.split("x")]
    if kind not in KINDS:
        fault = f"no kind {kind!r}"
    elif number is None:
        fault = f"seed {seed!r} is not 0 to 2^63 - 1"
    elif any(more):
        fault = "too many parts"
    elif not size and reference.count(":") == ONE.count(":") + 1:
        return Harbour(kind, number, *_drawn_size(_key(kind, number)))
    elif len(sides) != 2 or not all(LEAST <= side <= MOST for side in sides):
        fault = f"size {size!r}"
    else:
        return Harbour(kind, number, sides[0], sides[1])
    raise UserError(f"map {reference!r}: {fault}; give {_FORMS}")


def family(reference: str) -> list[str]:
    """References of a family's harbours, one of each seed: all of its kind, or the kinds in turn.

    Raises `UserError` if it is not [KIND:]FIRST-LAST in ascending order, names too many, or no
    kind.
    """
    kind, _, seeds = reference.removeprefix(MANY).rpartition(":")
    first, _, last = seeds.partition("-")
    low, high = _whole(first), _whole(last)
    if low is None or high is None or not low <= high < low + MOST_OF_A_FAMILY:
        raise UserError(
            f"map {reference!r}: expected harbours:FIRST-LAST or harbours:KIND:FIRST-LAST, seeds "
            f"in ascending order and at most {MOST_OF_A_FAMILY} of them, such as harbours:0-39"
        )
    if kind and kind not in KINDS:
        raise UserError(f"map {reference!r}: no kind {kind!r}; give one of {', '.join(KINDS)}")
    kinds = [kind] if kind else list(KINDS)
    return [f"{ONE}{kinds[seed % len(kinds)]}:{seed}" for seed in range(low, high + 1)]


@lru_cache(maxsize=16)
def harbour_cells(which: Harbour) -> Cells:
    """Draw a harbour: (row, column) bool, read-only, water True.

    All water is one part for a vessel of 2 x 2 cells: no passage is narrower than two, diagonal
    steps are never needed, and there are no pools.
    """
    key, shape = _key(which.kind, which.seed), (which.rows, which.columns)
    turned = drawn(key, Draw.TURN, 0, 0, 1)
    cells = KINDS[which.kind](key, *(shape[::-1] if turned else shape))
    cells = cells.T if turned else cells
    for axis in (0, 1):
        cells = np.flip(cells, axis) if drawn(key, Draw.TURN, 1 + axis, 0, 1) else cells
    return read_only(_roomy(cells))


def _roomy(water: Cells) -> Cells:
    """The largest part of the water that a square of 2 x 2 cells can sweep, one step at a time."""
    squares = water[1:, 1:] & water[1:, :-1] & water[:-1, 1:] & water[:-1, :-1]
    label, _ = ndimage.label(squares)
    swept = label == 1 + np.bincount(label[squares])[1:].argmax()
    water_left = np.zeros_like(water, order="C")
    for down in (0, 1):
        for right in (0, 1):
            water_left[down : down + swept.shape[0], right : right + swept.shape[1]] |= swept
    return water_left


def _drawn_size(key: np.uint64) -> tuple[int, int]:
    """Rows and columns of at most `CELLS` cells."""
    rows = drawn(key, Draw.SIZE, 0, LEAST, MOST)
    return rows, drawn(key, Draw.SIZE, 1, LEAST, min(MOST, CELLS // rows))


def _key(kind: str, seed: int) -> np.uint64:
    number = np.array([list(KINDS).index(kind)])
    return np.uint64(stream_key(episode_keys(seed, number)[0], Stream.HARBOUR))


def _whole(text: str) -> int | None:
    """The number that a text is, in plain digits; None for anything else."""
    number = int(text) if text.isascii() and text.isdigit() and len(text) < 20 else _BELOW
    return number if number < _BELOW else None
