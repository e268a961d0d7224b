"""The model that all agents share: belief map, idleness, first discoveries.

One implementation for both worlds; it is fed with a transition's agent nodes and item nodes and
never asks where they came from. Order within a step (scenario section 1): discretise to Y;
visibility; idleness; belief <- Y where seen; first discoveries credited, a tie to the scout.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from graph_planner.compiled import kernel
from graph_planner.geodesics import Int32Array
from graph_planner.randomness import Stream, UInt64Array, stream_key, uniform
from graph_planner.rows import put_rows
from graph_planner.task import NEVER, Task
from graph_planner.visibility import NodeLists


class Knowledge(NamedTuple):
    """The arrays of a shared model. Steps are -1 for never, agents -1 for nobody."""

    truth: NDArray[np.int16]  # (episode, node) items; the agents do not know it
    belief: NDArray[np.int16]  # (episode, node) items when the node was last seen
    last_seen: NDArray[np.int16]  # (episode, node) step, NEVER if not yet
    known: Int32Array  # (episode, node) nodes with belief > 0, the first `n_known` entries
    known_at: Int32Array  # (episode, node) place of a node in `known`
    n_known: Int32Array  # (episode,)
    counted_node: Int32Array  # (episode, item) node in which `truth` counts it, -1 not at all
    sighted: NDArray[np.int16]  # (episode, node) items seen if looked at; or `truth`
    sighted_node: Int32Array  # (episode, item) the same for `counted_node`
    t_discovered: NDArray[np.int16]  # (episode, item) [step]
    discovered_by: NDArray[np.int16]  # (episode, item) agent
    t_collected: NDArray[np.int16]  # (episode, item) [step]


@kernel
def _count(
    active: NDArray[np.bool_],
    step: Int32Array,
    item_node: Int32Array,
    collected_by: NDArray[np.int16],
    model: Knowledge,
) -> None:
    """Discretise to Y, and note what was collected; collected unseen counts as discovered."""
    truth, counted_node = model.truth, model.counted_node
    t_discovered, discovered_by = model.t_discovered, model.discovered_by
    t_collected = model.t_collected
    for e in range(active.size):
        if not active[e]:
            continue
        for k in range(item_node.shape[1]):
            before, after = counted_node[e, k], item_node[e, k]
            if before == after:
                continue
            counted_node[e, k] = after
            if before >= 0:
                truth[e, before] -= 1
            if after >= 0:
                truth[e, after] += 1
            elif collected_by[e, k] >= 0 and t_collected[e, k] < 0:
                t_collected[e, k] = step[e]
                if t_discovered[e, k] < 0:
                    t_discovered[e, k] = step[e]
                    discovered_by[e, k] = collected_by[e, k]


@kernel
def _sight(
    active: NDArray[np.bool_],
    step: Int32Array,
    keys: UInt64Array,
    detection: float,
    model: Knowledge,
) -> None:
    """Draw which items are seen if looked at in this step."""
    counted_node, sighted, sighted_node = model.counted_node, model.sighted, model.sighted_node
    for e in range(active.size):
        if not active[e]:
            continue
        key = stream_key(keys[e], Stream.DETECTION)
        for k in range(counted_node.shape[1]):
            before, after = sighted_node[e, k], counted_node[e, k]
            if after >= 0 and uniform(key, k, step[e]) >= detection:
                after = np.int32(-1)
            sighted_node[e, k] = after
            if before >= 0:
                sighted[e, before] -= 1
            if after >= 0:
                sighted[e, after] += 1


@kernel
def _look(
    active: NDArray[np.bool_],
    step: Int32Array,
    agent_node: Int32Array,
    views: NodeLists,
    radius_number: NDArray[np.int64],
    model: Knowledge,
) -> None:
    """Idleness ends and belief becomes truth where an agent sees; the known nodes follow."""
    start, nodes = views.start, views.nodes
    sighted, belief, last_seen = model.sighted, model.belief, model.last_seen
    known, known_at, n_known = model.known, model.known_at, model.n_known
    for e in range(active.size):
        if not active[e]:
            continue
        now = np.int16(step[e])
        for agent in range(radius_number.size):
            radius, viewer = radius_number[agent], agent_node[e, agent]
            for i in range(start[radius, viewer], start[radius, viewer + 1]):
                node = nodes[i]
                last_seen[e, node] = now
                believed, there = belief[e, node], sighted[e, node]
                if believed == there:
                    continue
                belief[e, node] = there
                if believed == 0:
                    known[e, n_known[e]] = node
                    known_at[e, node] = n_known[e]
                    n_known[e] += 1
                elif there == 0:
                    n_known[e] -= 1
                    last = known[e, n_known[e]]
                    known[e, known_at[e, node]] = last
                    known_at[e, last] = known_at[e, node]


@kernel
def _discover(
    active: NDArray[np.bool_],
    step: Int32Array,
    agent_node: Int32Array,
    views: NodeLists,
    radius_number: NDArray[np.int64],
    credit_order: NDArray[np.int64],
    model: Knowledge,
) -> None:
    """Credit each item's first sighting to the first agent in order that sees it."""
    start, nodes, last_seen = views.start, views.nodes, model.last_seen
    t_discovered, discovered_by = model.t_discovered, model.discovered_by
    sighted_node = model.sighted_node
    for e in range(active.size):
        if not active[e]:
            continue
        now = step[e]
        for k in range(sighted_node.shape[1]):
            node = sighted_node[e, k]
            if node < 0 or t_discovered[e, k] >= 0 or last_seen[e, node] != now:
                continue
            t_discovered[e, k] = now
            for agent in credit_order:
                radius, viewer = radius_number[agent], agent_node[e, agent]
                for i in range(start[radius, viewer], start[radius, viewer + 1]):
                    if nodes[i] == node and discovered_by[e, k] < 0:
                        discovered_by[e, k] = agent


@kernel
def _idleness(
    step: Int32Array,
    last_seen: NDArray[np.int16],
    episodes: NDArray[np.int64],
    forgetting: float,
    out: NDArray[np.float64],
) -> None:
    for i in range(episodes.size):
        now = step[episodes[i]]
        for node in range(last_seen.shape[1]):
            unseen_for = np.float64(now - np.int32(last_seen[episodes[i], node]))
            out[i, node] = min(1.0, unseen_for * forgetting)


@kernel
def _times_seen(
    agent_node: Int32Array,
    agents: NDArray[np.int64],
    radius_number: NDArray[np.int64],
    views: NodeLists,
    out: NDArray[np.uint8],
) -> None:
    start, nodes = views.start, views.nodes
    out[:] = 0
    for e in range(agent_node.shape[0]):
        for agent in agents:
            radius, viewer = radius_number[agent], agent_node[e, agent]
            for i in range(start[radius, viewer], start[radius, viewer + 1]):
                out[e, nodes[i]] += 1


class SharedModel:
    """Belief, idleness and discoveries of a batch of episodes; see `Knowledge` for the arrays."""

    def __init__(self, task: Task, detection: float = 1.0) -> None:
        """Prepare.

        Parameters
        ----------
        detection : probability that an item in view is seen, drawn per item and step
        """
        self._detection = detection
        self._forgetting = task.forgetting
        self._nodes = len(task.graph)
        self._views = task.views
        self._radius_number = task.radius_number
        self._credit_order = task.fleet.credit_order

    def reset(self, agent_node: Int32Array, item_node: Int32Array, keys: UInt64Array) -> None:
        """Start a batch: everything unknown, then the first look at step 0, which removes nothing.

        Parameters
        ----------
        agent_node : (episode, agent)
        item_node : (episode, item), -1 for padding
        keys : (episode,) episode keys
        """
        items, nodes = item_node.shape, (item_node.shape[0], self._nodes)
        truth, counted_node = np.zeros(nodes, np.int16), np.full(items, -1, np.int32)
        certain = self._detection >= 1.0
        self._keys = keys
        self.knowledge = Knowledge(
            truth=truth,
            belief=np.zeros(nodes, np.int16),
            last_seen=np.full(nodes, NEVER, np.int16),
            known=np.zeros(nodes, np.int32),
            known_at=np.zeros(nodes, np.int32),
            n_known=np.zeros(nodes[0], np.int32),
            counted_node=counted_node,
            sighted=truth if certain else truth.copy(),
            sighted_node=counted_node if certain else counted_node.copy(),
            t_discovered=np.full(items, -1, np.int16),
            discovered_by=np.full(items, -1, np.int16),
            t_collected=np.full(items, -1, np.int16),
        )
        everyone, start = np.ones(nodes[0], np.bool_), np.zeros(nodes[0], np.int32)
        self.update(everyone, start, agent_node, item_node, np.full(items, -1, np.int16))

    def adopt(self, rows: NDArray[np.int64], other: "SharedModel") -> None:
        """Replace episodes (row,) of the batch by those of another model."""
        nobody = {"counted_node", "sighted_node", "t_discovered", "discovered_by", "t_collected"}
        mine, theirs = self.knowledge, other.knowledge
        mixed: dict[str, Any] = {
            name: put_rows(getattr(mine, name), rows, getattr(theirs, name), -(name in nobody))
            for name in mine._fields
        }
        if mine.sighted is mine.truth:  # everything is seen: they stay one array
            mixed |= {"sighted": mixed["truth"], "sighted_node": mixed["counted_node"]}
        self.knowledge = Knowledge(**mixed)
        self._keys = put_rows(self._keys, rows, other._keys)

    def update(
        self,
        active: NDArray[np.bool_],
        step: Int32Array,
        agent_node: Int32Array,
        item_node: Int32Array,
        collected_by: NDArray[np.int16],
    ) -> None:
        """Take in the state at the end of one step.

        Parameters
        ----------
        active : (episode,) others are left untouched
        step : (episode,) the step that has just been made
        agent_node : (episode, agent)
        item_node : (episode, item) node of each item, -1 once removed
        collected_by : (episode, item) agent that removed it, -1 nobody
        """
        views, radii, model = self._views, self._radius_number, self.knowledge
        _count(active, step, item_node, collected_by, model)
        if self._detection < 1.0:
            _sight(active, step, self._keys, self._detection, model)
        _look(active, step, agent_node, views, radii, model)
        _discover(active, step, agent_node, views, radii, self._credit_order, model)

    def idleness(self, step: Int32Array, episodes: NDArray[np.int64]) -> NDArray[np.float64]:
        """Idleness in [0, 1] of some episodes of the batch.

        Parameters
        ----------
        step : (episode,) current step of every episode of the batch
        episodes : (chosen,) which of them

        Returns
        -------
        (chosen, node)
        """
        out = np.empty((episodes.size, self._nodes))
        _idleness(step, self.knowledge.last_seen, episodes, self._forgetting, out)
        return out

    def times_seen(self, agent_node: Int32Array, agents: NDArray[np.int64]) -> NDArray[np.uint8]:
        """By how many of `agents` each node is in view.

        Takes (episode, agent) nodes, gives (episode, node) counts.
        """
        out = np.empty((agent_node.shape[0], self._nodes), np.uint8)
        _times_seen(
            agent_node,
            agents,
            self._radius_number,
            self._views,
            out,
        )
        return out
