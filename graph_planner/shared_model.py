"""The model that all agents share: belief map, idleness, first discoveries.

One implementation for both worlds; it is fed with a transition's agent nodes and item nodes and
never asks where they came from. Order within a step (scenario section 1): discretise to Y;
visibility; idleness; belief <- Y where seen; first discoveries credited, a tie to the scout.
"""

import numpy as np
from numpy.typing import NDArray

from graph_planner.compiled import kernel
from graph_planner.geodesics import Int32Array
from graph_planner.task import NEVER, Task

UNDISCOVERED = -1


@kernel
def _sees(start: NDArray[np.int64], nodes: Int32Array, radius: int, viewer: int, node: int) -> bool:
    found = False
    for i in range(start[radius, viewer], start[radius, viewer + 1]):
        if nodes[i] == node:
            found = True
            break
    return found


@kernel
def _update(
    active: NDArray[np.bool_],
    step: Int32Array,
    agent_node: Int32Array,
    item_node: Int32Array,
    collected_by: NDArray[np.int16],
    view_start: NDArray[np.int64],
    view_nodes: Int32Array,
    radius_number: NDArray[np.int64],
    credit_order: NDArray[np.int64],
    counted_node: Int32Array,
    truth: NDArray[np.int16],
    belief: NDArray[np.int16],
    last_seen: NDArray[np.int16],
    known: Int32Array,
    known_at: Int32Array,
    n_known: Int32Array,
    t_discovered: NDArray[np.int16],
    discovered_by: NDArray[np.int16],
    t_collected: NDArray[np.int16],
) -> None:
    n_episodes, n_items = item_node.shape
    for e in range(n_episodes):
        if not active[e]:
            continue
        now = np.int16(step[e])
        for k in range(n_items):
            before, after = counted_node[e, k], item_node[e, k]
            if before != after:
                if before >= 0:
                    truth[e, before] -= 1
                if after >= 0:
                    truth[e, after] += 1
                elif collected_by[e, k] >= 0 and t_collected[e, k] < 0:
                    t_collected[e, k] = now
                    if t_discovered[e, k] < 0:
                        t_discovered[e, k] = now
                        discovered_by[e, k] = collected_by[e, k]
                counted_node[e, k] = after
        for agent in credit_order:
            radius, viewer = radius_number[agent], agent_node[e, agent]
            for i in range(view_start[radius, viewer], view_start[radius, viewer + 1]):
                node = view_nodes[i]
                last_seen[e, node] = now
                if belief[e, node] != truth[e, node]:
                    if belief[e, node] == 0:
                        known[e, n_known[e]] = node
                        known_at[e, node] = n_known[e]
                        n_known[e] += 1
                    elif truth[e, node] == 0:
                        n_known[e] -= 1
                        last = known[e, n_known[e]]
                        known[e, known_at[e, node]] = last
                        known_at[e, last] = known_at[e, node]
                    belief[e, node] = truth[e, node]
        for k in range(n_items):
            node = item_node[e, k]
            if node >= 0 and t_discovered[e, k] < 0 and last_seen[e, node] == now:
                t_discovered[e, k] = now
                for agent in credit_order:
                    viewer = agent_node[e, agent]
                    if _sees(view_start, view_nodes, radius_number[agent], viewer, node):
                        discovered_by[e, k] = agent
                        break


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
    view_start: NDArray[np.int64],
    view_nodes: Int32Array,
    out: NDArray[np.uint8],
) -> None:
    out[:] = 0
    for e in range(agent_node.shape[0]):
        for agent in agents:
            radius, viewer = radius_number[agent], agent_node[e, agent]
            for i in range(view_start[radius, viewer], view_start[radius, viewer + 1]):
                out[e, view_nodes[i]] += 1


class SharedModel:
    """Belief, idleness and discoveries of a batch of episodes.

    Every array has a leading episode axis: `truth` and `belief` (episode, node) int16 item counts,
    `last_seen` (episode, node) int16, `known`/`n_known` the nodes with belief > 0,
    `t_discovered`, `discovered_by`, `t_collected`, `collected_by` (episode, item) int16, -1 for
    never and nobody.
    """

    def __init__(self, task: Task) -> None:
        self._task = task
        self._views = task.views
        self._radius_number = task.radius_number
        self._credit_order = task.fleet.credit_order

    def reset(self, agent_node: Int32Array, item_node: Int32Array) -> None:
        """Start a batch: everything unknown, then the first look at step 0, which removes nothing.

        Parameters
        ----------
        agent_node : (episode, agent)
        item_node : (episode, item), -1 for padding
        """
        episodes, items = item_node.shape
        nodes = (episodes, len(self._task.graph))
        self.truth = np.zeros(nodes, np.int16)
        self.belief = np.zeros(nodes, np.int16)
        self.last_seen = np.full(nodes, NEVER, np.int16)
        self.known = np.zeros(nodes, np.int32)
        self._known_at = np.zeros(nodes, np.int32)
        self.n_known = np.zeros(episodes, np.int32)
        self._counted_node = np.full((episodes, items), -1, np.int32)
        self.t_discovered = np.full((episodes, items), -1, np.int16)
        self.discovered_by = np.full((episodes, items), -1, np.int16)
        self.t_collected = np.full((episodes, items), -1, np.int16)
        nobody = np.full((episodes, items), -1, np.int16)
        everyone = np.ones(episodes, np.bool_)
        self.update(everyone, np.zeros(episodes, np.int32), agent_node, item_node, nobody)

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
        self.collected_by = collected_by
        _update(
            active,
            step,
            agent_node,
            item_node,
            collected_by,
            self._views.start,
            self._views.nodes,
            self._radius_number,
            self._credit_order,
            self._counted_node,
            self.truth,
            self.belief,
            self.last_seen,
            self.known,
            self._known_at,
            self.n_known,
            self.t_discovered,
            self.discovered_by,
            self.t_collected,
        )

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
        out = np.empty((episodes.size, self.last_seen.shape[1]))
        _idleness(step, self.last_seen, episodes, self._task.forgetting, out)
        return out

    def times_seen(self, agent_node: Int32Array, agents: NDArray[np.int64]) -> NDArray[np.uint8]:
        """By how many of `agents` each node is in view.

        Takes (episode, agent) nodes, gives (episode, node) counts.
        """
        out = np.empty((agent_node.shape[0], self.last_seen.shape[1]), np.uint8)
        _times_seen(
            agent_node,
            agents,
            self._radius_number,
            self._views.start,
            self._views.nodes,
            out,
        )
        return out
