"""The belief planner for a batch: moves of all agents from their beliefs (`beliefs`)."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.belief_planner.beliefs import Beliefs, stale_nodes
from mjforage.graph_planner.belief_planner.boundary import boundary_of
from mjforage.graph_planner.belief_planner.connectivity import NOBODY, Connectivity
from mjforage.graph_planner.belief_planner.covers import BlockCover, hotspot_cover, landmarks_of
from mjforage.graph_planner.belief_planner.foraging import Foraging
from mjforage.graph_planner.belief_planner.move_preferences import approach, regrets, towards
from mjforage.graph_planner.belief_planner.scouting import Scouting
from mjforage.graph_planner.belief_planner.settings import BeliefOptions, BeliefSettings
from mjforage.graph_planner.belief_planner.target_values import TargetValues, summed
from mjforage.graph_planner.belief_planner.ways import Group
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.mission.plain import Plain
from mjforage.mission.task import Observation, Task

AHEAD = 6  # steps by which foragers' regret is judged
CALM = 1.0  # worth of finding a hotspot by which they lose nothing yet
MOST_SEEN = 0.6  # share of the nodes after which the first hotspot should have shown
PATIENCE = 12  # decisions of searching for the first hotspot without seeing a new node


class Lookers(NamedTuple):
    """Agents that search, and the hotspots that each would notice."""

    scouting: Scouting
    blocks: list[BlockCover]
    group: Group


class BeliefPlanner:
    """Beliefs and plans of a batch of rows; `believing` makes what it believes."""

    def __init__(
        self,
        task: Task,
        keys: UInt64Array,
        options: BeliefOptions | None = None,
        believing: type[Beliefs] = Beliefs,
    ) -> None:
        settings, graph, episodes = BeliefSettings.of(task.prior, options), task.graph, keys.size
        self.settings, self._task = settings, task
        self.beliefs = believing(task, settings, keys)
        self._foragers = self._foraging(settings)
        self._target_values = TargetValues(self.beliefs, settings, boundary_of(graph, task.walls))
        # Without scouts, foragers look around when they know of nothing to collect.
        self._lone = task.fleet.discoverers.size == 0
        lookers = task.fleet.collectors if self._lone else task.fleet.discoverers
        self._scouts = self._lookers(lookers)
        self._alone: dict[int, Lookers] = {}  # foragers that have looked for themselves
        self._connectivity = Connectivity(task, settings, episodes)
        self._landmarks, self._belongs = landmarks_of(graph)
        self._nothing = np.zeros(len(graph))
        self._viewed, self._news = np.zeros(episodes, np.int64), np.zeros(episodes, np.int64)
        self._vain = np.zeros(episodes, np.bool_)
        self._plain = Plain(task, episodes)
        self._preferences = np.zeros((episodes, len(task.fleet), 9))

    def _foraging(self, settings: BeliefSettings) -> Foraging:
        """The search of the collectors."""
        return Foraging(self._task, settings)

    def _scouting(self, settings: BeliefSettings, agents: NDArray[np.int64]) -> Scouting:
        """The search of the scouts."""
        return Scouting(self._task, settings, agents)

    def _lookers(self, agents: NDArray[np.int64]) -> Lookers:
        """Search for unseen items by some agents of the task."""
        task, settings = self._task, self.settings
        blocks = [hotspot_cover(task, int(a), settings) for a in agents]
        return Lookers(self._scouting(settings, agents), blocks, Group.of(task, agents))

    def act(self, observation: Observation) -> NDArray[np.float64]:
        """Preferences (episode, agent, 9)."""
        observation = self._plain(observation)
        for e in np.flatnonzero(observation.active).tolist():
            self._connectivity.note(observation, e)
            self.beliefs.learn(observation, e)
            self._decide(observation, e)
        return self._preferences

    def _decide(self, seen: Observation, e: int) -> None:
        at, yaw, preferences = seen.agent_node[e], seen.agent_yaw[e], self._preferences[e]
        sighted = self.beliefs.spots.number[e] > 0
        self._target_values.list_items(e, int(seen.step[e]) - 1, self._foragers.items)
        room, energy, busy = seen.room_left[e], seen.energy_left[e], False
        owner = int(seen.owner[e])  # whose move alone counts, unless it is nobody's
        if owner == NOBODY or self._task.fleet.collects[owner]:
            drift = self.beliefs.wind.mean[e : e + 1]
            busy = self._foragers.send(at, yaw, drift, room, energy, preferences) > 0
            if not busy:
                self._wait(at, e, sighted, preferences)
            self._foragers.hold(at, room, energy, preferences)
        looks = owner == NOBODY or self._lone or not self._task.fleet.collects[owner]
        if looks and not (self._lone and busy):
            self._look(seen, e, sighted, preferences)
        if owner != NOBODY and not self._connectivity.always:
            self._stay_connected(seen, e, busy)

    def _look(
        self, seen: Observation, e: int, sighted: bool, preferences: NDArray[np.float64]
    ) -> None:
        """Let the scouts go where most is worth seeing."""
        at, scouting = seen.agent_node[e], self._scouts.scouting
        if sighted or not self.settings.hotspot:
            scouting.look(at, self._target_values.worth_seeing(seen, e), preferences)
        elif self._in_vain(seen, e):
            scouting.look(at, stale_nodes(seen, e), preferences)
        else:
            self._search(at, self.beliefs.spots.chance[e, 0], preferences)

    def _stay_connected(self, seen: Observation, e: int, busy: bool) -> None:
        """Send an agent that acts by itself to bring news, to wait for it, or to search alone."""
        agent, connectivity, foragers = int(seen.owner[e]), self._connectivity, self._foragers
        group, goal = self._scouts.group, NOBODY
        if not self._task.fleet.collects[agent]:
            ways = group.ways_of(agent)
            tracks = self.beliefs.tracks
            goal = connectivity.connects(seen, e, ways)
            if goal == NOBODY:
                goal = connectivity.tells(seen, e, tracks.born[e, : tracks.number[e]], ways)
        elif not busy and foragers.is_able(agent, seen.room_left[e], seen.energy_left[e]):
            ways, goal = foragers.group.ways_of(agent), connectivity.waits(seen, e)
            if goal != NOBODY and connectivity.looks_alone(seen, e):
                self._look_alone(seen, e, agent)
                return
        if goal != NOBODY:
            here, preferences = seen.agent_node[e, agent], self._preferences[e, agent]
            towards(ways, here, goal, self._nothing, preferences)

    def _look_alone(self, seen: Observation, e: int, agent: int) -> None:
        """Let a forager search for the hotspot by itself."""
        if agent not in self._alone:
            itself = np.array([agent], np.int64)
            self._alone[agent] = self._lookers(itself)
        (cover, block), scouting = self._alone[agent].blocks[0], self._alone[agent].scouting
        chance = self.beliefs.spots.chance[e, 0] * self._connectivity.part(seen, e)
        mass = summed(block, chance, cover.landmark.size)
        self._connectivity.passed(e, cover, int(seen.agent_node[e, agent]), mass)
        scouting.look(seen.agent_node[e], mass, self._preferences[e], [cover])

    def _in_vain(self, seen: Observation, e: int) -> bool:
        """True if the search for the first hotspot shows no new nodes, or few are left to show.

        Then the assumptions are wrong, or no agent would notice anything by them; scouts look at
        nodes that have not been seen for the rest of the search.
        """
        count, now = int((seen.last_seen[e] >= 0).sum()), int(seen.step[e]) - 1
        if count > self._viewed[e]:
            self._viewed[e], self._news[e] = count, now
        few_left = count > MOST_SEEN * seen.last_seen.shape[1]
        self._vain[e] |= few_left or now - self._news[e] > PATIENCE
        return bool(self._vain[e])

    def _search(
        self,
        at: Int32Array,
        chance: NDArray[np.float64],
        preferences: NDArray[np.float64],
    ) -> None:
        """Let the scouts look for the first hotspot, most of all where not knowing costs most."""
        lookers = self._scouts
        if not lookers.blocks:
            return
        group = self._foragers.group
        if group.agents.size and self.settings.preposition:
            mass = summed(self._belongs, chance, self._landmarks.size)
            regret = regrets(group.ways, self._landmarks, mass, group.kind, at[group.agents], AHEAD)
            chance = chance * (CALM + regret)[self._belongs]
        mass = summed(lookers.blocks[0].block, chance, 1)
        lookers.scouting.look(at, mass, preferences, [b.cover for b in lookers.blocks])

    def _wait(
        self, at: Int32Array, e: int, sighted: bool, preferences: NDArray[np.float64]
    ) -> None:
        """Send foragers without a stop to where they are near to what may come."""
        group = self._foragers.group
        sighted = sighted or not self.settings.hotspot
        field = self.beliefs.expected[e] if sighted else self.beliefs.spots.chance[e, 0]
        mass = summed(self._belongs, field, self._landmarks.size)
        for f, agent in enumerate(group.agents):
            ways = group.ways[group.kind[f]]
            if self.settings.preposition and mass.sum() > 0:
                approach(ways, self._landmarks, mass, at[agent], preferences[agent])
            else:
                towards(ways, at[agent], at[agent], self._nothing, preferences[agent])
