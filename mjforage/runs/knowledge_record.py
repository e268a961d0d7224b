"""Knowledge of each agent in an episode over a link, and the link's log, step by step.

Maps are stored as changes: a scan renews some ten nodes of a map of thousands.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.mission.mission import Mission, Observer
from mjforage.mission.task import NEVER

UNKNOWN = -1  # no step
ALL = -1  # no agent: the fleet together
AXES = {
    "held_changes": "t",
    "held_agent": "k",
    "held_cell": "k",
    "held_seen": "k",
    "held_items": "k",
    "held_heard": "taa",
    "held_known_from": "ai",
    "held_linked": "taa",
    "held_lost": "taa",
}
"""Axes of its arrays in a file: step (t), agent, item, change (k)."""


@dataclass(frozen=True)
class KnowledgeRecord:
    """Maps, contacts and losses of one episode of T' steps; step 0 is the state before any move."""

    forgetting: float  # growth of idleness per step
    changes: NDArray[np.int32]  # (T'+1,) how many entries of all maps change in each step
    agent: NDArray[np.int16]  # (change,) in whose map
    cell: NDArray[np.int32]  # (change,) row * columns + column
    seen: NDArray[np.int16]  # (change,) step of the newest scan of the node that it has received
    items: NDArray[np.int16]  # (change,) that it believes to be there
    received: NDArray[np.int16]  # (T'+1, agent, of agent) step of the newest scan received
    known_from: NDArray[np.int16]  # (agent, item) first step with the item in its map, or `UNKNOWN`
    linked: NDArray[np.bool_]  # (T'+1, agent, agent) whether two are in contact
    lost: NDArray[np.int16]  # (T'+1, sender, receiver) scans lost on the way
    viewer: int = ALL  # agent by whose map the episode is drawn; no part of a file

    def maps(self, agent: int, cells: int) -> tuple[NDArray[np.int16], NDArray[np.int16]]:
        """Map of an agent, and the steps of the scans it comes from: (T'+1, cell) both.

        Parameters
        ----------
        cells : rows x columns of the map; the step is NEVER on land and where nothing was received
        """
        belief = np.zeros((len(self.changes), cells), np.int16)
        seen = np.full((len(self.changes), cells), NEVER, np.int16)
        end = np.cumsum(self.changes)
        for step, first in enumerate(end - self.changes):
            if step > 0:
                belief[step], seen[step] = belief[step - 1], seen[step - 1]
            own = first + np.flatnonzero(self.agent[first : end[step]] == agent)
            belief[step, self.cell[own]] = self.items[own]
            seen[step, self.cell[own]] = self.seen[own]
        return belief, seen

    def idleness(self, seen: NDArray[np.int16]) -> NDArray[np.float16]:
        """Idleness in [0, 1] of the nodes of a map (T'+1, cell), by when each was seen last."""
        since = np.arange(len(seen))[:, None] - seen.astype(np.int64)
        idle: NDArray[np.float16] = np.minimum(1.0, since * self.forgetting).astype(np.float16)
        return idle

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Its values under the names that they have in a file."""
        names = [one.name for one in fields(self) if one.name != "viewer"]
        return {_key(name): np.asarray(getattr(self, name)) for name in names}

    @classmethod
    def of(cls, file: Mapping[str, NDArray[Any]], cells: int) -> "KnowledgeRecord | None":
        """Of an open file, whose axes fit; None if it has none.

        Raises `ValueError` if its changes do not fit the map.
        """
        if "held_changes" not in file:
            return None
        names = [one.name for one in fields(cls) if one.name != "viewer"]
        values: dict[str, Any] = {name: file[_key(name)] for name in names}
        values["forgetting"] = float(values["forgetting"])
        record = cls(**values)
        agents = record.received.shape[1]
        for name, array, end in (("agent", record.agent, agents), ("cell", record.cell, cells)):
            if len(array) != record.changes.sum() or ((array < 0) | (array >= end)).any():
                raise ValueError(f"{_key(name)} does not fit the map")
        return record


def _key(name: str) -> str:
    """Name of a field in a file."""
    return "held_heard" if name == "received" else f"held_{name}"


class _Changes(NamedTuple):
    """Entries of maps that a step changed."""

    agent: NDArray[np.int64]
    node: NDArray[np.int64]
    seen: NDArray[np.int16]
    items: NDArray[np.int16]


class KnowledgeRecorder(Observer):
    """Takes down the first episode of a batch over a link."""

    def __init__(self) -> None:
        self._before: tuple[NDArray[np.int16], NDArray[np.int16]] | None = None
        self._changes: list[_Changes] = []
        self._item_node: list[NDArray[np.int32]] = []
        self._received: list[NDArray[np.int16]] = []
        self._linked: list[NDArray[np.bool_]] = []
        self._lost: list[NDArray[np.int16]] = []

    def see(self, mission: Mission) -> None:
        """Take down a step."""
        exchange = mission.exchange
        owner_of, knowledge = exchange.owner_of, exchange.knowledge
        belief, seen = knowledge.belief[owner_of], knowledge.last_seen[owner_of]
        old = self._before or (np.zeros_like(belief), np.full_like(seen, NEVER))
        agent, node = np.nonzero((belief != old[0]) | (seen != old[1]))
        self._changes.append(_Changes(agent, node, seen[agent, node], belief[agent, node]))
        self._before = belief, seen
        self._item_node.append(mission.state.item_node[0].copy())
        self._received.append(knowledge.agent_seen[owner_of].astype(np.int16))
        assert exchange.link_log is not None
        self._linked.append(exchange.link_log.contact[0].copy())
        self._lost.append(exchange.link_log.lost_now[0].astype(np.int16))

    def record(self, mission: Mission) -> KnowledgeRecord:
        """The complete record."""
        graph = mission.setup.graph
        all_ = _Changes(*map(np.concatenate, zip(*self._changes, strict=True)))
        changes = np.array([len(step.agent) for step in self._changes], np.int32)
        return KnowledgeRecord(
            forgetting=mission.task.forgetting,
            changes=changes,
            agent=all_.agent.astype(np.int16),
            cell=(graph.rows * graph.shape[1] + graph.cols)[all_.node].astype(np.int32),
            seen=all_.seen,
            items=all_.items,
            received=np.stack(self._received),
            known_from=self._known_from(all_, np.repeat(np.arange(len(changes)), changes)),
            linked=np.stack(self._linked),
            lost=np.stack(self._lost),
        )

    def _known_from(self, changes: _Changes, step: NDArray[np.int64]) -> NDArray[np.int16]:
        """(agent, item) the first step in which each has a scan with the item in it."""
        shape = len(self._received[0]), len(self._item_node[0])
        first = np.full(shape, UNKNOWN, np.int16)
        for one in np.flatnonzero(changes.items > 0)[::-1]:  # the first is written last
            there = self._item_node[changes.seen[one]] == changes.node[one]
            first[changes.agent[one], there] = step[one]
        return first
