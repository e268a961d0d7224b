"""A search tree over sequences of actions, searched by discounted upper confidence bounds.

D-UCT of Best et al. (see this package): the others' plans change from round to round, so what a
simulation said counts less by a factor for each one since. Bound of a child: X + c R sqrt(ln N / n)
with the discounted mean X, counts n of the child and N of its parent, and the range R of utilities
seen (A. Garivier and E. Moulines, "On upper-confidence bound policies for switching bandit
problems", ALT 2011). Children are added as ceil(sqrt(N)) allows, those first that rollouts draw
first: progressive widening, R. Coulom, "Computing Elo ratings of move patterns in the game of Go",
ICGA Journal 30(4), 2007.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.graph_planner.graph.geodesics import Int32Array

NONE = -1


class Tree(NamedTuple):
    """Nodes in the order in which they were added; 0 is the root."""

    size: NDArray[np.int64]  # (1,)
    child: NDArray[np.int64]  # (node,) the child added last, -1 none
    sibling: NDArray[np.int64]  # (node,) the child of the same parent added before, -1 none
    action: NDArray[np.int64]  # (node,) that leads to it
    depth: NDArray[np.int64]  # (node,) actions from the root
    total: NDArray[np.float64]  # (node,) discounted sum of utilities, as of `last`
    visits: NDArray[np.float64]  # (node,) discounted number of simulations, as of `last`
    last: NDArray[np.int64]  # (node,) the simulation that passed it last
    best: NDArray[np.float64]  # (node,) largest utility of a simulation through it
    plan: Int32Array  # (node, step) the actions of that simulation, to its end
    length: NDArray[np.int64]  # (node,) how many
    bounds: NDArray[np.float64]  # (2,) least and largest utility seen


@kernel
def tree_of(nodes: int, longest: int) -> Tree:
    """Room for so many nodes, and sequences of so many actions; at first the root alone."""
    counts = np.zeros((6, nodes), np.int64)
    counts[1:3] = NONE
    sums, bounds = np.zeros((3, nodes)), np.array([np.inf, -np.inf])
    sums[2] = -np.inf
    size, plan = np.ones(1, np.int64), np.zeros((nodes, longest), np.int32)
    return Tree(
        size,
        counts[1],
        counts[2],
        counts[3],
        counts[4],
        sums[0],
        sums[1],
        counts[5],
        sums[2],
        plan,
        counts[0],
        bounds,
    )


@kernel
def step_down(
    tree: Tree, node: int, wanted: int, now: int, explore: float, forget: float
) -> tuple[int, bool]:
    """The child to go on to, and whether it was added for it.

    Parameters
    ----------
    wanted : the action that a rollout would take, for a child to be added
    now : number of this simulation
    explore, forget : factor of the bound; worth of a simulation one simulation later
    """
    parents = tree.visits[node] * forget ** (now - tree.last[node])
    spread, number, child = max(0.0, tree.bounds[1] - tree.bounds[0]), 0, tree.child[node]
    best, best_child, known = -np.inf, NONE, False
    log = np.log(max(1.0, parents))
    while child != NONE:
        n = max(1e-9, tree.visits[child] * forget ** (now - tree.last[child]))
        bound = tree.total[child] / tree.visits[child] + explore * spread * np.sqrt(log / n)
        if bound > best:
            best, best_child = bound, child
        known = known or tree.action[child] == wanted
        child, number = tree.sibling[child], number + 1
    if not known and number * number < max(1.0, parents) and tree.size[0] < tree.child.size:
        return _added(tree, node, wanted, now), True
    return best_child, False


@kernel
def _added(tree: Tree, parent: int, action: int, now: int) -> int:
    """A new child."""
    node = int(tree.size[0])
    tree.size[0] = node + 1
    tree.action[node], tree.depth[node] = action, tree.depth[parent] + 1
    tree.sibling[node], tree.child[parent] = tree.child[parent], node
    tree.last[node] = now
    return node


@kernel
def back_up(
    tree: Tree,
    path: NDArray[np.int64],
    plan: Int32Array,
    utility: float,
    now: int,
    forget: float,
) -> None:
    """Back up the result of a simulation to its nodes (node,).

    `plan`: (step,) the actions of the simulation, to its end.
    """
    tree.bounds[0], tree.bounds[1] = min(tree.bounds[0], utility), max(tree.bounds[1], utility)
    for node in path:
        worth = forget ** (now - tree.last[node])
        tree.total[node] = tree.total[node] * worth + utility
        tree.visits[node] = tree.visits[node] * worth + 1.0
        tree.last[node] = now
        if utility > tree.best[node]:
            tree.best[node], tree.length[node] = utility, plan.size
            tree.plan[node, : plan.size] = plan
