"""Online greedy with reassignment: foragers meet drifting items where they will be.

Pairs of an agent and an item are made in the order of reward over time to meet, anew at every
decision (`meeting`): the idea of Heine, "Team Orienteering with Moving Targets", from a summary of
it. Drift and unseen items are believed as the belief planner believes them, scouts look where most
is expected (`tracking_team`).
"""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.option_ranges import check_at_least, check_positive
from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.policies.registry import register
from mjforage.graph_planner.policy_parts.meeting import Sea, assign
from mjforage.graph_planner.policy_parts.tracking_team import TrackingTeam
from mjforage.mission.task import Observation, Task


@register("ogr")
class OgrPolicy:
    """Pairs of forager and drifting item by reward over time to meet, made anew every decision.

    Parameters
    ----------
    ahead : items that a forager is given at most in one decision
    patience : added to the time of a scout's way in its bids; larger: it goes farther [decision]
    """

    def __init__(self, ahead: int = 6, patience: float = 4.0) -> None:
        check_at_least("ogr", 1, ahead=ahead)
        check_positive("ogr", patience=patience)
        self._ahead, self._patience = int(ahead), float(patience)

    def reset(self, task: Task, keys: UInt64Array) -> None:
        """Get ready for a batch of episodes (episode,)."""
        self._team = TrackingTeam(task, keys, self._patience)
        self._rules = task.rules.stay, float(task.horizon)

    def act(self, observation: Observation) -> NDArray[np.float64]:
        """Preferences (episode, agent, 9): down the way to where each meets what it is given."""
        return self._team.act(observation, self._give_goals)

    def forecast(self) -> NDArray[np.float64]:
        """(row, node) items expected, known and unseen ones, as of the last answer."""
        return self._team.beliefs.forecast()

    def _give_goals(self, seen: Observation, e: int, goals: Int32Array) -> None:
        collecting = self._team.collecting
        able, group = collecting.able_now(seen.room_left[e], seen.energy_left[e]), collecting.group
        if not able.agents.size:
            return
        drift = self._team.beliefs.wind.mean[e]
        sea = Sea(collecting.boundary, group.ways, drift, collecting.taking, *self._rules)
        found = np.empty(able.agents.size, np.int32)
        assign(sea, able, seen.agent_node[e][able.agents], collecting.items, self._ahead, found)
        goals[np.isin(group.agents, able.agents)] = found
