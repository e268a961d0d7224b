"""The scouts' part of a decision: one after the other plans a sweep, seen as done by the next."""

import numpy as np
from numpy.typing import NDArray

from graph_planner.belief_planner.covers import view_cover
from graph_planner.belief_planner.sweeps import LONGEST, Cover, search_sweep, sight, until_seen
from graph_planner.belief_planner.ways import ways_of
from graph_planner.belief_settings import BeliefSettings
from graph_planner.geodesics import Int32Array
from graph_planner.task import Task


class Scouting:
    """Those who look: given what each node is worth seeing, where each goes now."""

    def __init__(
        self, task: Task, settings: BeliefSettings, agents: NDArray[np.int64] | None = None
    ) -> None:
        graph, fleet, rules = task.graph, task.fleet, task.rules
        self.agents = fleet.discoverers if agents is None else agents
        self.covers: list[Cover] = [
            view_cover(
                graph,
                task.view_radii,
                int(task.radius_number[a]),
                int(fleet.moves[a]),
                rules.stay,
                rules.shorten,
            )
            for a in self.agents
        ]
        self._ends = [
            ways_of(graph, int(fleet.moves[a]), rules.stay, rules.shorten).ends for a in self.agents
        ]
        self._beam, self._depth = (6, 6) if settings.fast else (16, 10)
        if not settings.sweeps:
            self._beam, self._depth = 1, 1
        self._sight = sight(len(graph))
        self._path = np.zeros(self._depth, np.int32)

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
        mass : (cell,) what seeing each cell is worth; what the plans see is set to 0
        covers : one per scout; plain sight if not given
        """
        covers = covers or self.covers
        ends_at = agent_node[self.agents].copy()
        for i, agent in enumerate(self.agents):
            cover = covers[i]
            elsewhere = np.full(cover.decisions.shape[1], LONGEST)
            for j in range(len(self.agents)):
                if j != i:
                    until_seen(covers[j], ends_at[j], self._depth if j < i else 0, elsewhere)
            n = search_sweep(
                self._ends[i],
                cover,
                agent_node[agent],
                mass,
                elsewhere,
                self._beam,
                self._depth,
                self._sight,
                preferences[agent],
                self._path,
            )
            for node in self._path[:n]:
                mass[cover.cells[cover.start[node] : cover.start[node + 1]]] = 0.0
            if n:
                ends_at[i] = self._path[n - 1]
