"""The oracle: foragers that see every item and its drift. It is a bound, not a policy.

It searches routes as the belief planner does, with the truth in place of a belief, so that the
difference between the two is the value of what the planner does not know. Only gusts and the
independent noise of the items to come are hidden from it. Its scouts look at true items where the
fleet's map differs from the truth.

It bounds the mean and not every episode: routes are found by a beam search, and they minimise the
times at which items are met, not the number met before the foragers' energy is spent.

`oracle(received=true)` acts by what each owner has received, as policies do over a link: of the
items in the scans received it knows the truth, and their drift; it searches for the others, and
maintains contact, as the belief planner does. The belief planner's gap to it is the cost of not
knowing those items; its own gap to the oracle is the cost of searching and of the link.
"""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.belief_planner.foraging import Foraging
from mjforage.graph_planner.belief_planner.planner import BeliefPlanner
from mjforage.graph_planner.belief_planner.privileged_beliefs import PrivilegedBeliefs
from mjforage.graph_planner.belief_planner.scouting import Scouting
from mjforage.graph_planner.belief_planner.settings import BeliefSettings
from mjforage.graph_planner.belief_planner.stops import floating
from mjforage.graph_planner.policies.registry import register
from mjforage.mission.plain import Plain, plain_truth
from mjforage.mission.task import GroundTruth, Observation, Task


@register("oracle")
class OraclePolicy:
    """A bound, not a policy: foragers see every item and its drift; joint multi-item routes."""

    def __init__(self, received: bool = False) -> None:
        self.decentralised = received

    def reset(self, task: Task, keys: UInt64Array) -> None:
        """Get ready for a batch of episodes (episode,)."""
        self._task = task
        if self.decentralised:
            self._planner = BeliefPlanner(task, keys, believing=PrivilegedBeliefs)
            return
        settings = BeliefSettings.of(task.prior)
        self._foragers = Foraging(task, settings)
        self._scouts = Scouting(task, settings)
        self._nodes = len(task.graph)
        self._plain = Plain(task, keys.size)
        self._preferences = np.zeros((keys.size, len(task.fleet), 9))

    def set_ground_truth(self, truth: GroundTruth) -> None:
        """Take in where the items are."""
        self._truth = plain_truth(truth, self._task)

    def act(self, observation: Observation) -> NDArray[np.float64]:
        """Preferences (episode, agent, 9)."""
        truth = self._truth
        if self.decentralised:
            beliefs = self._planner.beliefs
            assert isinstance(beliefs, PrivilegedBeliefs)
            beliefs.set_ground_truth(truth)
            return self._planner.act(observation)
        observation = self._plain(observation)
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
            yaw, drift = observation.agent_yaw[e], truth.item_drift_rc[e][present]
            self._foragers.send(at, yaw, drift, room, energy, preferences)
            self._foragers.hold(at, room, energy, preferences)
            age = np.minimum(30.0, observation.step[e] - 1.0 - observation.last_seen[e])
            wrong = (counts != observation.belief[e]) + 0.1 * (counts > 0)
            self._scouts.look(at, wrong * age, preferences)
        return self._preferences
