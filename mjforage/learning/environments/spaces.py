"""Gymnasium spaces of what agents see, and the step from levels to values."""

from typing import Any, TypeAlias, cast

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.graph_planner.encodings.encoder import TOP, Shapes

Arrays: TypeAlias = dict[str, NDArray[Any]]

MASK = "action_mask"
DTYPES = ("float32", "uint8")
"""Types of an observation's arrays: values in [0, 1], or levels of 1 / 255."""
_SCALE = np.float32(1.0 / TOP)


def arrays_space(
    shapes: Shapes, lead: tuple[int, ...] = (), dtype: str = DTYPES[0]
) -> spaces.Space[Arrays]:
    """Space of one agent's arrays, or of several in leading axes, with their action masks.

    Values are float32 in [0, 1], or levels uint8 of 0 to 255; masks are int8, 1 where a move is
    legal.
    """
    high, kind = (1.0, np.float32) if dtype == "float32" else (TOP, np.uint8)
    boxes: dict[str, spaces.Space[NDArray[Any]]] = {
        name: spaces.Box(0, high, (*lead, *shape), kind) for name, shape in shapes.items()
    }
    space = spaces.Dict({**boxes, MASK: spaces.Box(0, 1, (*lead, 9), np.int8)})
    return cast("spaces.Space[Arrays]", space)


@kernel
def _scale(levels: NDArray[np.uint8], out: NDArray[np.float32]) -> None:
    """Levels (entry,) as values."""
    for i in range(levels.size):
        out[i] = np.float32(levels[i]) * _SCALE


def values(
    levels: NDArray[np.uint8], out: NDArray[np.float32] | None = None
) -> NDArray[np.float32]:
    """Levels 0-255 as values in [0, 1], in new memory or in some of their shape."""
    found = np.empty(levels.shape, np.float32) if out is None else out
    _scale(np.ascontiguousarray(levels).reshape(-1), found.reshape(-1))
    return found


def shown(levels: NDArray[np.uint8], dtype: str) -> NDArray[Any]:
    """Levels as an observation of one of `DTYPES`, in new memory."""
    return values(levels) if dtype == "float32" else levels.copy()
