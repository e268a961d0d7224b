"""Distance of every node to the nearest known item, found again only where others are known."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined, kernel
from mjforage.graph_planner.encodings.codes import Codes, nearest_by_code
from mjforage.graph_planner.encodings.encoder import TOP, Levels
from mjforage.graph_planner.graph.geodesics import FAR, Float32Array, Int32Array, Workspace, spread

MOST_ROWS = 300  # of codes that are compared; beyond it a search is quicker
WAY_LEVELS = 2.0  # levels per node of distance: 0 from 127.5 nodes on


class ItemWays(NamedTuple):
    """Distances, and what they were found from: they stand as long as that is the same."""

    distance: Float32Array  # (row, node) to the nearest known item [node], or inf
    level: Levels  # (row, node) the same as levels
    known: Int32Array  # (row, MOST_ROWS) the nodes with items
    size: Int32Array  # (row,) how many; -1 if nothing stands

    @classmethod
    def none_yet(cls, rows: int, nodes: int) -> "ItemWays":
        """Empty ways of so many rows, on a map of so many nodes."""
        return cls(
            np.zeros((rows, nodes), np.float32),
            np.zeros((rows, nodes), np.uint8),
            np.zeros((rows, MOST_ROWS), np.int32),
            np.full(rows, -1, np.int32),
        )


@inlined
def way_level(distance: float) -> np.int32:
    """Level of a distance [node]: less the farther, 0 where there is no way."""
    level = TOP - WAY_LEVELS * distance
    return np.int32(level if level > 0.0 else 0.0)


@kernel
def _measure_ways(
    neighbours: Int32Array,
    codes: Codes,
    known: Int32Array,
    workspace: Workspace,
    nearest: NDArray[np.uint16],
    way: Float32Array,
) -> None:
    """Distance of every node to the nearest known item: by their codes, or by a search."""
    if codes.code.shape[0] > 0 and known.size <= MOST_ROWS:
        nearest_by_code(codes, known, nearest, way)
        return
    way[:] = np.float32(np.inf)
    distance, touched = workspace.distance, workspace.touched
    count = spread(neighbours, known, 0, workspace)
    for i in range(count):
        way[touched[i]] = np.float32(distance[touched[i]])
        distance[touched[i]] = FAR


@kernel
def _stand(known: Int32Array, before: Int32Array) -> bool:
    """True if both lists (place,) are the same."""
    same = True
    for i in range(known.size):
        same &= known[i] == before[i]
    return same


@kernel
def find_ways(
    e: int,
    known: Int32Array,
    neighbours: Int32Array,
    codes: Codes,
    workspace: Workspace,
    nearest: NDArray[np.uint16],
    ways: ItemWays,
) -> None:
    """Bring row e of the distances up to date.

    Parameters
    ----------
    known : (place,) nodes with items
    neighbours, codes : (node, 8), and of distances. Always of the same map
    nearest : (node,) memory
    """
    distance, level, before, size = ways.distance, ways.level, ways.known, ways.size
    if size[e] == known.size and _stand(known, before[e]):
        return
    _measure_ways(neighbours, codes, known, workspace, nearest, distance[e])
    for node in range(level.shape[1]):
        level[e, node] = way_level(np.float64(distance[e, node]))
    size[e] = known.size if known.size <= MOST_ROWS else -1
    for i in range(size[e]):
        before[e, i] = known[i]
