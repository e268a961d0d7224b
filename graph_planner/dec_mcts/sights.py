"""Simulation of a scout: what a sequence of moves shows beside what the others may see.

A cell of a cover counts once, its mass by `look_discount` to the power of the decisions until it is
first seen. A sequence's utility is what the fleet gains by it. For mass that it leaves over counts
how much sooner the landmark that it belongs to could be seen afterwards.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined, kernel
from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.belief_planner.sweeps import SEEN, Cover
from mjforage.graph_planner.belief_planner.ways import UNREACHED
from mjforage.graph_planner.dec_mcts.plans import Plans, drawn_plan
from mjforage.graph_planner.dec_mcts.search import TreeOptions, draw
from mjforage.graph_planner.dec_mcts.tree import NONE, Tree, back_up, step_down
from mjforage.graph_planner.graph.geodesics import Int32Array

ROAM = 0.1  # of the largest view: what `roam` adds to a move of a rollout at most
PULL = 0.25  # of the largest view: what a decision nearer to its landmark is worth to it
LONGEST = 1024  # decisions after which a view is worth nothing


class Scouts(NamedTuple):
    """Scouts, and the hotspots and nodes to see."""

    kind: NDArray[np.int64]  # (scout,) which of the covers, and of `ends`
    at: Int32Array  # (scout,) node
    ends: Int32Array  # (kind, node, 9) where moves end, -1 illegal
    covers: tuple[Cover, ...]  # (kind,)
    mass: NDArray[np.float64]  # (cell,)
    total: NDArray[np.float64]  # (landmark,) mass that belongs to it


class Sights(NamedTuple):
    """Cells seen in a sample of the others' plans, and in the simulation at hand."""

    token: NDArray[np.int64]  # (2,) of the sample, and of the simulation
    others: NDArray[np.int64]  # (cell,) token of the sample in which others saw it
    worth: NDArray[np.float64]  # (cell,) of seeing it when the first of them does
    mine: NDArray[np.int64]  # (cell,) token of the simulation that saw it
    left: NDArray[np.float64]  # (landmark,) mass that the others leave over
    elsewhere: NDArray[np.float64]  # (landmark,) worth of seeing it when one of them could
    rest: NDArray[np.float64]  # (landmark,) mass that the simulation leaves over too
    fade: NDArray[np.float64]  # (decision,) worth of a view after so many decisions


def sights_of(cells: int, landmarks: int, discount: float) -> Sights:
    """Scratch for so many cells; discount is the worth of a view a decision later."""
    stamps, marks = np.zeros((2, cells), np.int64), np.zeros((3, landmarks))
    token, worth = np.zeros(2, np.int64), np.zeros(cells)
    fade = np.array([discount**decisions for decisions in range(LONGEST)], np.float64)
    return Sights(token, stamps[0], worth, stamps[1], marks[0], marks[1], marks[2], fade)


@inlined
def faded(fade: NDArray[np.float64], decisions: int) -> float:
    """Worth of what is in view after so many decisions, but not at once; 0 if never."""
    return float(fade[max(1, decisions)]) if decisions < LONGEST else 0.0


@kernel
def sample_sights(
    effort: TreeOptions,
    scouts: Scouts,
    plans: Plans,
    scout: int,
    follows: NDArray[np.float64],
    state: UInt64Array,
    sights: Sights,
) -> None:
    """Draw the views of the others.

    `follows`: (scout,) chance that each follows its known plan; `sights`: filled.
    """
    sights.token[0] += 1
    token, others, earliest = sights.token[0], sights.others, sights.worth
    left, elsewhere, mass = sights.left, sights.elsewhere, scouts.mass
    left[:], elsewhere[:] = scouts.total, 0.0
    for g in range(scouts.kind.size):
        if g == scout or draw(state) >= follows[g]:
            continue
        cover, c = scouts.covers[scouts.kind[g]], drawn_plan(plans, g, draw(state))
        start, cells, landmark = cover.start, cover.cells, cover.landmark
        decisions, fade = cover.decisions, sights.fade
        worth, end = 1.0, scouts.at[g]
        for i in range(plans.length[g, c] if c != NONE else 0):
            end = scouts.ends[scouts.kind[g], end, plans.step[g, c, i]]
            worth *= effort.look_discount
            for k in range(start[end], start[end + 1]):
                cell = cells[k]
                if mass[cell] <= 0.0:
                    continue
                if others[cell] != token:
                    others[cell], earliest[cell] = token, worth
                    left[landmark[cell]] -= mass[cell]
                elif worth > earliest[cell]:
                    earliest[cell] = worth
        for mark in range(left.size):
            then = worth * faded(fade, int(decisions[end, mark]))
            elsewhere[mark] = max(elsewhere[mark], then)


@kernel
def seen_from(
    scouts: Scouts, cover: Cover, end: int, worth: float, sights: Sights, keep: bool
) -> float:
    """Gain of the fleet if a scan from a node comes when a view has some worth.

    `keep`: True if the simulation sees it by that, else it only asks.
    """
    start, cells, landmark, mass = cover.start, cover.cells, cover.landmark, scouts.mass
    mine, others, earliest, rest = sights.mine, sights.others, sights.worth, sights.rest
    sample, token, gain = sights.token[0], sights.token[1], 0.0
    for k in range(start[end], start[end + 1]):
        cell = cells[k]
        if mass[cell] <= 0.0 or mine[cell] == token:
            continue
        theirs = earliest[cell] if others[cell] == sample else 0.0
        gain += mass[cell] * max(0.0, worth - theirs)
        if keep:
            mine[cell] = token
            if others[cell] != sample:
                rest[landmark[cell]] -= mass[cell]
    return gain


@kernel
def left_unseen(cover: Cover, end: int, worth: float, sights: Sights) -> float:
    """Worth of what is left, by how much sooner a scout that ends in a node could see it."""
    value, decisions, fade = 0.0, cover.decisions, sights.fade
    rest, elsewhere = sights.rest, sights.elsewhere
    for mark in range(rest.size):
        if rest[mark] > SEEN:
            then = worth * faded(fade, int(decisions[end, mark]))
            value += rest[mark] * max(0.0, then - elsewhere[mark])
    return value


@kernel
def sweep_value(
    effort: TreeOptions, scouts: Scouts, s: int, plan: Int32Array, sights: Sights
) -> float:
    """Utility of a sequence of moves (step,) of a scout."""
    kind, end, worth, value = scouts.kind[s], scouts.at[s], 1.0, 0.0
    cover = scouts.covers[kind]
    sights.token[1] += 1
    sights.rest[:] = sights.left
    for move in plan:
        end, worth = scouts.ends[kind, end, move], worth * effort.look_discount
        value += seen_from(scouts, cover, end, worth, sights, True)
    return value + left_unseen(cover, end, worth, sights)


@kernel
def _drawn_mark(cover: Cover, end: int, sights: Sights, state: UInt64Array) -> int:
    """A landmark to head for, drawn by the mass left there and how soon; -1 if none is left."""
    best, target, decisions, fade = 0.0, NONE, cover.decisions, sights.fade
    rest, elsewhere = sights.rest, sights.elsewhere
    for mark in range(rest.size):
        if decisions[end, mark] == UNREACHED or rest[mark] <= SEEN:
            continue
        worth = faded(fade, int(decisions[end, mark])) - elsewhere[mark]
        pull = rest[mark] * max(1e-6, worth) * draw(state)
        if pull > best:
            best, target = pull, mark
    return target


@kernel
def _next_move(
    effort: TreeOptions,
    scouts: Scouts,
    kind: int,
    end: int,
    worth: float,
    mark: int,
    most: float,
    sights: Sights,
    state: UInt64Array,
) -> int:
    """The move that a rollout makes: about the one that shows most, or that nears its landmark."""
    cover, best, best_move = scouts.covers[kind], -np.inf, NONE
    ends, decisions, roam = scouts.ends[kind, end], cover.decisions, effort.roam
    for move in range(9):
        target = ends[move]
        if target < 0:
            continue
        score = seen_from(scouts, cover, target, worth, sights, False) / (most * worth)
        score += ROAM * roam * draw(state)
        if mark != NONE:
            score -= PULL * float(decisions[target, mark])
        if score > best:
            best, best_move = score, move
    return best_move


@kernel
def simulate_sweep(
    effort: TreeOptions,
    scouts: Scouts,
    s: int,
    most: float,
    tree: Tree,
    sights: Sights,
    now: int,
    state: UInt64Array,
) -> None:
    """One simulation: down the tree, one node more, and on by a rollout.

    `most`: mass that a look shows at most; `now`: its number.
    """
    kind, end, worth, value = scouts.kind[s], scouts.at[s], 1.0, 0.0
    cover, longest = scouts.covers[kind], effort.depth
    path, plan = np.zeros(longest + 1, np.int64), np.empty(longest, np.int32)
    sights.token[1] += 1
    sights.rest[:] = sights.left
    mark, inside, passed = _drawn_mark(cover, end, sights, state), True, 1
    for n in range(longest):
        worth *= effort.look_discount
        if mark != NONE and (cover.decisions[end, mark] == 0 or sights.rest[mark] <= SEEN):
            mark = _drawn_mark(cover, end, sights, state)
        move = _next_move(effort, scouts, kind, end, worth, mark, most, sights, state)
        if move == NONE:
            plan = plan[:n]
            break
        if inside:
            node, added = step_down(
                tree, path[passed - 1], move, now, effort.explore, effort.forget
            )
            inside = node != NONE and not added
            if node != NONE:
                path[passed], move, passed = node, tree.action[node], passed + 1
        plan[n], end = move, scouts.ends[kind, end, move]
        value += seen_from(scouts, cover, end, worth, sights, True)
    value += left_unseen(cover, end, worth, sights)
    back_up(tree, path[:passed], plan, value, now, effort.forget)
