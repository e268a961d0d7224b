"""Connectivity maintenance over a limited link: reports and relay positions.

An agent that plans by its own knowledge knows the step of its newest scan from each other agent,
and assumes that they know as much of it. Scouts with news of items return to foragers that have
nothing left to do, as far as they know; those wait where they last had contact, and search by
themselves after a long wait. Relays stand where most of the others are in their reach.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mjforage.graph_planner.belief_planner.covers import NOTICED
from mjforage.graph_planner.belief_planner.settings import BeliefSettings
from mjforage.graph_planner.belief_planner.sweeps import Cover
from mjforage.graph_planner.belief_planner.ways import UNREACHED, Ways, row_to
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.navigation import NavigationGraph
from mjforage.mission.task import Observation, Task

NOBODY = -1
SLACK = 3  # decisions beyond the latency without news from somebody in touch
PATIENCE = 40  # decisions after which a forager no longer waits for news
PER_DECISION = 0.7  # items that a forager takes in a decision, of those it knows of
NEAR = 2.0  # of a decision's way, to where somebody was last heard of: it should be heard there
WITHIN = 0.8  # of the reach: how near a relay keeps to the others, who move on
WAY = 1e-3  # of a squared node: what a node of its own way counts for it
ELSEWHERE = 0.25  # what a node in another's part is worth, to one that looks alone


@lru_cache(maxsize=16)
def parts_of(graph: NavigationGraph, start: int, number: int) -> NDArray[np.int64]:
    """(node,) which of so many parts of a map each node is in: nearest to one of nodes far apart.

    The first of those is the farthest from `start`, each other one from all before.
    """
    away = graph.distances_from(np.array([start], np.int32)).copy()
    part = np.zeros(len(graph), np.int64)
    nearest = np.full(len(graph), np.inf)
    for k in range(number):
        far = int(np.argmax(np.where(np.isfinite(away), away, -1.0)))
        distance = graph.distances_from(np.array([far], np.int32))
        part[distance < nearest] = k
        nearest = np.minimum(nearest, distance)
        away = np.minimum(away, distance)
    return part


class Connectivity:
    """Connectivity maintenance of a batch: each row's estimate of the scans received by others.

    `waits`, `looks_alone` and `tells` are for rows by which one agent acts, if not `always`.

    Attributes
    ----------
    reach : assumed range of contact between agents [node]
    """

    def __init__(self, task: Task, settings: BeliefSettings, rows: int) -> None:
        self.reach, fleet = task.reach_node, task.fleet
        self._collectors = fleet.collectors
        self._scouts = np.flatnonzero(~fleet.collects & ~fleet.relays & (fleet.radius > 0.0))
        self._slack = SLACK + task.latency
        self._relays = fleet.relays & ~fleet.collects
        self._report, self._alone, self._relay = settings.report, settings.alone, settings.relay
        self._graph, self._moves = task.graph, task.fleet.moves
        agents = len(task.fleet)
        self._home = np.full(rows, NOBODY, np.int64)  # where an agent was when last in touch
        self._left: NDArray[np.float64] | None = None  # (row, cell) not noticed by one alone
        # Step of the last news of agents that were not found where they were then.
        self._missed = np.full((rows, agents), NOBODY, np.int64)

    @property
    def always(self) -> bool:
        """True if agents are assumed to be in contact everywhere."""
        return bool(np.isinf(self.reach))

    def note(self, seen: Observation, e: int) -> None:
        """Note the agents from which scans have arrived."""
        owner = int(seen.owner[e])
        if owner == NOBODY or self.always:
            return
        here = int(seen.agent_node[e, owner])
        others = self._scouts if owner in self._collectors else self._collectors
        if self._home[e] == NOBODY or self._silence(seen, e, others) <= self._slack:
            self._home[e] = here

    def _silence(self, seen: Observation, e: int, others: NDArray[np.int64]) -> float:
        """Decisions since the newest scan received from some agents, inf if there are none."""
        contacts: NDArray[np.int32] = seen.agent_seen[e][others]
        return float(seen.step[e] - 1 - contacts.max()) if contacts.size else np.inf

    def waits(self, seen: Observation, e: int) -> int:
        """Node of its last contact, where an idle forager waits; `NOBODY` if it need not."""
        silence = self._silence(seen, e, self._scouts)
        if silence <= self._slack or np.isinf(silence):
            return NOBODY
        return int(self._home[e])

    def looks_alone(self, seen: Observation, e: int) -> bool:
        """True if a forager that waits for news searches for items by itself."""
        patience = PATIENCE if self.reach > 0.0 else 0
        return self._alone and self._silence(seen, e, self._scouts) >= patience

    def part(self, seen: Observation, e: int) -> NDArray[np.float64]:
        """(node,) worth of seeing each node, for a forager that searches alone."""
        number = self._collectors.size
        mine = int(np.flatnonzero(self._collectors == seen.owner[e])[0])
        part = parts_of(self._graph, 0, number)
        return np.where(part == mine, 1.0, ELSEWHERE)

    def passed(self, e: int, cover: Cover, here: int, mass: NDArray[np.float64]) -> None:
        """Reduce the mass (cell,) of cells that it would have noticed on its way here."""
        if self._left is None:
            self._left = np.ones((self._home.size, mass.size))
        self._left[e, cover.cells[cover.start[here] : cover.start[here + 1]]] *= 1.0 - NOTICED
        mass *= self._left[e]

    def connects(self, seen: Observation, e: int, ways: Ways) -> int:
        """Node in which a relay should stand; `NOBODY` for other agents.

        It minimises the sum of the squared distances by which the others, at their last known
        places, are beyond its reach.

        `ways`: of the relay.
        """
        owner, rows, cols = int(seen.owner[e]), self._graph.rows, self._graph.cols
        if not (self._relay and self._relays[owner] and self.reach > 0.0):
            return NOBODY
        others = np.delete(seen.agent_node[e], owner)
        away = np.hypot(rows[:, None] - rows[others], cols[:, None] - cols[others])
        beyond = np.maximum(0.0, away - WITHIN * self.reach)
        here = seen.agent_node[e, owner]
        way = self._graph.distances_from(np.array([here], np.int32))
        node = int(np.argmin((beyond**2).sum(axis=1) + WAY * way))
        return self._reached(ways, int(here), node)[0]

    def tells(self, seen: Observation, e: int, born: Int32Array, ways: Ways) -> int:
        """Node to which a scout brings news; `NOBODY` if it need not.

        Parameters
        ----------
        born : (track,) steps in which the items that it knows of were first seen
        ways : of the scout
        """
        owner, now = int(seen.owner[e]), int(seen.step[e]) - 1
        if not self._report or self.reach <= 0.0 or not born.size:
            return NOBODY
        here, target, least = int(seen.agent_node[e, owner]), NOBODY, np.inf
        if self._relays[owner]:
            return NOBODY
        for other in self._collectors.tolist():
            contact_step = int(seen.agent_seen[e, other])
            news = int((born > contact_step).sum())
            if now - contact_step <= self._slack or not news:
                continue
            node = self._place(e, other, contact_step, int(seen.agent_node[e, other]), here, owner)
            if node == NOBODY:
                continue
            node, way = self._reached(ways, here, node)
            busy = (born.size - news) / PER_DECISION - (now - contact_step)
            if busy <= way < least:
                target, least = node, way
        return target

    def _place(
        self, e: int, other: int, contact_step: int, last: int, here: int, owner: int
    ) -> int:
        """Node `last` in which an agent was at step `contact_step`; `NOBODY` if it is not there."""
        if self._missed[e, other] == contact_step:
            return NOBODY
        if not self._is_near(here, last, int(self._moves[owner])):
            return last
        self._missed[e, other] = contact_step
        return NOBODY

    def _reached(self, ways: Ways, here: int, node: int) -> tuple[int, float]:
        """A node, or one beside it if moves of several nodes never end there, and the decisions."""
        for goal in (node, *self._graph.neighbours[node].tolist()):
            if goal >= 0 and (way := ways.decisions[row_to(ways, goal)][here]) != UNREACHED:
                return goal, float(way)
        return node, np.inf

    def _is_near(self, here: int, node: int, moves: int) -> bool:
        """True if it is not far to a node, nor around a corner."""
        rows, cols = self._graph.rows, self._graph.cols
        if max(abs(rows[node] - rows[here]), abs(cols[node] - cols[here])) > moves:
            return False
        away = self._graph.distances_from(np.array([node], np.int32))
        return bool(away[here] <= NEAR * moves)
