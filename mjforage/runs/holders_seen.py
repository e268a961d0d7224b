"""What each holder knows at one step of an episode, copied while it is played again."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mjforage.mission.mission import Mission, Observer
from mjforage.mission.task import NEVER

UNSEEN = -1
"""Age of a node that a holder knows no look at."""


@dataclass(frozen=True)
class HoldersMaps:
    """What all holders of an episode know at a step; one holder if they share all they see."""

    step: int
    names: tuple[str, ...]  # (agent,)
    owner_of: NDArray[np.int64]  # (agent,)
    belief: NDArray[np.int16]  # (holder, row, column) items when the node was last seen
    age: NDArray[np.int32]  # (holder, row, column) steps since then, `UNSEEN` if never
    agent_rc: NDArray[np.int64]  # (holder, agent, 2) where each was last heard of [node]
    agent_age: NDArray[np.int64]  # (holder, agent) steps since then


class HoldersSeen(Observer):
    """Copies what the holders of a batch's first episode know at a step, or at the end before it.

    Attributes
    ----------
    maps : once the episode was played
    """

    maps: HoldersMaps

    def __init__(self, step: int) -> None:
        self._step = step

    def see(self, mission: Mission) -> None:
        """Copy them, until the step is over."""
        step = int(mission.step[0])
        if step > self._step:
            return
        exchange, graph = mission.exchange, mission.setup.graph
        own = slice(0, exchange.owners)  # rows of the first episode
        known = exchange.knowledge
        last_seen = known.last_seen[own]
        age = np.where(last_seen == NEVER, UNSEEN, step - last_seen.astype(np.int32))
        at = known.agent_node[own]
        self.maps = HoldersMaps(
            step,
            mission.setup.fleet.names,
            exchange.owner_of.copy(),
            graph.grid(known.belief[own]).astype(np.int16),
            graph.grid(age).astype(np.int32),
            np.stack((graph.rows[at], graph.cols[at]), axis=-1).astype(np.int64),
            step - known.agent_seen[own].astype(np.int64),
        )
