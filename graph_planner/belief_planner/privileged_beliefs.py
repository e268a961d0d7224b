"""Beliefs with the ground truth of all that was received: an oracle upper bound over a link.

An item that a scan has shown is known from then on to all that have received that scan: its place,
and whether it was collected. The drift is known with the first item. The rest is believed as usual.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.belief_planner.beliefs import Beliefs
from mjforage.graph_planner.belief_planner.settings import BeliefSettings
from mjforage.mission.task import GroundTruth, Observation, Task

UNREPORTED = np.int32(np.iinfo(np.int32).max)


class PrivilegedBeliefs(Beliefs):
    """Beliefs of a batch of rows, with true items in the place of tracks.

    Attributes
    ----------
    since : (row, item) step of the earliest scan received that shows its node with items, else
        `UNREPORTED`. Where scans miss some items of a node, or show one too many, all true items
        there count as shown.
    """

    def __init__(self, task: Task, settings: BeliefSettings, keys: UInt64Array) -> None:
        super().__init__(task, replace(settings, wind=False), keys)  # the drift is not estimated
        self.since = np.zeros((keys.size, 0), np.int32)

    def set_ground_truth(self, truth: GroundTruth) -> None:
        """Take in where the items are: a row for each row of the observation that comes next."""
        self._truth, items = truth, truth.item_node.shape
        if self.since.shape != items:
            self.since = np.full(items, UNREPORTED, np.int32)
            past = items[0], self._task.horizon + 1, items[1]
            self._past = np.full(past, -1, np.int32)  # (row, step, item) node

    def learn(self, seen: Observation, e: int) -> None:
        """Bring tracks and expectations of a row up to date."""
        now = int(seen.step[e]) - 1
        self._past[e, now] = self._truth.item_node[e]
        self._report(e, now, np.flatnonzero((seen.last_seen[e] == now) & (seen.belief[e] > 0)))
        views, radius_number = self._task.views, self._task.radius_number
        late = zip(seen.delayed_scans[e], seen.delayed_shown[e], strict=True)
        for (step, agent, node), shown in late:
            if step >= 0:
                nodes = views.of(node, int(radius_number[agent]))
                self._report(e, int(step), nodes[shown[: nodes.size] > 0])
        super().learn(seen, e)
        self._fill_tracks(e, now)

    def _report(self, e: int, step: int, nodes: NDArray[np.integer]) -> None:
        """Note the items of nodes that scans of a step have shown with items."""
        shown = np.isin(self._past[e, step], nodes)
        self.since[e, shown] = np.minimum(self.since[e, shown], step)

    def _fill_tracks(self, e: int, now: int) -> None:
        """Put the items that are known, and left, in the place of the tracks; and their drift."""
        truth, tracks, wind = self._truth, self.tracks, self.wind
        reported = self.since[e] != UNREPORTED
        items = np.flatnonzero(reported & (truth.item_node[e] >= 0))[: tracks.row.shape[1]]
        n, node = items.size, truth.item_node[e, items]
        tracks.number[e] = n
        tracks.row[e, :n], tracks.col[e, :n] = truth.item_rc[e, items].T
        tracks.node[e, :n] = tracks.seen_node[e, :n] = tracks.born_node[e, :n] = node
        tracks.real[e, :n] = 1.0
        tracks.born[e, :n], tracks.seen[e, :n] = self.since[e, items], now
        tracks.base[e, :n], tracks.base_node[e, :n] = now, node[:, None]
        if reported.any():
            drift = truth.drift_rc[e]
            wind.mean[e], wind.deviation[e], wind.chance[e] = drift, 0.0, 0.0
            nearest = np.abs(wind.grid - drift[:, None]).argmin(axis=1)
            wind.chance[e, [0, 1], nearest] = 1.0
