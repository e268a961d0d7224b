"""Arguments of a caller, checked: of another type or out of range, each is refused in a line."""

import os
import reprlib
from collections.abc import Collection, Mapping, Sequence
from math import inf
from pathlib import Path
from typing import Any, cast, get_args

import numpy as np

from mjforage.base.errors import UserError
from mjforage.base.references import nearest
from mjforage.graph_planner.graph.navigation import COMPASS
from mjforage.physics.worlds import WORLDS, World
from mjforage.runs.resuming import Resume

Named = str | os.PathLike[str]


def whole(name: str, value: object, least: float = -inf, most: float = inf) -> int:
    """A whole number, of Python or numpy.

    Raises `TypeError` if it is none; `UserError` if it is below `least` or above `most`.
    """
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        raise TypeError(f"{name} is {type(value).__name__}; give a whole number")
    if not least <= value <= most:
        upper = "or more" if most == inf else f"to {most}"
        raise UserError(f"{name} {value}: give {least} {upper}")
    return int(value)


def real(name: str, value: object, above: float = -inf) -> float:
    """A finite number; raises as `whole`, `above` itself being too low."""
    if isinstance(value, bool) or not isinstance(value, int | float | np.number):
        raise TypeError(f"{name} is {type(value).__name__}; give a number")
    if not above < float(value) < inf:
        low = f" above {above:g}" if above > -inf else ""
        raise UserError(f"{name} = {value!r}: give a finite number{low}")
    return float(value)


def text(name: str, value: object) -> str:
    """A text; raises `TypeError` for anything else."""
    if not isinstance(value, str):
        raise TypeError(f"{name} is {type(value).__name__}; give a name")
    return value


def label(name: str, value: object) -> str:
    """A text to be read on one line; raises `TypeError` or `UserError` for anything else."""
    if not text(name, value).isprintable() or not text(name, value).strip():
        raise UserError(f"{name} {value!r}: give letters, digits and dashes")
    return text(name, value)


def texts(name: str, value: object) -> tuple[str, ...]:
    """Texts of a list, or one text; raises `TypeError` for anything else."""
    several = [value] if isinstance(value, str) else value
    if not isinstance(several, Sequence) or not all(isinstance(one, str) for one in several):
        raise TypeError(f"{name} is {reprlib.repr(value)}; give a list of names")
    return tuple(several)


def one_of(name: str, value: object, known: Collection[str]) -> str:
    """One of the known names; raises `UserError` for another."""
    if not isinstance(value, str) or value not in known:
        raise UserError(f"{name} {value!r}: unknown; {nearest(str(value), known)}")
    return value


def path(name: str, value: object) -> Path:
    """A path; raises `TypeError` for anything else."""
    if not isinstance(value, str | os.PathLike):
        raise TypeError(f"{name} is {type(value).__name__}; give a path")
    return Path(value)


def values(name: str, given: object) -> dict[str, Any]:
    """Values by name, of a dict or None; raises `TypeError` for anything else."""
    found = {} if given is None else given
    if not isinstance(found, Mapping) or not all(isinstance(one, str) for one in found):
        raise TypeError(f"{name} is {reprlib.repr(given)}; give a dict of name -> value")
    return dict(found)


def function(name: str, value: object) -> None:
    """Check a function; raises `TypeError` for anything else."""
    if not callable(value):
        raise TypeError(f"{name} is {type(value).__name__}; give a function")


def check_play(
    episodes: object,
    seed: object,
    jobs: object,
    scheduler: object,
    resume: object,
    progress: object,
) -> None:
    """Check the arguments of every call that plays episodes; raises `TypeError` or `UserError`."""
    whole("episodes", episodes, 1, 2**63 - 1)
    whole("seed", seed, 0, 2**64 - 1)
    whole("jobs", jobs, 1)
    text("scheduler", scheduler)
    check_resume(resume)
    check_progress(progress)


def check_progress(progress: object) -> None:
    """Check what is to show progress; raises `TypeError`."""
    if not (progress is None or isinstance(progress, bool) or callable(progress)):
        raise TypeError(f"progress is {type(progress).__name__}; give True, False or a function")


def check_resume(resume: object) -> None:
    """Check what is to be done with what a folder holds; raises `UserError`."""
    if resume not in get_args(Resume):
        raise UserError(f"resume {resume!r}: choose {', '.join(get_args(Resume))}")


def check_worlds(world: object) -> tuple[World, ...]:
    """Names of worlds, of one or several; raises `UserError` for anything else."""
    several = (world,) if isinstance(world, str) else world
    if not isinstance(several, Sequence) or not several:
        raise UserError(f"world {world!r}: give one of {', '.join(WORLDS)}, or several in a list")
    return tuple(cast("World", one_of("world", one, WORLDS)) for one in several)


def move_number(move: object, who: str, agent: str) -> int:
    """Number 0-8 of a move by its name or number; raises `UserError` for another."""
    if isinstance(move, str) and move in COMPASS:
        return COMPASS.index(move)
    if isinstance(move, int | np.integer) and not isinstance(move, bool) and 0 <= move < 9:
        return int(move)
    raise UserError(
        f"{who}: gave {move!r} for {agent}; give one of {', '.join(COMPASS)}, 0 to 8 in that "
        "order, or None"
    )
