"""Planning of the scouts in turns: each against the distributions over the others' sweeps."""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.graph_planner.belief_planner.scouting import Scouting
from mjforage.graph_planner.belief_planner.settings import BeliefSettings
from mjforage.graph_planner.belief_planner.sweeps import Cover
from mjforage.graph_planner.dec_mcts.plans import (
    Plans,
    end_turn,
    likeliest,
    plans_of,
    take_candidates,
)
from mjforage.graph_planner.dec_mcts.search import DecisionContext, TreeOptions, begin
from mjforage.graph_planner.dec_mcts.sights import (
    Scouts,
    Sights,
    sample_sights,
    sights_of,
    simulate_sweep,
    sweep_value,
)
from mjforage.graph_planner.dec_mcts.tree import Tree, tree_of
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.mission.task import Task

_TURNS = 1 << 24  # where the indices of draws begin
LEAST_MASS = 1e-12  # below which there is nothing to look for


@kernel
def _most_in_view(scouts: Scouts, kind: int) -> float:
    """Mass that one look of a scout of a kind shows at most."""
    cover, most = scouts.covers[kind], 0.0
    start, cells = cover.start, cover.cells
    for node in range(start.size - 1):
        visible = 0.0
        for k in range(start[node], start[node + 1]):
            visible += scouts.mass[cells[k]]
        most = max(most, visible)
    return most


@kernel
def plan_turn(
    effort: TreeOptions,
    scouts: Scouts,
    scout: int,
    most: float,
    tree: Tree,
    plans: Plans,
    follows: NDArray[np.float64],
    sights: Sights,
    turn: int,
    key: np.uint64,
    step: int,
) -> None:
    """One agent's turn in a round: its tree grows, and its distribution with it."""
    state = begin(key, _TURNS + turn * scouts.kind.size + scout, step)
    for s in range(effort.simulations):
        sample_sights(effort, scouts, plans, scout, follows, state, sights)
        now = turn * effort.simulations + s
        simulate_sweep(effort, scouts, scout, most, tree, sights, now, state)
    take_candidates(plans, scout, tree)
    n = plans.number[scout]
    value = np.zeros(n)
    for _ in range(effort.samples):
        sample_sights(effort, scouts, plans, scout, follows, state, sights)
        for c in range(n):
            plan = plans.step[scout, c, : plans.length[scout, c]]
            value[c] += sweep_value(effort, scouts, scout, plan, sights) / effort.samples
    end_turn(effort, plans, scout, tree.bounds[1] - tree.bounds[0], turn, value)


@kernel
def search_sweeps(
    effort: TreeOptions,
    scouts: Scouts,
    follows: NDArray[np.float64],
    sights: Sights,
    key: np.uint64,
    step: int,
    preferences: NDArray[np.float64],
) -> None:
    """Fill preferences (scout, 9): the first move of each scout's likeliest sequence.

    `follows`: (scout,) chance that each follows its known plan; `key`, `step`: of the draws.
    """
    n = scouts.kind.size
    scouts.total[:] = 0.0
    landmark = scouts.covers[0].landmark
    for cell in range(scouts.mass.size):
        scouts.total[landmark[cell]] += max(0.0, scouts.mass[cell])
    plans = plans_of(n, effort.candidates, effort.depth)
    nodes = effort.rounds * effort.simulations + 1
    trees = [tree_of(nodes, effort.depth) for _ in range(n)]
    most = [_most_in_view(scouts, kind) for kind in range(scouts.ends.shape[0])]
    for turn in range(effort.rounds):
        for s in range(n):
            shows = max(LEAST_MASS, most[scouts.kind[s]])
            plan_turn(effort, scouts, s, shows, trees[s], plans, follows, sights, turn, key, step)
    for s in range(n):
        for move in range(9):
            legal = scouts.ends[scouts.kind[s], scouts.at[s], move] >= 0
            preferences[s, move] = 0.0 if legal else -np.inf
        if plans.number[s]:
            sweep = likeliest(plans, s)
            if sweep.size:
                preferences[s, sweep[0]] = 1.0


class TreeScouting(Scouting):
    """Scouts, each with its own tree."""

    def __init__(
        self,
        task: Task,
        settings: BeliefSettings,
        agents: NDArray[np.int64],
        effort: TreeOptions,
        context: DecisionContext,
    ) -> None:
        super().__init__(task, settings, agents)
        self._search, self._context = effort, context
        able = [(task.fleet.moves[a], task.fleet.radius[a]) for a in agents]
        kinds = sorted(set(able))
        self._kind = np.array([kinds.index(each) for each in able], np.int64)
        self._first = [able.index(each) for each in kinds]  # a scout of each kind
        if able:
            self._ends_of = np.stack([self._ends[i] for i in self._first])
        self._sights: dict[tuple[int, int], Sights] = {}

    def look(
        self,
        agent_node: Int32Array,
        mass: NDArray[np.float64],
        preferences: NDArray[np.float64],
        covers: list[Cover] | None = None,
    ) -> None:
        """As `Scouting.look`, but mass stays as it is."""
        if not self.agents.size:
            return
        covers = covers or self.covers
        kinds = tuple(covers[i] for i in self._first)
        marks = kinds[0].decisions.shape[1]
        size = mass.size, marks
        sights = self._sights.get(size)
        if sights is None:
            sights = sights_of(*size, self._search.look_discount)
            self._sights[size] = sights
        at = agent_node[self.agents]
        scouts = Scouts(self._kind, at, self._ends_of, kinds, mass, np.zeros(marks))
        context, mine = self._context, np.empty((at.size, 9))
        follows = context.follows[self.agents]
        search_sweeps(self._search, scouts, follows, sights, context.key, context.step, mine)
        preferences[self.agents] = mine
