"""True states of the items and their history: place, first discovery and collection.

Metrics and bounds read it; policies never do. Order in a step (definitions, section 1): discretise
to counts per node; agents scan; first discoveries are credited at the scan, whichever owner
receives it, and a tie goes to an agent that does not collect.
"""

from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.rows import scatter_rows
from mjforage.base.views import ReadOnlyViews
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.mission.initial_state import item_places
from mjforage.mission.knowledge import Knowledge, Scans
from mjforage.mission.task import Task


class Entries(NamedTuple):
    """The arrays of a ledger. Steps are -1 for never, agents -1 for none."""

    places: NDArray[np.int64]  # (episode,) see `item_places`
    truth: NDArray[np.int16]  # (episode, node) items
    counted_node: Int32Array  # (episode, item) node in which `truth` counts it, -1 not at all
    t_discovered: NDArray[np.int16]  # (episode, item) [step]
    discovered_by: NDArray[np.int16]  # (episode, item) agent
    t_collected: NDArray[np.int16]  # (episode, item) [step]
    collected_by: NDArray[np.int16]  # (episode, item) agent


@kernel
def count(
    active: NDArray[np.bool_],
    step: Int32Array,
    item_node: Int32Array,
    taken_by: NDArray[np.int16],
    entries: Entries,
) -> None:
    """Discretise to counts, and note collections; an item collected unseen counts as discovered.

    Parameters
    ----------
    item_node : (episode, item) node of each item, -1 once removed
    taken_by : (episode, item) agent that removed it, -1 none
    """
    places, truth, counted_node = entries.places, entries.truth, entries.counted_node
    t_discovered, discovered_by = entries.t_discovered, entries.discovered_by
    t_collected, collected_by = entries.t_collected, entries.collected_by
    for e in range(active.size):
        if not active[e]:
            continue
        for k in range(places[e]):
            before, after = counted_node[e, k], item_node[e, k]
            if before == after:
                continue
            counted_node[e, k] = after
            if before >= 0:
                truth[e, before] -= 1
            if after >= 0:
                truth[e, after] += 1
            elif taken_by[e, k] >= 0 and t_collected[e, k] < 0:
                t_collected[e, k], collected_by[e, k] = step[e], taken_by[e, k]
                if t_discovered[e, k] < 0:
                    t_discovered[e, k], discovered_by[e, k] = step[e], taken_by[e, k]


@kernel
def credit(
    scans: Scans,
    knowledge: Knowledge,
    credit_order: NDArray[np.int64],
    views: NodeLists,
    radius_number: NDArray[np.int64],
    in_view: NDArray[np.bool_],
    found: Int32Array,
    entries: Entries,
) -> None:
    """Credit each item's first sighting to the first agent in order that has it in view.

    Parameters
    ----------
    knowledge : common knowledge, with all scans of this step, one row per episode
    in_view : (node,) memory, all False before and after
    found : (item,) memory
    """
    active, step, agent_node = scans.active, scans.step, scans.agent_node
    known, n_known, last_seen = knowledge.known, knowledge.n_known, knowledge.last_seen
    start, nodes, counted_node = views.start, views.nodes, entries.counted_node
    places = entries.places
    t_discovered, discovered_by = entries.t_discovered, entries.discovered_by
    for e in range(active.size):
        if not active[e]:
            continue
        now, any_in_view = step[e], False
        for i in range(n_known[e]):  # all nodes in view that hold an item are among them
            node = np.uint64(known[e, i])  # unsigned: an index that never counts from the end
            if last_seen[e, node] == now:
                in_view[node] = any_in_view = True
        if not any_in_view:
            continue
        n_found = 0
        for k in range(places[e]):  # without a branch: which items are new is a coin toss
            item = counted_node[e, k]
            found[n_found] = k
            n_found += in_view[np.uint64(max(item, 0))] & (item >= 0) & (t_discovered[e, k] < 0)
        for j in range(n_found):
            k_found = np.uint64(found[j])
            t_discovered[e, k_found] = now
            for agent in credit_order:
                radius, viewer = radius_number[agent], agent_node[e, agent]
                for i in range(start[radius, viewer], start[radius, viewer + 1]):
                    if nodes[i] == counted_node[e, k_found] and discovered_by[e, k_found] < 0:
                        discovered_by[e, k_found] = agent
        for i in range(n_known[e]):
            in_view[np.uint64(known[e, i])] = False


class Ledger(ReadOnlyViews):
    """The ledger of a batch of episodes; `SensingUpdate` changes its arrays, see `Entries`."""

    entries: Entries
    _entries: Entries
    _shows: ClassVar = {"entries": "_entries"}

    def __init__(self, task: Task) -> None:
        self._nodes = len(task.graph)

    def open(self) -> Entries:
        """The arrays for the lookout, which alone writes to them."""
        return self._entries

    def reset(self, item_node: Int32Array) -> None:
        """Start a batch of episodes; the scan of step 0 comes next.

        Parameters
        ----------
        item_node : (episode, item) at step 0, -1 for padding
        """
        items, nodes = item_node.shape, (item_node.shape[0], self._nodes)
        entries = Entries(
            places=item_places(item_node),
            truth=np.zeros(nodes, np.int16),
            counted_node=np.full(items, -1, np.int32),
            t_discovered=np.full(items, -1, np.int16),
            discovered_by=np.full(items, -1, np.int16),
            t_collected=np.full(items, -1, np.int16),
            collected_by=np.full(items, -1, np.int16),
        )
        self._show("entries", entries)

    def replace_episodes(self, rows: NDArray[np.int64], other: "Ledger") -> None:
        """Replace episodes (row,) of the batch by those of another ledger."""
        mine, theirs = self._entries, other._entries
        mixed: dict[str, Any] = {  # `truth` is filled with 0, others with nobody, nowhere and never
            name: scatter_rows(
                getattr(mine, name), rows, getattr(theirs, name), (name == "truth") - 1
            )
            for name in mine._fields
        }
        self._show("entries", Entries(**mixed))
