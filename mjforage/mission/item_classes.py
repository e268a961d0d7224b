"""Classes of items, drawn per item, and their leeway."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.randomness import Stream, UInt64Array, stream_key, uniform
from mjforage.forcing import LEEWAY
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.scenario.debris import load_debris

_CLASS = 3  # step of a drawn class in the stream of items, away from the other draws
FloatArray = NDArray[np.float64]


@kernel
def draw_classes(
    keys: UInt64Array, item_node: Int32Array, choices: NDArray[np.int64]
) -> NDArray[np.int64]:
    """(episode, item) class of each item, one of `choices` with equal chances; -1 for padding."""
    result = np.full(item_node.shape, -1, np.int64)
    for e in range(keys.size):
        key = stream_key(keys[e], Stream.ITEMS)
        for k in range(item_node.shape[1]):
            if item_node[e, k] >= 0:
                result[e, k] = choices[int(uniform(key, k, _CLASS) * choices.size)]
    return result


def leeways(classes: NDArray[Any]) -> FloatArray:
    """(episode, item) leeway of items of some classes, the paper's where an item is no more."""
    known = np.array([kind.leeway for kind in load_debris()] + [LEEWAY])
    found: FloatArray = known[np.where(classes < 0, len(known) - 1, classes).astype(np.int64)]
    return found
