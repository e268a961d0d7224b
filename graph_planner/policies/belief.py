"""The belief planner: plans on what can be known, see `mjforage.graph_planner.belief_planner`.

It uses the shared belief map, the agents' nodes, the step and the map, its own memory, and the
scenario's `[prior]`; never the truth.
"""

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.belief_planner.planner import BeliefPlanner
from mjforage.graph_planner.belief_planner.settings import LAW_OF_ITEMS, BeliefOptions
from mjforage.graph_planner.policies.registry import register
from mjforage.mission.task import Observation, Task
from mjforage.scenario.schema import check_fields


@register("belief")
class BeliefPolicy(BeliefOptions):
    """Plans on a belief: tracks, drift, hotspots, joint routes and planned sweeps."""

    told: ClassVar[str] = LAW_OF_ITEMS

    def __post_init__(self) -> None:
        check_fields(self, "policy belief")

    def reset(self, task: Task, keys: UInt64Array) -> None:
        """Get ready for a batch of episodes (episode,)."""
        self.planner = BeliefPlanner(task, keys, self)

    def act(self, observation: Observation) -> NDArray[np.float64]:
        """Preferences (episode, agent, 9)."""
        return self.planner.act(observation)

    def forecast(self) -> NDArray[np.float64]:
        """(row, node) items expected, known and unseen ones, as of the last answer."""
        return self.planner.beliefs.forecast()
