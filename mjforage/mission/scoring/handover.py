"""Handover: time until the discovery of an item reaches the collectors."""

import numpy as np
from numpy.typing import NDArray

from mjforage import metrics
from mjforage.base.compiled import kernel
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.mission.exchange import LinkLog
from mjforage.mission.scoring.known import metric
from mjforage.mission.scoring.metric import Batch, FloatArray, Metric

NOBODY = int(np.iinfo(np.int64).max)  # step at which nobody receives


@kernel
def _received_by(
    received_at: NDArray[np.int16], listeners: NDArray[np.int64], a: int, s: int
) -> int:
    """Step at which the first of some agents receives a scan; of one episode."""
    first = NOBODY
    for h in listeners:
        if 0 <= received_at[h, a, s] < first:
            first = int(received_at[h, a, s])
    return first


@kernel
def _shows(link: LinkLog, e: int, s: int, a: int, node: int) -> bool:
    """True if agent a's scan at step s shows items in a node."""
    viewer, radius = link.scans.node[e, s, a], link.radius_number[a]
    first, nodes = link.views.start[radius, viewer], link.views.nodes
    for i in range(first, link.views.start[radius, viewer + 1]):
        if nodes[i] == node:
            return bool(link.scans.shown[e, s, a, i - first] > 0)
    return False


@kernel
def first_received(
    link: LinkLog,
    listeners: NDArray[np.int64],
    item_node: Int32Array,
    t_discovered: NDArray[np.int16],
    length: Int32Array,
) -> NDArray[np.int64]:
    """First steps in which listeners receive a scan, made since an item's discovery, that shows it.

    Returns: (episode, item) [step], -1 never.

    Parameters
    ----------
    listeners : (listener,) agents
    item_node : (episode, step, item) where each is, -1 nowhere
    t_discovered : (episode, item) [step], -1 never
    length : (episode,) last step
    """
    received = np.full(t_discovered.shape, -1, np.int64)
    for e in range(length.size):
        for k in range(t_discovered.shape[1]):
            if t_discovered[e, k] < 0:
                continue
            best = int(length[e]) + 1
            for s in range(t_discovered[e, k], length[e] + 1):
                if s >= best:  # nothing is received before it is seen
                    break
                if item_node[e, s, k] < 0:
                    continue
                for a in range(link.radius_number.size):
                    at = _received_by(link.received_at[e], listeners, a, s)
                    if at < best and _shows(link, e, s, a, item_node[e, s, k]):
                        best = at
            if best <= length[e]:
                received[e, k] = best
    return received


@metric
class Handover(Metric):
    """Steps from an item's discovery until a collector has received a scan, made since, that shows
    items in its node, or has taken it, over T; mean over the items discovered, never = T.

    `docs/concepts/metrics.md`. Undefined without a link.
    """

    key, label, better, top = "handover", "Handover", -1, None
    least, most = 0.0, 1.0

    def value(self, batch: Batch) -> FloatArray:
        """(episode,) [of T]."""
        log, events = batch.log, batch.events
        if log.link is None:
            return np.full(log.length.size, np.nan)
        listeners = batch.fleet.collectors
        about = log.item_node, log.t_discovered, log.length
        steps = first_received(log.link, listeners, *about)
        received = np.where(steps < 0, metrics.NEVER, steps)
        known = np.fmin(received, events.collected_at)
        return metrics.handover(events.discovered_at, known, batch.horizon)
