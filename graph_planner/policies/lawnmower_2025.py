"""Lawnmower of the group's paper of 2025 (IEEE RA-L 10(5):4930, preprint arXiv 2412.02316).

Every agent sweeps alone and ignores items. Its forward direction is drawn per episode, its side is
a quarter turn clockwise. It goes forward until the end node is no node, up to two moves to the
side, back until blocked, up to two moves to the same side, and forward again. Where the side is
blocked it backs out until the side is free. If the move so chosen is blocked, the side becomes the
forward direction and is tried at once, blocked or not.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.base.randomness import Stream, stream_key, uniform
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.policies.registry import register
from mjforage.graph_planner.policy_parts.final_moves import make_final
from mjforage.graph_planner.policy_parts.kernel_policy import KernelPolicy, Preferences
from mjforage.graph_planner.policy_parts.seeking import possible_targets
from mjforage.mission.task import Observation, Task, TaskArrays

LANE, SIDE, OUT = 0, 1, 2
"""Legs: along a lane, to the side, and out of a dead end."""
UNDRAWN = -1


class Mower(NamedTuple):
    """State of the agents' sweeps."""

    forward: NDArray[np.int64]  # (episode, agent) direction 0-7
    back: NDArray[np.int64]  # (episode, agent) 1 on a lane that leads back, else 0
    leg: NDArray[np.int64]  # (episode, agent)
    aside: NDArray[np.int64]  # (episode, agent) moves to the side; cleared when a lane follows


@kernel
def _next_move(mower: Mower, ends: Int32Array, e: int, a: int) -> int:
    """The next move of an agent, whose moves end in `ends` (9,), -1 blocked."""
    forward, back, leg, aside = mower.forward, mower.back, mower.leg, mower.aside
    ahead, side = int((forward[e, a] + 4 * back[e, a]) % 8), int((forward[e, a] + 2) % 8)
    if leg[e, a] == LANE and ends[ahead] >= 0:
        return ahead
    if leg[e, a] == SIDE and (aside[e, a] >= 2 or ends[side] < 0):
        back[e, a] = 1 - back[e, a]
        move = (ahead + 4) % 8
        if ends[move] >= 0:
            leg[e, a], aside[e, a] = LANE, 0
    elif ends[side] >= 0:
        leg[e, a], move = SIDE, side
        aside[e, a] += 1
    else:
        leg[e, a], move = OUT, (ahead + 4) % 8
    if ends[move] < 0:
        forward[e, a], back[e, a], leg[e, a], move = side, 0, LANE, side
    return move


@kernel
def _mow(
    arrays: TaskArrays, mower: Mower, preferences: NDArray[np.float64], seen: Observation
) -> None:
    """Take the next move of every sweep; fill preferences."""
    n_agents = seen.agent_node.shape[1]
    targets = np.empty((n_agents, 9), np.int32)
    for e in range(seen.active.size):
        if not seen.active[e]:
            continue
        key = stream_key(seen.keys[e], Stream.POLICY)
        possible_targets(arrays, seen.agent_node[e], targets)
        for a in range(n_agents):
            if mower.forward[e, a] == UNDRAWN:
                mower.forward[e, a] = int(8 * uniform(key, a, 0))
            make_final(preferences[e, a], _next_move(mower, targets[a], e, a))


@register("lawnmower-2025")
class Lawnmower2025Policy(KernelPolicy):
    """Lawnmower of the paper of 2025: lanes in a drawn direction, items ignored."""

    def filled(self, task: Task, preferences: Preferences) -> BoundKernel[None]:
        """The next move of the sweep."""
        agents = preferences.shape[:2]
        forward, zeros = np.full(agents, UNDRAWN), (np.zeros(agents, np.int64) for _ in range(3))
        self.mower = Mower(forward, *zeros)
        return BoundKernel(_mow, task.arrays, self.mower, preferences)
