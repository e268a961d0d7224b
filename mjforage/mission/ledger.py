"""True states of the items and their history: place, first discovery and collection.

Metrics and bounds read it; policies never do. Order in a step (definitions, section 1): discretise
to counts per node; agents scan; first discoveries are credited at the scan, whichever owner
receives it, and a tie goes to an agent that does not collect.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.mission.initial_state import item_places
from mjforage.mission.knowledge import Knowledge, Scans


class Ledger(NamedTuple):
    """The ledger of a batch of episodes. Steps are -1 for never, agents -1 for none."""

    places: NDArray[np.int64]  # (episode,) see `item_places`
    truth: NDArray[np.int16]  # (episode, node) items
    counted_node: Int32Array  # (episode, item) node in which `truth` counts it, -1 not at all
    t_discovered: NDArray[np.int16]  # (episode, item) [step]
    discovered_by: NDArray[np.int16]  # (episode, item) agent
    t_collected: NDArray[np.int16]  # (episode, item) [step]
    collected_by: NDArray[np.int16]  # (episode, item) agent

    @classmethod
    def of(cls, item_node: Int32Array, nodes: int) -> "Ledger":
        """A ledger before the scan of step 0.

        `item_node`: (episode, item) at step 0, -1 for padding; `nodes`: of the map.
        """
        items = item_node.shape
        return cls(
            places=item_places(item_node),
            truth=np.zeros((items[0], nodes), np.int16),
            counted_node=np.full(items, -1, np.int32),
            t_discovered=np.full(items, -1, np.int16),
            discovered_by=np.full(items, -1, np.int16),
            t_collected=np.full(items, -1, np.int16),
            collected_by=np.full(items, -1, np.int16),
        )


@kernel
def count(
    active: NDArray[np.bool_],
    step: Int32Array,
    item_node: Int32Array,
    taken_by: NDArray[np.int16],
    ledger: Ledger,
) -> None:
    """Discretise to counts, and note collections; an item collected unseen counts as discovered.

    Parameters
    ----------
    item_node : (episode, item) node of each item, -1 once removed
    taken_by : (episode, item) agent that removed it, -1 none
    """
    places, truth, counted_node = ledger.places, ledger.truth, ledger.counted_node
    t_discovered, discovered_by = ledger.t_discovered, ledger.discovered_by
    t_collected, collected_by = ledger.t_collected, ledger.collected_by
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
    ledger: Ledger,
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
    start, nodes, counted_node = views.start, views.nodes, ledger.counted_node
    places = ledger.places
    t_discovered, discovered_by = ledger.t_discovered, ledger.discovered_by
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
