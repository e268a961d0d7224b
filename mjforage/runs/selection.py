"""The selection of episodes that are recorded, of every world and policy."""

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.references import file_label

RANKS = ("first", "median", "worst", "best")
"""Episodes that are known by what came out, each of one world and policy."""
USUAL: tuple[str | int, ...] = ("first", "median", "worst")
"""Episodes that evaluate and compare record by default."""
FIRST: tuple[str | int, ...] = ("first",)
"""Episodes that the runs of a study record, except the first run, which records `USUAL`."""
_HOW = f"give episodes' numbers, or {', '.join(RANKS)}"


def parse_selection(text: str) -> tuple[str | int, ...]:
    """Read a list such as `0,3,worst`; `none` is an empty one.

    Raises `UserError`, naming the word that is neither a number nor a rank.
    """
    words = [word.strip() for word in text.split(",")]
    if words == ["none"]:
        return ()
    for word in words:
        if word not in RANKS and not (word.isascii() and word.isdigit()):
            raise UserError(f"--replay {text}: '{word}' names no episode; {_HOW}, or none alone")
    return tuple(dict.fromkeys(word if word in RANKS else int(word) for word in words))


def check_selection(selection: Iterable[str | int], episodes: int) -> tuple[str | int, ...]:
    """The selection without duplicates; the run must have these episodes.

    Raises `UserError` if it has not.
    """
    found = tuple(dict.fromkeys(selection))
    for one in found:
        if isinstance(one, int) and not 0 <= one < episodes:
            raise UserError(
                f"recorded episode {one}: the run has episodes 0 to {episodes - 1} of every world "
                "and policy; name one of them"
            )
        if isinstance(one, str) and one not in RANKS:
            raise UserError(f"recorded episode {one}: is none; {_HOW}")
    return found


def ranks_of(pta_c: NDArray[np.float64], length: NDArray[np.float64]) -> dict[str, int]:
    """Rank -> episode of one world and policy: least collected is worst.

    Of episodes that collected equally, more decisions are worse, then the lower number. Of an even
    number of episodes the median is the worse of the two in the middle.

    Parameters
    ----------
    pta_c : (episode,) share of the items collected in the end [%]
    length : (episode,) decisions made
    """
    order = np.lexsort((np.arange(len(pta_c)), -length, pta_c)).tolist()
    return {
        "first": 0,
        "median": order[(len(order) - 1) // 2],
        "worst": order[0],
        "best": order[-1],
    }


def selected(selection: Sequence[str | int], ranks: dict[str, int]) -> tuple[int, ...]:
    """Numbers of the episodes, once it is known which episode has which rank."""
    return tuple(sorted({ranks[one] if isinstance(one, str) else one for one in selection}))


def recording_file(folder: Path, world: str, policy: str, episode: int) -> Path:
    """File of a recorded episode."""
    return folder / "replay" / f"{world}-{file_label(policy)}-{episode}.npz"


def recording_files(folder: Path, world: str, policy: str) -> dict[int, Path]:
    """Episode -> file of the recorded episodes of one world and policy, in their order."""
    prefix = f"{world}-{file_label(policy)}-"
    found = {
        path.stem.removeprefix(prefix): path
        for path in (folder / "replay").glob("*.npz")
        if path.stem.startswith(prefix)
    }
    numbers = sorted(int(one) for one in found if one.isascii() and one.isdigit())
    return {number: found[str(number)] for number in numbers if str(number) in found}
