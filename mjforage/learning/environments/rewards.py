"""Rewards as named terms: each is a number per agent, times the weight of the same name.

| term | meaning of one unit |
|---|---|
| removed | an item removed by this agent |
| team_removed | an item removed by anyone, shared equally by all agents |
| discovered | an item first discovered by this agent |
| belief | a change of the belief map by one item in view; shared where views overlap |
| idleness | a node of idleness 1 that came into view (agents that do not collect) |
| distance | one node of geodesic distance to the nearest known item; 0 if none is known |
| approach | one node nearer to the nearest item that was known before the move |
| blocked | a decision without a legal move |
| time | a decision of an episode that is not over |
"""

import difflib
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from graph_planner.compiled import kernel
from graph_planner.geodesics import FAR, Int32Array, Workspace, distances_to_nearest
from graph_planner.task import Task, TaskArrays
from graph_planner.visibility import NodeLists
from mjforage.core.dynamics import BLOCKED
from mjforage.core.errors import UserError

if TYPE_CHECKING:
    from mjforage.core.mission import Mission

Amounts = NDArray[np.float64]  # (episode, agent)

PUBLISHED = {"belief": 2.12, "removed": 5.91, "idleness": 2.23, "distance": -1.7}
"""Weights of the published experiments (scenario section 3)."""


class Before(NamedTuple):
    """What a reward compares the new state with."""

    belief: NDArray[np.int16]  # (episode, node)
    last_seen: NDArray[np.int16]  # (episode, node)
    agent_node: Int32Array  # (episode, agent)
    known: Int32Array  # (episode, node)
    n_known: Int32Array  # (episode,)


@kernel
def _in_view(
    agent_node: Int32Array,
    views: NodeLists,
    radius_number: NDArray[np.int64],
    worth: Amounts,
    shared: bool,
    out: Amounts,
) -> None:
    """Sum of what each node in view is worth (episode, node), by agent; maybe shared."""
    start, nodes = views.start, views.nodes
    viewers = np.zeros(worth.shape[1], np.int64)
    for e in range(agent_node.shape[0]):
        if shared:
            viewers[:] = 0
            for a in range(radius_number.size):
                radius, node = radius_number[a], agent_node[e, a]
                for i in range(start[radius, node], start[radius, node + 1]):
                    viewers[nodes[i]] += 1
        for a in range(radius_number.size):
            radius, node, total = radius_number[a], agent_node[e, a], 0.0
            for i in range(start[radius, node], start[radius, node + 1]):
                value = worth[e, nodes[i]]
                total += value / viewers[nodes[i]] if shared else value
            out[e, a] = total


@kernel
def _nearest_known(
    arrays: TaskArrays,
    known: Int32Array,
    n_known: Int32Array,
    agent_node: Int32Array,
    workspace: Workspace,
    out: Amounts,
) -> None:
    """Distance of each agent to the nearest known item [node]; 0 if none is known."""
    neighbours, table = arrays.neighbours, arrays.distances
    agents = agent_node.shape[1]
    targets = np.full((agents, 9), np.int32(-1), np.int32)
    nearest = np.empty((agents, 9))
    for e in range(agent_node.shape[0]):
        out[e] = 0.0
        if n_known[e] == 0:
            continue
        targets[:, 0] = agent_node[e]
        items = known[e, : n_known[e]]
        distances_to_nearest(
            neighbours, table, items, agent_node[e], targets, 0.0, workspace, nearest
        )
        for a in range(agents):
            if nearest[a, 0] < FAR:
                out[e, a] = nearest[a, 0]


def _count(agent: NDArray[np.int16], now: NDArray[np.bool_], agents: int) -> Amounts:
    """How many items (episode, item) an event gives to each agent now."""
    counts = [((agent == a) & now).sum(axis=1) for a in range(agents)]
    return np.stack(counts, axis=1).astype(np.float64)


class RewardTerms:
    """Computes the chosen terms of a batch at every step."""

    def __init__(self, task: Task, names: tuple[str, ...]) -> None:
        self._task, self.names = task, names
        self._agents = len(task.fleet)
        self._workspace = Workspace.of(len(task.graph))

    def before(self, mission: "Mission") -> None:
        """Take a copy of what the next state is compared with; call before every step."""
        known = mission.knowledge
        self._before = Before(
            known.belief.copy(),
            known.last_seen.copy(),
            mission.state.agent_node.copy(),
            known.known.copy(),
            known.n_known.copy(),
        )

    def after(self, mission: "Mission", played: NDArray[np.bool_]) -> dict[str, Amounts]:
        """Terms of the step just made: name -> (episode, agent), 0 for episodes not played."""
        return {
            name: np.where(played[:, None], TERMS[name](self, mission), 0.0) for name in self.names
        }

    def removed(self, mission: "Mission") -> Amounts:
        """Items that each agent removed."""
        now = mission.ledger.entries.t_collected == mission.step[:, None]
        return _count(mission.state.collected_by, now, self._agents)

    def team_removed(self, mission: "Mission") -> Amounts:
        """Items removed by all, over the number of agents."""
        removed = self.removed(mission)
        return np.repeat(removed.mean(axis=1, keepdims=True), self._agents, axis=1)

    def discovered(self, mission: "Mission") -> Amounts:
        """Items first discovered by each agent."""
        entries = mission.ledger.entries
        now = entries.t_discovered == mission.step[:, None]
        return _count(entries.discovered_by, now, self._agents)

    def belief(self, mission: "Mission") -> Amounts:
        """Change of the belief map in view, shared where views overlap."""
        change = np.abs(mission.knowledge.belief - self._before.belief).astype(np.float64)
        return self._seen(mission, change, shared=True)

    def idleness(self, mission: "Mission") -> Amounts:
        """Idleness, before the look, of the nodes in view of agents that do not collect."""
        unseen_for = mission.step[:, None] - self._before.last_seen.astype(np.int64)
        idle = np.minimum(1.0, unseen_for * self._task.forgetting)
        looks = (~self._task.fleet.collects).astype(np.float64)
        return self._seen(mission, idle, shared=False) * looks

    def distance(self, mission: "Mission") -> Amounts:
        """Distance to the nearest known item, 0 if none is known."""
        known = mission.knowledge
        return self._nearest(known.known, known.n_known, mission.state.agent_node)

    def approach(self, mission: "Mission") -> Amounts:
        """By how much the nearest item known before the move has come nearer."""
        old = self._before
        before = self._nearest(old.known, old.n_known, old.agent_node)
        return before - self._nearest(old.known, old.n_known, mission.state.agent_node)

    def blocked(self, mission: "Mission") -> Amounts:
        """1 where an agent had no legal move."""
        return np.asarray(mission.state.outcome == BLOCKED, np.float64)

    def time(self, mission: "Mission") -> Amounts:
        """1 for every step until the episode is over."""
        left = np.asarray((mission.state.item_node >= 0).any(axis=1), np.float64)
        return np.repeat(left[:, None], self._agents, axis=1)

    def _seen(self, mission: "Mission", worth: Amounts, shared: bool) -> Amounts:
        out = np.empty(mission.state.agent_node.shape)
        task = self._task
        _in_view(mission.state.agent_node, task.views, task.radius_number, worth, shared, out)
        return out

    def _nearest(self, known: Int32Array, n_known: Int32Array, agent_node: Int32Array) -> Amounts:
        out = np.empty(agent_node.shape)
        _nearest_known(self._task.arrays, known, n_known, agent_node, self._workspace, out)
        return out


TERMS: dict[str, Callable[[RewardTerms, "Mission"], Amounts]] = {
    name: getattr(RewardTerms, name)
    for name in (
        *("removed", "team_removed", "discovered", "belief", "idleness"),
        *("distance", "approach", "blocked", "time"),
    )
}


def checked_weights(weights: Mapping[str, float]) -> dict[str, float]:
    """The weights that are not 0.

    Raises
    ------
    UserError
        If a term is not known or a weight is no finite number.
    """
    return checked_names(weights, TERMS)


def checked_names(weights: Mapping[str, float], known: Iterable[str]) -> dict[str, float]:
    """The weights that are not 0, all of known terms; raises `UserError` as above."""
    names = list(known)
    for name, weight in weights.items():
        if name not in names:
            close = difflib.get_close_matches(name, names, n=1)
            hint = f"did you mean {close[0]}?" if close else f"choose {', '.join(names)}"
            raise UserError(f"reward {name}: unknown term; {hint}")
        if not isinstance(weight, int | float) or not np.isfinite(weight):
            raise UserError(f"reward {name} = {weight!r}: give a finite number")
    return {name: float(weight) for name, weight in weights.items() if weight}
