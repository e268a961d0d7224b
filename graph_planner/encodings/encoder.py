"""What observation encoders have in common: their interface, levels, and who was where before."""

from typing import Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from graph_planner.compiled import inlined, kernel
from graph_planner.geodesics import Int32Array
from graph_planner.task import Observation

Levels: TypeAlias = NDArray[np.uint8]
Shapes: TypeAlias = dict[str, tuple[int, ...]]

TRAIL = 10
"""Positions in an agent's trail, the present one included (paper: a trail of 10)."""
MOST_ITEMS = 10
"""Believed items of a node at which its level is full."""
TOP = 255


class Encoder(Protocol):
    """Pictures of what the fleet knows, one set per agent."""

    @property
    def shapes(self) -> Shapes:
        """Name -> shape of one agent's array."""
        ...

    def reset(self, episodes: int) -> None:
        """Forget everything; get ready for a batch of so many episodes."""
        ...

    def see(self, seen: Observation, rows: NDArray[np.int64]) -> dict[str, Levels]:
        """Look at the episodes `rows` of the batch; the first decision of one clears its memory.

        Returns
        -------
        name -> (episode, agent, *shape) uint8; live arrays, in which other episodes keep what they
        had. Looking twice at one step changes nothing.
        """
        ...


@inlined
def item_level(items: int) -> int:
    """Level of a number of believed items."""
    return min(items, MOST_ITEMS) * TOP // MOST_ITEMS


@kernel
def remember_places(
    rows: NDArray[np.int64],
    step: Int32Array,
    agent_node: Int32Array,
    seen_at: Int32Array,
    trail: Int32Array,
) -> None:
    """Append the present nodes to the trails, newest first, once per step.

    Parameters
    ----------
    rows : (row,) episodes
    step : (episode,) the decision about to be taken
    seen_at : (episode,) step of the last look; written
    trail : (episode, agent, TRAIL) nodes, -1 for none; written
    """
    for e in rows:
        if step[e] <= 1:
            trail[e] = -1
        elif seen_at[e] == step[e]:
            continue
        seen_at[e] = step[e]
        for a in range(agent_node.shape[1]):
            for k in range(TRAIL - 1, 0, -1):
                trail[e, a, k] = trail[e, a, k - 1]
            trail[e, a, 0] = agent_node[e, a]


@inlined
def trail_level(age: int) -> int:
    """Level of a trail's node, `age` steps old: full where the agent is, then fading."""
    return TOP * (TRAIL - age) // TRAIL
