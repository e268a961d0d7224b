"""The scouts' part of a decision: one after the other plans a sweep, seen as done by the next."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.graph_planner.belief_planner.covers import view_cover
from mjforage.graph_planner.belief_planner.settings import BeliefSettings
from mjforage.graph_planner.belief_planner.sweeps import (
    LONGEST,
    Cover,
    Sight,
    lateness,
    search_sweep,
    sight,
    until_seen,
)
from mjforage.graph_planner.belief_planner.ways import ways_of
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.mission.task import Task


class Sweeper(NamedTuple):
    """Scouts that one search moves after the other, and scratch."""

    agents: NDArray[np.int64]  # (scout,) indices in the fleet
    kind: NDArray[np.int64]  # (scout,) which of the covers it has
    covers: tuple[Cover, ...]
    ends: tuple[Int32Array, ...]  # (node, 9) where their moves end
    beam: int  # plans kept
    depth: int  # decisions planned
    late: NDArray[np.float64]  # see `lateness`
    sight: Sight
    path: Int32Array  # (decision,)


@kernel
def _sweep(
    sweeper: Sweeper,
    agent_node: Int32Array,
    mass: NDArray[np.float64],
    preferences: NDArray[np.float64],
) -> None:
    """As `Scouting.look`."""
    agents, kind, covers, depth = sweeper.agents, sweeper.kind, sweeper.covers, sweeper.depth
    path, ends_at, scouts = sweeper.path, agent_node[sweeper.agents], sweeper.agents.size
    for i in range(scouts):
        cover = covers[kind[i]]
        elsewhere = np.full(cover.decisions.shape[1], LONGEST)
        for j in range(scouts):
            if j != i:
                delay = float(depth) if j < i else 0.0
                until_seen(covers[kind[j]], ends_at[j], delay, elsewhere)
        n = search_sweep(
            sweeper.ends[kind[i]],
            cover,
            agent_node[agents[i]],
            mass,
            elsewhere,
            sweeper.late,
            sweeper.beam,
            depth,
            i + 1 < scouts,
            sweeper.sight,
            preferences[agents[i]],
            path,
        )
        for node in path[:n]:
            for k in range(cover.start[node], cover.start[node + 1]):
                mass[cover.cells[k]] = 0.0
        if n:
            ends_at[i] = path[n - 1]


class Scouting:
    """Next nodes of scouts, given the worth of seeing each node."""

    def __init__(
        self, task: Task, settings: BeliefSettings, agents: NDArray[np.int64] | None = None
    ) -> None:
        graph, fleet = task.graph, task.fleet
        self.agents = fleet.discoverers if agents is None else agents
        self.covers: list[Cover] = [
            view_cover(
                graph,
                task.view_radii,
                int(task.radius_number[a]),
                int(fleet.moves[a]),
                task.rules,
                task.across_land,
            )
            for a in self.agents
        ]
        self._ends = [ways_of(graph, int(fleet.moves[a]), task.rules).ends for a in self.agents]
        self._beam, self._depth = (6, 6) if settings.fast else (16, 10)
        if not settings.sweeps:
            self._beam, self._depth = 1, 1
        self._late = lateness(settings.look_discount)
        self._sight = sight(len(graph))
        self._path = np.zeros(self._depth, np.int32)
        self._sweeps: dict[tuple[int, ...], BoundKernel[None]] = {}  # by who has which cover

    def look(
        self,
        agent_node: Int32Array,
        mass: NDArray[np.float64],
        preferences: NDArray[np.float64],
        covers: list[Cover] | None = None,
    ) -> None:
        """Overwrite the scouts' rows of preferences (agent, 9).

        Parameters
        ----------
        agent_node : (agent,)
        mass : (cell,) what seeing each cell is worth; overwritten
        covers : one per scout; plain sight if not given
        """
        covers = covers or self.covers
        if not covers:
            return
        which = tuple(map(id, covers))
        if which not in self._sweeps:
            self._sweeps[which] = BoundKernel(_sweep, self._sweeper(covers))
        self._sweeps[which](agent_node, mass, preferences)

    def _sweeper(self, covers: list[Cover]) -> Sweeper:
        """The scouts with a cover each; the same one for all that move and see alike."""
        kinds = list(dict.fromkeys(map(id, covers)))
        kind = np.array([kinds.index(id(cover)) for cover in covers], np.int64)
        first = [int(np.flatnonzero(kind == k)[0]) for k in range(len(kinds))]
        return Sweeper(
            self.agents,
            kind,
            tuple(covers[i] for i in first),
            tuple(self._ends[i] for i in first),
            self._beam,
            self._depth,
            self._late,
            self._sight,
            self._path,
        )
