"""Gymnasium spaces of what agents see, and the step from levels to values."""

from typing import Any, TypeAlias, cast

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from graph_planner.encodings.encoder import TOP, Shapes

Pictures: TypeAlias = dict[str, NDArray[Any]]

MASK = "action_mask"
_SCALE = np.float32(1.0 / TOP)


def picture_space(shapes: Shapes, lead: tuple[int, ...] = ()) -> spaces.Space[Pictures]:
    """Space of one agent's arrays, or of several in leading axes, with their action masks.

    Values are float32 in [0, 1]; masks are int8, 1 where a move is legal.
    """
    boxes: dict[str, spaces.Space[NDArray[Any]]] = {
        name: spaces.Box(0.0, 1.0, (*lead, *shape), np.float32) for name, shape in shapes.items()
    }
    space = spaces.Dict({**boxes, MASK: spaces.Box(0, 1, (*lead, 9), np.int8)})
    return cast("spaces.Space[Pictures]", space)


def values(levels: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Levels 0-255 as values in [0, 1], in new memory."""
    return np.asarray(np.multiply(levels, _SCALE, dtype=np.float32))
