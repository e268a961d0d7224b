"""The belief planner: plans on what can be known, see `mjforage.graph_planner.belief_planner`.

It uses the shared belief map, the agents' nodes, the step and the map, its own memory, and the
assumptions of the scenario's `[belief]` table; never the truth.
"""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.belief_planner.planner import BeliefPlanner
from mjforage.graph_planner.policies.registry import register
from mjforage.mission.task import Observation, Task


@register("belief")
class BeliefPolicy:
    """Plans on a belief: tracks, drift, hotspots, joint routes and planned sweeps."""

    def reset(self, task: Task, keys: UInt64Array) -> None:
        """Get ready for a batch of episodes (episode,)."""
        self.planner = BeliefPlanner(task, keys)

    def act(self, observation: Observation) -> NDArray[np.float64]:
        """Preferences (episode, agent, 9)."""
        return self.planner.act(observation)

    def forecast(self) -> NDArray[np.float64]:
        """(row, node) items expected, known and unseen ones, as of the last answer."""
        return self.planner.beliefs.forecast()
