"""Checks of a user's actions, seeds and options, before anything is played."""

import reprlib
from collections.abc import Mapping, Sequence
from numbers import Integral
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.errors import UserError

OF_A_CHECKER = "options"
"""The option of `reset` that PettingZoo's own test of environments gives, and expects to work."""
RENDER_MODES = ["rgb_array"]
"""Modes of every class; in a window, Gymnasium itself shows these pictures (`human`)."""
MOVES = 9
"""Number of moves: 0-7 compass from north clockwise, 8 stay."""


@kernel
def _are_moves(numbers: NDArray[np.int64]) -> bool:
    """True if all of some numbers (number,) are those of moves."""
    are = True
    for number in numbers:
        are &= 0 <= number < MOVES
    return are


def checked_moves(
    actions: object, shape: tuple[int, ...], name: str = "action"
) -> NDArray[np.int64]:
    """Moves as integers of one type.

    Raises `UserError` if it has another shape, or holds anything but integers of 0 to 8.

    Parameters
    ----------
    actions : what was given
    shape : that it has to have
    name : name in messages
    """
    remedy = "give whole numbers, 0-7 for the compass from north clockwise or 8 to stay"
    moves = _array(actions, shape, name, remedy)
    if moves.dtype.kind not in "iu":
        raise UserError(f"{name} = {reprlib.repr(moves.tolist())}: {remedy}")
    whole = moves.astype(np.int64)
    if not _are_moves(whole.reshape(-1)):
        first = np.argwhere((moves < 0) | (moves >= MOVES))[0]
        raise UserError(f"{_entry(name, first)} = {moves[tuple(first)]}: {remedy}")
    return whole


def checked_thrusts(action: object) -> NDArray[np.float64]:
    """(2,) commands of port and starboard, cut off at -1 and 1.

    Raises `UserError` if these are not two finite numbers.
    """
    remedy = "give two finite numbers, port and starboard, -1 full astern to 1 full ahead"
    thrusts = _array(action, (2,), "action", remedy)
    if thrusts.dtype.kind not in "iuf" or not np.isfinite(thrusts).all():
        raise UserError(f"action = {reprlib.repr(thrusts.tolist())}: {remedy}")
    return np.clip(thrusts.astype(np.float64), -1.0, 1.0)


def checked_seed(seed: object, name: str = "seed") -> int | None:
    """A seed as a Python integer; None stays None.

    Raises `UserError` if it is no integer of 0 <= seed < 2**64.
    """
    if seed is None:
        return None
    if not isinstance(seed, Integral) or not 0 <= int(seed) < 1 << 64:
        raise UserError(f"{name} = {seed!r}: give a whole number from 0 to below 2**64, or None")
    return int(seed)


def checked_options(options: object, known: tuple[str, ...] = ()) -> Mapping[str, Any]:
    """Options of `reset`.

    Raises `UserError` if it is no mapping, or has a key that is not known.
    """
    if options is None:
        return {}
    remedy = f"give {' and '.join(known)}" if known else "leave it out: a seed decides an episode"
    if not isinstance(options, Mapping):
        raise UserError(f"reset(options={reprlib.repr(options)}): is no mapping; {remedy}")
    for key in options:
        if key not in (*known, OF_A_CHECKER):
            raise UserError(f"reset(options={{{key!r}: ...}}): there is no such option; {remedy}")
    return options


def check_mode(mode: object) -> None:
    """Refuse a render mode that does not exist. Raises `UserError` if so."""
    if mode not in (None, *RENDER_MODES):
        raise UserError(f"render_mode = {mode!r}: unknown; choose None, {', '.join(RENDER_MODES)}")


def check_count(number: object, name: str) -> None:
    """Refuse a number, of threads or environments, that is none. Raises `UserError` if so."""
    if not isinstance(number, Integral) or isinstance(number, bool) or number < 1:
        raise UserError(f"{name} = {number!r}: give a whole number from 1 on")


def checked_started(started: bool, what: str) -> None:
    """Raise `UserError` if no episode has begun."""
    if not started:
        raise UserError(f"{what} before the first reset: no episode has begun; call reset first")


def checked_mode(mode: object) -> AutoresetMode:
    """The mode by which environments begin anew; raises `UserError` if it is none."""
    try:
        return AutoresetMode(mode)
    except ValueError as error:
        names = ", ".join(each.value for each in AutoresetMode)
        raise UserError(f"autoreset_mode = {mode!r}: unknown; choose {names}") from error


def env_seeds(seed: object, envs: int) -> list[int | None]:
    """A seed for each environment of a batch: one and those after it, one for each, or None.

    Raises `UserError` if it is neither.
    """
    if seed is None:
        return [None] * envs
    if isinstance(seed, Integral):
        return [checked_seed(int(seed) + i) for i in range(envs)]
    if not isinstance(seed, Sequence | np.ndarray) or len(seed) != envs:
        words = f"give one whole number, or {envs} of them"
        raise UserError(f"seed = {reprlib.repr(seed)}: {words}")
    return [checked_seed(each, f"seed[{i}]") for i, each in enumerate(seed)]


def chosen_envs(mask: object, envs: int, started: bool) -> NDArray[np.intp]:
    """Numbers of the environments that a mask (env,) names, of None all.

    Raises `UserError` if it is no mask, or leaves some out before the first reset of all.
    """
    if mask is None:
        return np.arange(envs)
    selected = np.asarray(mask)
    if selected.shape != (envs,) or selected.dtype != np.bool_ or not selected.any():
        words = f"give {envs} booleans, at least one of them True"
        raise UserError(f"reset_mask = {reprlib.repr(mask)}: {words}")
    if not selected.all():
        checked_started(started, "reset of some sub-environments")
    return np.flatnonzero(selected)


def _array(value: object, shape: tuple[int, ...], name: str, remedy: str) -> NDArray[Any]:
    try:
        array = np.asarray(value)
    except (TypeError, ValueError) as error:
        raise UserError(f"{name}: is no array ({error}); {remedy}") from error
    if array.shape != shape:
        raise UserError(f"{name}: has shape {array.shape}, expected {shape}; {remedy}")
    return array


def _entry(name: str, index: NDArray[np.int64]) -> str:
    return f"{name}[{', '.join(map(str, index))}]" if index.size else name
