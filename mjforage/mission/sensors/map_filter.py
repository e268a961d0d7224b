"""A map that weighs all scans: items expected in every node, and of those the nearest whole number.

Where scans miss items or show false positives, the last count is not the best guess. Every owner
keeps the items expected in each node. All scans of a step correct them once, by the best chance and
the largest count, because they detect or miss an item together. A delayed scan makes the filter
start again from the first.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.rows import put_rows
from mjforage.base.wholes import floor
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.mission.knowledge import Knowledge, believe
from mjforage.mission.sensors.detection import corrected
from mjforage.mission.task import NEVER

NOT_SEEN = -1


class MapFilter(NamedTuple):
    """Maps of a batch; of size 0 where the last count is believed."""

    density: NDArray[np.float64]  # (row, node) items expected
    chance: NDArray[np.float64]  # (square,) to detect one, by squared distance
    false_rate: float  # items per node and step that are seen and are none
    prior: float  # items expected in a node before any scan
    views: NodeLists
    radius_number: NDArray[np.int64]  # (agent,)
    rows: Int32Array  # (node,)
    cols: Int32Array
    counted: NDArray[np.int16]  # (node,) memory: largest count of the step's scans, `NOT_SEEN`
    best: NDArray[np.float64]  # (node,) memory: largest chance of them

    def with_rows(self, rows: NDArray[np.int64], other: "MapFilter") -> "MapFilter":
        """With rows (row,) of another, in its order, as `put_rows`."""
        if not self.density.shape[0]:
            return self
        return self._replace(density=put_rows(self.density, rows, other.density))


@kernel
def add_scan(filtered: MapFilter, agent: int, viewer: int, shown: NDArray[np.int16]) -> None:
    """Add a scan to those of the step at hand.

    Parameters
    ----------
    agent, viewer : whose scan, and the node where it was made
    shown : (place,) items in the nodes of its list, negative where it did not scan
    """
    radius = filtered.radius_number[agent]
    first, nodes = filtered.views.start[radius, viewer], filtered.views.nodes
    rows, cols, counted, best = filtered.rows, filtered.cols, filtered.counted, filtered.best
    for i in range(first, filtered.views.start[radius, viewer + 1]):
        node, items = nodes[i], shown[i - first]
        if items < 0:
            continue
        down, right = rows[node] - rows[viewer], cols[node] - cols[viewer]
        chance = filtered.chance[down * down + right * right]
        known = counted[node] != NOT_SEEN
        best[node] = max(best[node], chance) if known else chance
        counted[node] = max(counted[node], items)


@kernel
def correct(filtered: MapFilter, row: int) -> None:
    """Correct a row's map by the scans of the step at hand, which is then over."""
    counted, density = filtered.counted, filtered.density
    for node in range(counted.size):
        if counted[node] != NOT_SEEN:
            before, chance = density[row, node], filtered.best[node]
            density[row, node] = corrected(before, chance, filtered.false_rate, counted[node])
            counted[node] = NOT_SEEN


@kernel
def round_off(filtered: MapFilter, row: int, knowledge: Knowledge) -> None:
    """Believe in the nearest whole number of items, halves up, in every node that was seen."""
    density, belief, last_seen = filtered.density, knowledge.belief, knowledge.last_seen
    known, known_at, n_known = knowledge.known, knowledge.known_at, knowledge.n_known
    for node in range(density.shape[1]):
        items = floor(density[row, node] + 0.5)
        if last_seen[row, node] != NEVER and belief[row, node] != items:
            believe(belief, known, known_at, n_known, row, np.uint64(node), items)
