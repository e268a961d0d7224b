"""Distributions over sequences of actions: the plans that agents exchange.

Each agent keeps the best sequences of its tree and a chance for each, moved along the gradient of
E[f] + b H(q) with the temperature b falling from round to round: probability collectives, D. H.
Wolpert, S. R. Bieniawski and D. G. Rajnarayan, "Probability collectives in optimization", Handbook
of Statistics 31, 2013; used so by Best et al. (see this package).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.graph_planner.dec_mcts.search import TreeOptions
from mjforage.graph_planner.dec_mcts.tree import NONE, Tree
from mjforage.graph_planner.graph.geodesics import Int32Array

DEEPEST = 2  # actions that the tree must have settled of a sequence that is a candidate
_LEAST = 1e-4  # chance that a sequence keeps


class Plans(NamedTuple):
    """The agents' distributions; empty ones for agents that have not planned yet."""

    number: NDArray[np.int64]  # (agent,) sequences
    step: Int32Array  # (agent, candidate, step)
    length: NDArray[np.int64]  # (agent, candidate)
    chance: NDArray[np.float64]  # (agent, candidate)


@kernel
def plans_of(agents: int, candidates: int, longest: int) -> Plans:
    """No plans yet."""
    each = (agents, candidates)
    return Plans(
        np.zeros(agents, np.int64),
        np.zeros((agents, candidates, longest), np.int32),
        np.zeros(each, np.int64),
        np.zeros(each),
    )


@kernel
def drawn_plan(plans: Plans, agent: int, draw: float) -> int:
    """Number of a candidate, by a draw in [0, 1); -1 if there is none."""
    plan = NONE
    for c in range(plans.number[agent]):
        plan = c
        draw -= plans.chance[agent, c]
        if draw < 0.0:
            break
    return plan


@kernel
def likeliest(plans: Plans, agent: int) -> Int32Array:
    """The actions (step,) of an agent's likeliest sequence, none without a plan."""
    best = 0
    for c in range(plans.number[agent]):
        if plans.chance[agent, c] > plans.chance[agent, best]:
            best = c
    return plans.step[agent, best, : plans.length[agent, best]]


@kernel
def _same(plans: Plans, agent: int, plan: Int32Array) -> int:
    """Number of a candidate with these actions (step,), -1 if there is none."""
    n = plan.size
    for c in range(plans.number[agent]):
        if plans.length[agent, c] == n and (plans.step[agent, c, :n] == plan).all():
            return c
    return NONE


@kernel
def take_candidates(plans: Plans, agent: int, tree: Tree) -> None:
    """Replace an agent's sequences by the best of its tree; the likeliest one stays.

    The best are those of the largest discounted mean among nodes of at most `DEEPEST` actions, each
    with the best simulation that passed it. A sequence that stays keeps its chance, relative to the
    others.
    """
    candidates = plans.chance.shape[1]
    mean = np.full(tree.size[0], np.inf)
    for node in range(1, mean.size):
        if tree.depth[node] <= DEEPEST and tree.visits[node] > 0.0:
            mean[node] = -tree.total[node] / tree.visits[node]
    old_number, fair = plans.number[agent], 1.0 / candidates
    old = plans_of(1, candidates, plans.step.shape[2])
    old.number[0], old.step[0] = old_number, plans.step[agent]
    old.length[0], old.chance[0] = plans.length[agent], plans.chance[agent]
    if old_number > 0:
        keep = likeliest(old, 0)
        plans.step[agent, 0, : keep.size], plans.length[agent, 0] = keep, keep.size
        plans.chance[agent, 0], plans.number[agent] = old.chance[0].max(), 1
    for node in np.argsort(mean, kind="mergesort"):
        n = plans.number[agent]
        if mean[node] == np.inf or n == candidates:
            break
        plan = tree.plan[node, : tree.length[node]]
        if _same(plans, agent, plan) == NONE:
            before = _same(old, 0, plan)
            plans.step[agent, n, : plan.size], plans.length[agent, n] = plan, plan.size
            plans.chance[agent, n] = old.chance[0, before] if before != NONE else fair
            plans.number[agent] = n + 1
    n = plans.number[agent]
    if n:
        plans.chance[agent, :n] /= plans.chance[agent, :n].sum()


@kernel
def shift_chances(
    chance: NDArray[np.float64], value: NDArray[np.float64], heat: float, rate: float
) -> None:
    """One step along the gradient: q += rate q ((f - E[f]) / heat - H(q) - ln q), made to sum to 1.

    Parameters
    ----------
    chance : (candidate,) changed
    value : (candidate,) mean utility f of each, over what the others may do
    heat : temperature, as a utility
    """
    mean, entropy = (chance * value).sum(), -(chance * np.log(chance)).sum()
    for c in range(chance.size):
        pull = (value[c] - mean) / heat - entropy - np.log(chance[c])
        chance[c] = max(_LEAST, chance[c] + rate * chance[c] * pull)
    chance /= chance.sum()


@kernel
def end_turn(
    effort: TreeOptions,
    plans: Plans,
    agent: int,
    spread: float,
    turn: int,
    value: NDArray[np.float64],
) -> None:
    """Shift an agent's distribution towards its better plans, the colder the later its turn.

    Parameters
    ----------
    spread : of the utilities in its tree
    value : (candidate,) mean utility of each, over what the others may do
    """
    n, heat = plans.number[agent], effort.heat * effort.cool**turn * spread
    if n > 1 and heat > 0.0:
        shift_chances(plans.chance[agent, :n], value, heat, effort.rate)
