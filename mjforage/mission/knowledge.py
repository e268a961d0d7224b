"""Knowledge: last sight of each node with its step, and each agent's node at its last scan.

A row is what one belief owner of one episode knows: the scans that it has received, and nothing
else. With ideal communication an episode has one owner, and what it knows all agents know.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined, kernel
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.mission.task import NEVER


class Scans(NamedTuple):
    """Scans and states of all agents at the end of a step. Live views."""

    active: NDArray[np.bool_]  # (episode,) whose step it was; nobody scans in the others
    step: Int32Array  # (episode,)
    agent_node: Int32Array  # (episode, agent) from where each scans
    sighted: NDArray[np.int16]  # (episode, node) items, all of which a perfect scan shows
    shown: NDArray[np.int16]  # (episode, agent, place) items that a scan shows in the nodes of its
    # list, negative where it does not scan; no places where scans are perfect
    energy_left: NDArray[np.float64]  # (episode, agent) [node]
    room_left: NDArray[np.int64]  # (episode, agent) items, `UNLIMITED` if any number
    taken: NDArray[np.int64]  # (episode, agent) items taken aboard so far
    pickup: NDArray[np.int8]  # (episode, agent) how picking up ended in the step, see `PICKUPS`
    agent_yaw: NDArray[np.float64]  # (episode, agent) [rad], see `Observation`

    def plain(self) -> "Scans":
        """The same with arrays of the types above, one item beside the other, for kernels."""
        return Scans(*map(np.ascontiguousarray, self, _TYPES))


_TYPES = ("?", "i4", "i4", "i2", "i2", "f8", "i8", "i8", "i1", "f8")  # of its fields


class Knowledge(NamedTuple):
    """Knowledge of the owners. Row `episode * owners + owner` of every array."""

    belief: NDArray[np.int16]  # (row, node) items when the node was last seen
    last_seen: NDArray[np.int16]  # (row, node) step, NEVER if not yet
    known: Int32Array  # (row, node) nodes with belief > 0, the first `n_known` entries
    known_at: Int32Array  # (row, node) place of a node in `known`
    n_known: Int32Array  # (row,)
    agent_node: Int32Array  # (row, agent) from where its last scan received was made
    agent_seen: Int32Array  # (row, agent) step of that scan
    energy_left: NDArray[np.float64]  # (row, agent) as of then [node]
    room_left: NDArray[np.int64]  # (row, agent) as of then, items
    taken: NDArray[np.int64]  # (row, agent) by then, items
    pickup: NDArray[np.int8]  # (row, agent) then, see `PICKUPS`
    agent_yaw: NDArray[np.float64]  # (row, agent) then [rad]

    @classmethod
    def of_starts(cls, scans: Scans, nodes: int, owners: int = 1) -> "Knowledge":
        """Knowledge before any scan; the start nodes are known to all.

        Parameters
        ----------
        scans : of step 0
        nodes : of the map
        owners : rows per episode
        """
        rows = scans.step.size * owners
        return cls(
            belief=np.zeros((rows, nodes), np.int16),
            last_seen=np.full((rows, nodes), NEVER, np.int16),
            known=np.zeros((rows, nodes), np.int32),
            known_at=np.zeros((rows, nodes), np.int32),
            n_known=np.zeros(rows, np.int32),
            agent_node=np.repeat(scans.agent_node, owners, axis=0),
            agent_seen=np.zeros((rows, scans.agent_node.shape[1]), np.int32),
            energy_left=np.repeat(scans.energy_left, owners, axis=0),
            room_left=np.repeat(scans.room_left, owners, axis=0),
            taken=np.repeat(scans.taken, owners, axis=0),
            pickup=np.repeat(scans.pickup, owners, axis=0),
            agent_yaw=np.repeat(scans.agent_yaw, owners, axis=0),
        )


@kernel
def believe(
    belief: NDArray[np.int16],
    known: Int32Array,
    known_at: Int32Array,
    n_known: Int32Array,
    row: int,
    node: np.uint64,
    items: int,
) -> None:
    """Set an owner's belief about a node, and update its list of nodes with items.

    `belief`, `known`, `known_at`, `n_known`: of a `Knowledge`; changed in this row.
    """
    before = belief[row, node]
    belief[row, node] = items
    if before == 0 and items > 0:
        known[row, n_known[row]] = node
        known_at[row, node] = n_known[row]
        n_known[row] += 1
    elif before > 0 and items == 0:
        n_known[row] -= 1
        last_known = known[row, n_known[row]]
        known[row, known_at[row, node]] = last_known
        known_at[row, last_known] = known_at[row, node]


@inlined
def receive_counts(
    belief: NDArray[np.int16],
    last_seen: NDArray[np.int16],
    known: Int32Array,
    known_at: Int32Array,
    n_known: Int32Array,
    row: int,
    step: int,
    nodes: Int32Array,
    first: int,
    shown: NDArray[np.int16],
) -> None:
    """Update an owner's knowledge by the counts of a scan; of scans of one step, the larger.

    Parameters
    ----------
    belief, last_seen, known, known_at, n_known : of a `Knowledge`; changed in this row
    step : of the scan
    nodes, first : its list of nodes begins at `nodes[first]`
    shown : (place,) items in them, negative where it did not scan
    """
    for i in range(shown.size):
        items = shown[i]
        if items < 0:
            continue
        node = np.uint64(nodes[first + i])
        before = last_seen[row, node]
        if step > before or (step == before and items > belief[row, node]):
            last_seen[row, node] = step
            if items != belief[row, node]:  # seldom: calls count references
                believe(belief, known, known_at, n_known, row, node, items)


@kernel
def receive(
    scans: Scans,
    received: NDArray[np.bool_],
    views: NodeLists,
    radius_number: NDArray[np.int64],
    knowledge: Knowledge,
) -> None:
    """Update knowledge by the scans of this step: idleness becomes 0, belief the scan's counts.

    Parameters
    ----------
    received : (row, agent) whose scan each owner receives
    views, radius_number : view of an agent from a node, see `Task`
    knowledge : changed in the rows of active episodes
    """
    active, step, at, sighted = scans.active, scans.step, scans.agent_node, scans.sighted
    energy, room, taken, pickup = scans.energy_left, scans.room_left, scans.taken, scans.pickup
    start, nodes = views.start, views.nodes
    belief, last_seen = knowledge.belief, knowledge.last_seen
    known, known_at, n_known = knowledge.known, knowledge.known_at, knowledge.n_known
    agent_node, agent_seen = knowledge.agent_node, knowledge.agent_seen
    perfect = scans.shown.shape[2] == 0
    energy_left, room_left = knowledge.energy_left, knowledge.room_left
    taken_by_then, pickup_then = knowledge.taken, knowledge.pickup
    owners = received.shape[0] // max(1, active.size)
    for row in range(received.shape[0]):
        e = row // owners
        if not active[e]:
            continue
        now = np.int16(step[e])
        for agent in range(radius_number.size):
            if not received[row, agent]:
                continue
            radius, viewer = radius_number[agent], at[e, agent]
            agent_node[row, agent], agent_seen[row, agent] = viewer, step[e]
            energy_left[row, agent], room_left[row, agent] = energy[e, agent], room[e, agent]
            taken_by_then[row, agent], pickup_then[row, agent] = taken[e, agent], pickup[e, agent]
            knowledge.agent_yaw[row, agent] = scans.agent_yaw[e, agent]
            first, end = start[radius, viewer], start[radius, viewer + 1]
            if not perfect:
                shown = scans.shown[e, agent, : end - first]
                receive_counts(
                    belief, last_seen, known, known_at, n_known, row, step[e], nodes, first, shown
                )
                continue
            for i in range(first, end):
                node = np.uint64(nodes[np.uint64(i)])  # unsigned: never counted from the end
                last_seen[row, node] = now
                if belief[row, node] != sighted[e, node]:  # seldom: calls count references
                    believe(belief, known, known_at, n_known, row, node, sighted[e, node])


@kernel
def idleness(
    last_seen: NDArray[np.int16],
    step: Int32Array,
    rows: NDArray[np.int64],
    forgetting: float,
) -> NDArray[np.float64]:
    """(chosen, node) idleness in [0, 1] of some rows (chosen,) of the batch.

    Parameters
    ----------
    last_seen : (row, node) step, NEVER if not yet
    step : (row,) current step of every row
    forgetting : growth of idleness per step
    """
    out = np.empty((rows.size, last_seen.shape[1]))
    for i in range(rows.size):
        row, now = rows[i], step[rows[i]]
        for node in range(last_seen.shape[1]):
            unseen_for = np.float64(now - np.int32(last_seen[row, node]))
            out[i, node] = min(1.0, unseen_for * forgetting)
    return out


@kernel
def times_seen(
    agent_node: Int32Array,
    agents: NDArray[np.int64],
    views: NodeLists,
    radius_number: NDArray[np.int64],
    shown: NDArray[np.int16],
) -> NDArray[np.uint8]:
    """(episode, node) by how many of some agents (chosen,) each node is in view.

    Parameters
    ----------
    agent_node : (episode, agent) where all agents are
    views, radius_number : view of an agent from a node, see `Task`
    shown : (episode, agent, place) negative where an agent does not scan; see `Scans`
    """
    start, nodes, perfect = views.start, views.nodes, shown.shape[2] == 0
    out = np.zeros((agent_node.shape[0], start.shape[1] - 1), np.uint8)
    for e in range(agent_node.shape[0]):
        for agent in agents:
            radius, viewer = radius_number[agent], agent_node[e, agent]
            first = start[radius, viewer]
            for i in range(first, start[radius, viewer + 1]):
                out[e, nodes[i]] += perfect or shown[e, agent, i - first] >= 0
    return out
