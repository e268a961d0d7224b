"""Who knows what: what was last seen in each node and when, and where everybody was last heard of.

A row is what one holder of one episode knows: all that it has heard of the agents' looks, and
nothing else. With ideal communication an episode has one holder, and what it knows all agents know.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined, kernel
from mjforage.base.rows import scatter_rows
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.mission.task import NEVER


class Looks(NamedTuple):
    """What all agents see and say of themselves at the end of a step. Live views."""

    active: NDArray[np.bool_]  # (episode,) whose step it was; nobody looks in the others
    step: Int32Array  # (episode,)
    agent_node: Int32Array  # (episode, agent) from where each looks
    sighted: NDArray[np.int16]  # (episode, node) items, all of which a perfect look shows
    shown: NDArray[np.int16]  # (episode, agent, place) items that a look shows in the nodes of its
    # list, negative where it does not look; no places where looks are perfect
    energy_left: NDArray[np.float64]  # (episode, agent) [node]
    room_left: NDArray[np.int64]  # (episode, agent) items, `UNLIMITED` if any number
    taken: NDArray[np.int64]  # (episode, agent) items taken aboard so far
    pickup: NDArray[np.int8]  # (episode, agent) how picking up ended in the step, see `PICKUPS`
    agent_yaw: NDArray[np.float64]  # (episode, agent) [rad], see `Observation`

    def plain(self) -> "Looks":
        """The same with arrays of the types above, one item beside the other, for kernels."""
        return Looks(*map(np.ascontiguousarray, self, _TYPES))


_TYPES = ("?", "i4", "i4", "i2", "i2", "f8", "i8", "i8", "i1", "f8")  # of its fields


class Knowledge(NamedTuple):
    """What holders know. Row `episode * holders + holder` of every array."""

    belief: NDArray[np.int16]  # (row, node) items when the node was last seen
    last_seen: NDArray[np.int16]  # (row, node) step, NEVER if not yet
    known: Int32Array  # (row, node) nodes with belief > 0, the first `n_known` entries
    known_at: Int32Array  # (row, node) place of a node in `known`
    n_known: Int32Array  # (row,)
    agent_node: Int32Array  # (row, agent) from where its last look heard of was made
    agent_seen: Int32Array  # (row, agent) step of that look
    energy_left: NDArray[np.float64]  # (row, agent) as of then [node]
    room_left: NDArray[np.int64]  # (row, agent) as of then, items
    taken: NDArray[np.int64]  # (row, agent) by then, items
    pickup: NDArray[np.int8]  # (row, agent) then, see `PICKUPS`
    agent_yaw: NDArray[np.float64]  # (row, agent) then [rad]

    @classmethod
    def of_starts(cls, looks: Looks, nodes: int, holders: int = 1) -> "Knowledge":
        """Nothing seen yet; where everybody starts is known to all.

        Parameters
        ----------
        looks : of step 0
        nodes : of the map
        holders : rows per episode
        """
        rows = looks.step.size * holders
        return cls(
            belief=np.zeros((rows, nodes), np.int16),
            last_seen=np.full((rows, nodes), NEVER, np.int16),
            known=np.zeros((rows, nodes), np.int32),
            known_at=np.zeros((rows, nodes), np.int32),
            n_known=np.zeros(rows, np.int32),
            agent_node=np.repeat(looks.agent_node, holders, axis=0),
            agent_seen=np.zeros((rows, looks.agent_node.shape[1]), np.int32),
            energy_left=np.repeat(looks.energy_left, holders, axis=0),
            room_left=np.repeat(looks.room_left, holders, axis=0),
            taken=np.repeat(looks.taken, holders, axis=0),
            pickup=np.repeat(looks.pickup, holders, axis=0),
            agent_yaw=np.repeat(looks.agent_yaw, holders, axis=0),
        )

    def with_rows(self, rows: NDArray[np.int64], other: "Knowledge") -> "Knowledge":
        """A copy in which the given rows (row,) are those of another knowledge, in its order."""
        return Knowledge(
            *(scatter_rows(getattr(self, n), rows, getattr(other, n)) for n in self._fields)
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
    """Set what a holder believes of a node, and keep its list of those with items.

    Parameters
    ----------
    belief, known, known_at, n_known : of a `Knowledge`; changed in this row
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
def take_shown(
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
    """Let a holder know what a look has shown; of looks of one step, the larger count.

    Parameters
    ----------
    belief, last_seen, known, known_at, n_known : of a `Knowledge`; changed in this row
    step : of the look
    nodes, first : its list of nodes begins at `nodes[first]`
    shown : (place,) items in them, negative where it did not look
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
def hear(
    looks: Looks,
    heard: NDArray[np.bool_],
    views: NodeLists,
    radius_number: NDArray[np.int64],
    knowledge: Knowledge,
) -> None:
    """Take in the looks of this step: idleness ends and belief becomes what the look shows.

    Parameters
    ----------
    heard : (row, agent) whose look each holder hears of
    views, radius_number : what an agent sees from a node, see `Task`
    knowledge : changed in the rows of active episodes
    """
    active, step, at, sighted = looks.active, looks.step, looks.agent_node, looks.sighted
    energy, room, taken, pickup = looks.energy_left, looks.room_left, looks.taken, looks.pickup
    start, nodes = views.start, views.nodes
    belief, last_seen = knowledge.belief, knowledge.last_seen
    known, known_at, n_known = knowledge.known, knowledge.known_at, knowledge.n_known
    agent_node, agent_seen = knowledge.agent_node, knowledge.agent_seen
    perfect = looks.shown.shape[2] == 0
    energy_left, room_left = knowledge.energy_left, knowledge.room_left
    taken_by_then, pickup_then = knowledge.taken, knowledge.pickup
    holders = heard.shape[0] // max(1, active.size)
    for row in range(heard.shape[0]):
        e = row // holders
        if not active[e]:
            continue
        now = np.int16(step[e])
        for agent in range(radius_number.size):
            if not heard[row, agent]:
                continue
            radius, viewer = radius_number[agent], at[e, agent]
            agent_node[row, agent], agent_seen[row, agent] = viewer, step[e]
            energy_left[row, agent], room_left[row, agent] = energy[e, agent], room[e, agent]
            taken_by_then[row, agent], pickup_then[row, agent] = taken[e, agent], pickup[e, agent]
            knowledge.agent_yaw[row, agent] = looks.agent_yaw[e, agent]
            first, end = start[radius, viewer], start[radius, viewer + 1]
            if not perfect:
                shown = looks.shown[e, agent, : end - first]
                take_shown(
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
    views, radius_number : what an agent sees from a node, see `Task`
    shown : (episode, agent, place) negative where an agent does not look; see `Looks`
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
