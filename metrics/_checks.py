"""Array types, and the checks on arguments that several metrics share."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


def first(mask: BoolArray) -> tuple[int, ...]:
    """Index of the first True, as plain integers for an error message."""
    return tuple(int(i) for i in np.argwhere(mask)[0])


def whole_steps(horizon: int) -> int:
    """Give back `horizon` [step], or raise ValueError when it is below 1."""
    if horizon < 1:
        raise ValueError(f"horizon {horizon}: a whole number of steps, at least 1, is needed")
    return horizon


def agent_indices(agents: ArrayLike, name: str) -> IntArray:
    """Distinct agent indices (agent,) of a team; may be empty. Raises ValueError."""
    given = np.asarray(agents)
    if given.size == 0:
        return np.zeros(0, dtype=np.int64)
    if given.ndim != 1 or given.dtype.kind not in "iu":
        raise ValueError(f"{name} {agents!r}: a flat sequence of agent indices is needed")
    if given.min() < 0:
        raise ValueError(f"{name}: agent {given.min()} is negative; indices start at 0")
    if np.unique(given).size != given.size:
        raise ValueError(f"{name} {given.tolist()}: an agent is listed twice; list each once")
    return given.astype(np.int64)


def same_shape(name_a: str, a: NDArray[np.generic], name_b: str, b: NDArray[np.generic]) -> None:
    """Raise ValueError when two arrays that belong together differ in shape."""
    if a.shape != b.shape:
        raise ValueError(
            f"{name_a} has shape {a.shape} but {name_b} {b.shape}; give both the same shape"
        )


def ratio(numerator: ArrayLike, denominator: ArrayLike) -> FloatArray:
    """Divide elementwise; NaN where the denominator is 0."""
    top, bottom = np.broadcast_arrays(
        np.asarray(numerator, dtype=np.float64), np.asarray(denominator, dtype=np.float64)
    )
    quotient = np.full(top.shape, np.nan)
    np.divide(top, bottom, out=quotient, where=bottom != 0)
    return quotient
