"""The oracle: foragers that see every item and the drift. No policy but a bound.

It searches routes as the belief planner does, with the truth in place of a belief, so that the
difference between the two is what is not known. Only the independent noise of the items to come is
hidden from it. Its scouts look at true items that the fleet's map does not show as they are.

It bounds the mean and not every episode: routes are found by a beam search, and they minimise the
times at which items are met, not how many are met before the foragers' energy is spent.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from graph_planner.belief_planner.foraging import Foraging
from graph_planner.belief_planner.scouting import Scouting
from graph_planner.belief_planner.stops import floating
from graph_planner.policies.registry import register
from graph_planner.randomness import UInt64Array
from graph_planner.task import Observation, Task, Truth


@register("oracle")
class OraclePolicy:
    """A bound, not a policy: foragers see every item and its drift; joint multi-item routes."""

    def reset(self, task: Task, keys: UInt64Array) -> None:
        """Get ready for a batch of episodes (episode,)."""
        settings = replace(task.belief, joint=True, sweeps=True)
        self._foragers = Foraging(task, settings)
        self._scouts = Scouting(task, settings)
        self._nodes = len(task.graph)
        self._preferences = np.zeros((keys.size, len(task.fleet), 9))

    def reveal(self, truth: Truth) -> None:
        """Take in where the items are."""
        self._truth = truth

    def act(self, observation: Observation) -> NDArray[np.float64]:
        """Preferences (episode, agent, 9)."""
        truth = self._truth
        if truth.item_node.shape[1] > self._foragers.items.row.size:
            self._foragers.items = floating(truth.item_node.shape[1])
        items = self._foragers.items
        for e in np.flatnonzero(observation.active):
            at, preferences = observation.agent_node[e], self._preferences[e]
            present = truth.item_node[e] >= 0
            counts = np.bincount(truth.item_node[e][present], minlength=self._nodes)
            n = int(present.sum())
            items.number[0] = n
            items.row[:n], items.col[:n] = truth.item_rc[e][present].T
            items.weight[:n] = 1.0
            room, energy = observation.room_left[e], observation.energy_left[e]
            yaw, drift = observation.agent_yaw[e], truth.drift_rc[e]
            self._foragers.send(at, yaw, drift, room, energy, preferences)
            self._foragers.hold(at, room, energy, preferences)
            age = np.minimum(30.0, observation.step[e] - 1.0 - observation.last_seen[e])
            wrong = (counts != observation.belief[e]) + 0.1 * (counts > 0)
            self._scouts.look(at, wrong * age, preferences)
        return self._preferences
