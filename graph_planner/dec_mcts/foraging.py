"""Planning of the foragers in turns: each against the distributions over the others' tours."""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.graph_planner.belief_planner.boundary import Boundary
from mjforage.graph_planner.belief_planner.foraging import (
    Able,
    Foraging,
    Scratch,
    follow_routes,
    gather_legs,
)
from mjforage.graph_planner.belief_planner.routes import NOWHERE, Legs
from mjforage.graph_planner.belief_planner.settings import BeliefSettings
from mjforage.graph_planner.belief_planner.stops import Floating
from mjforage.graph_planner.belief_planner.taking import Taking
from mjforage.graph_planner.belief_planner.ways import Ways
from mjforage.graph_planner.dec_mcts.plans import (
    Plans,
    end_turn,
    likeliest,
    plans_of,
    take_candidates,
)
from mjforage.graph_planner.dec_mcts.search import DecisionContext, TreeOptions, begin
from mjforage.graph_planner.dec_mcts.tours import (
    claims_of,
    sample_claims,
    simulate_tour,
    tour_value,
)
from mjforage.graph_planner.dec_mcts.tree import Tree, tree_of
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.mission.task import Task

_TURNS = 1 << 20  # where the indices of draws begin


@kernel
def plan_turn(
    effort: TreeOptions,
    legs: Legs,
    forager: int,
    tree: Tree,
    plans: Plans,
    follows: NDArray[np.float64],
    turn: int,
    key: np.uint64,
    step: int,
) -> None:
    """One agent's turn in a round: its tree grows, and its distribution with it."""
    state = begin(key, _TURNS + turn * legs.kind.size + forager, step)
    claims = claims_of(legs.weight.size)
    for s in range(effort.simulations):
        sample_claims(effort, legs, plans, forager, follows, state, claims)
        now = turn * effort.simulations + s
        simulate_tour(effort, legs, forager, tree, claims, now, state)
    take_candidates(plans, forager, tree)
    n = plans.number[forager]
    value = np.zeros(n)
    for _ in range(effort.samples):
        sample_claims(effort, legs, plans, forager, follows, state, claims)
        for c in range(n):
            plan = plans.step[forager, c, : plans.length[forager, c]]
            value[c] += tour_value(effort, legs, forager, plan, claims) / effort.samples
    end_turn(effort, plans, forager, tree.bounds[1] - tree.bounds[0], turn, value)


@kernel
def search_tours(
    effort: TreeOptions, legs: Legs, follows: NDArray[np.float64], key: np.uint64, step: int
) -> NDArray[np.int64]:
    """The stop that each forager goes to first (forager,), `NOWHERE` where it has no plan.

    `follows`: (forager,) chance that each follows its known plan; `key`, `step`: of the draws.
    """
    foragers, n = legs.first.shape
    longest = min(effort.depth, n)
    plans = plans_of(foragers, effort.candidates, longest)
    nodes = effort.rounds * effort.simulations + 1
    trees = [tree_of(nodes, longest) for _ in range(foragers)]
    for turn in range(effort.rounds):
        for f in range(foragers):
            plan_turn(effort, legs, f, trees[f], plans, follows, turn, key, step)
    target = np.full(foragers, NOWHERE, np.int64)
    for f in range(foragers):
        if plans.number[f]:
            tour = likeliest(plans, f)
            if tour.size:
                target[f] = tour[0]
    return target


@kernel
def _plan_tours(
    items: Floating,
    boundary: Boundary,
    ways: tuple[Ways, ...],
    able: Able,
    agent_node: Int32Array,
    agent_yaw: NDArray[np.float64],
    drift_rc: NDArray[np.float64],
    stay: bool,
    taking: Taking,
    scratch: Scratch,
    preferences: NDArray[np.float64],
    effort: TreeOptions,
    follows: NDArray[np.float64],
    key: np.uint64,
    step: int,
) -> int:
    """As `Foraging.send`, by `search_tours`."""
    found = scratch.found
    about = items, boundary, ways, able, agent_node
    legs = gather_legs(*about, agent_yaw, drift_rc, stay, taking, found)
    n = legs.weight.size
    if n == 0 or able.agents.size == 0:
        return 0
    target = search_tours(effort, legs, follows[able.agents], key, step)
    follow_routes(*about, legs.first, target, scratch, preferences)
    return int(n)


class TreeForaging(Foraging):
    """Foragers, each with its own tree."""

    def __init__(
        self, task: Task, settings: BeliefSettings, effort: TreeOptions, context: DecisionContext
    ) -> None:
        super().__init__(task, settings)
        self._search, self._context, self._stay = effort, context, task.rules.stay

    def send(
        self,
        agent_node: Int32Array,
        agent_yaw: NDArray[np.float64],
        drift_rc: NDArray[np.float64],
        room_left: NDArray[np.int64],
        energy_left: NDArray[np.float64],
        preferences: NDArray[np.float64],
    ) -> int:
        """As the belief planner's, by trees."""
        context = self._context
        return _plan_tours(
            self.items,
            self.boundary,
            self.group.ways,
            self.able_now(room_left, energy_left),
            agent_node,
            agent_yaw,
            drift_rc,
            self._stay,
            self.taking,
            self._scratch,
            preferences,
            self._search,
            context.follows,
            context.key,
            context.step,
        )
