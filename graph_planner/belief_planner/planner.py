"""The belief planner for a batch: what each part finds out, and who asks it."""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from graph_planner.belief_planner import hotspots as hs
from graph_planner.belief_planner import late as lt
from graph_planner.belief_planner import reconciling as rc
from graph_planner.belief_planner import stragglers as st
from graph_planner.belief_planner import tracks as tr
from graph_planner.belief_planner import wind as wd
from graph_planner.belief_planner.cloud import cloud_of
from graph_planner.belief_planner.covers import BlockCover, hotspot_cover, landmarks_of
from graph_planner.belief_planner.currents import currents_of
from graph_planner.belief_planner.foraging import Foraging
from graph_planner.belief_planner.group import Group
from graph_planner.belief_planner.move_preferences import towards
from graph_planner.belief_planner.routes import NOWHERE
from graph_planner.belief_planner.scouting import Scouting
from graph_planner.belief_planner.shore import shore_of
from graph_planner.belief_planner.touch import NOBODY, Touch
from graph_planner.belief_planner.waiting import approach, regrets
from graph_planner.belief_settings import BeliefSettings
from graph_planner.geodesics import Int32Array
from graph_planner.randomness import Stream, UInt64Array, stream_key
from graph_planner.task import UNREACHABLE, Observation, Task

ROOM = 4  # tracks kept, in multiples of the number of items expected
REAL, REAL_LATE = 0.1, 0.5  # worth of items given up, with many and with few tracks left
TRIES, TRIES_FAST = 200, 60  # particles of unseen items tried in one decision
FEW = 15  # with so few tracks left, stragglers are simulated one by one
LATE = 8.0  # and no more than so many unseen items expected otherwise
HOPELESS = 1e-3  # unseen items expected in all, below which the belief is given up
PROBABLE = 40  # nodes of unseen items that foragers may go to
LEAST = 0.02  # unseen items worth a forager's thought
AGE_SHARE = 0.02  # what seeing a known item again is worth, per step unseen [item]
GHOST_SHARE = 0.02  # what seeing an outdated belief again is worth, per step unseen [item]
AHEAD = 6  # steps by which foragers' regret is judged
CALM = 1.0  # worth of finding a hotspot by which they lose nothing yet
IDLE, OLD = 0.05, 135.0  # without a belief: items in a node not seen for so many steps
LATER, FAILED = 6, 0.2  # steps for which an item counts less where a hull gave up, and how much
OLDEST = 30.0  # step at which those stop growing
MOST_SEEN = 0.6  # share of the nodes after which the first hotspot should have shown
PATIENCE = 12  # decisions of searching for the first hotspot without seeing a new node


def _summed(place: Int32Array, value: NDArray[np.float64], size: int) -> NDArray[np.float64]:
    """(size,) sum of the values at each place."""
    return np.bincount(place, value, minlength=size).astype(np.float64)


def _unseen(seen: Observation, e: int) -> NDArray[np.float64]:
    """Items expected in each node (node,) without a belief: more where nobody looked for long."""
    age: NDArray[np.float64] = seen.step[e] - 1.0 - seen.last_seen[e].astype(np.float64)
    return IDLE * np.minimum(1.0, age / OLD)


class Lookers(NamedTuple):
    """Agents that look around, and what each would notice of hotspots."""

    scouting: Scouting
    blocks: list[BlockCover]
    group: Group

    @classmethod
    def of(cls, task: Task, settings: BeliefSettings, agents: NDArray[np.int64]) -> "Lookers":
        """Of some agents of a task."""
        blocks = [hotspot_cover(task, int(a), settings) for a in agents]
        return cls(Scouting(task, settings, agents), blocks, Group.of(task, agents))


class BeliefPlanner:
    """Knowledge and plans of a batch of episodes."""

    def __init__(self, task: Task, keys: UInt64Array) -> None:
        settings, graph, episodes = task.belief.widened(), task.graph, keys.size
        if not settings.wind:
            settings = replace(settings, drift_node_per_step=0.0)
        self.settings, self._task = settings, task
        capacity = int(ROOM * settings.items) + 128
        self._keys = [np.uint64(stream_key(key, Stream.POLICY)) for key in keys]
        self.tracks = tr.tracks(episodes, capacity)
        self.wind = wd.wind(episodes, settings)
        largest = settings.drift_node_per_step
        self._currents = currents_of(graph, task.walls, largest, task.horizon)
        hypotheses = len(self._currents.drift)
        self.spots = hs.hotspots(episodes, len(graph), hypotheses, capacity, settings)
        self.stragglers = st.stragglers(
            episodes,
            len(graph),
            task.horizon,
            task.fleet.collectors.size,
            settings.noise_node_per_step,
        )
        self._cloud = cloud_of(graph, settings.spread_node)
        self._shore = shore_of(graph, task.walls)
        self._ways, self._scratch = tr.ended(4 * capacity), rc.scratch(len(graph))
        self._lost = tr.losses(capacity)
        self._glance = lt.glance(len(graph))
        self._foragers = Foraging(task, settings)
        # Without scouts, foragers look around when they know of nothing to collect.
        self._lone = task.fleet.discoverers.size == 0
        lookers = task.fleet.collectors if self._lone else task.fleet.discoverers
        self._scouts = Lookers.of(task, settings, lookers)
        self._alone: dict[int, Lookers] = {}  # foragers that have looked for themselves
        self._touch = Touch(task, settings, episodes)
        self._landmarks, self._belongs = landmarks_of(graph)
        self.expected = np.zeros((episodes, len(graph)))
        self._nothing = np.zeros(len(graph))
        self._viewed, self._news = np.zeros(episodes, np.int64), np.zeros(episodes, np.int64)
        self._vain = np.zeros(episodes, np.bool_)
        self._taken = np.zeros((episodes, self._foragers.group.agents.size), np.int64)
        self._later = np.zeros((episodes, len(graph)), np.int64)  # step until which hulls fail
        self._had_room = np.ones((episodes, self._foragers.group.agents.size), np.bool_)
        self._preferences = np.zeros((episodes, len(task.fleet), 9))

    def act(self, observation: Observation) -> NDArray[np.float64]:
        """Preferences (episode, agent, 9)."""
        for e in np.flatnonzero(observation.active).tolist():
            self._touch.note(observation, e)
            self._learn(observation, e)
            self._decide(observation, e)
        return self._preferences

    def _learn(self, seen: Observation, e: int) -> None:
        """Bring tracks, drift and expectations of an episode up to date."""
        now, shore, ways, lost = int(seen.step[e]) - 1, self._shore, self._ways, self._lost
        belief, last_seen = seen.belief[e], seen.last_seen[e]
        settings, drift = self.settings, self.wind.mean[e]
        ways.number[0] = lost.number[0] = 0
        agents = self._foragers.group.agents
        fresh = seen.agent_seen[e][agents] == now
        sweeping = self._had_room[e] & (self._task.pickup is None) & fresh
        foragers_at = np.where(sweeping, seen.agent_node[e][agents], np.int32(NOWHERE))
        self._had_room[e] = seen.room_left[e][agents] > 0
        if now > 0:
            tr.collect(self.tracks, shore, e, now, foragers_at, ways, lost)
            if settings.advection:
                tr.carry(self.tracks, shore, e, drift[0], drift[1])
        wander = 2.0 * float(self.wind.deviation[e].max()) + 0.05
        edges, view = self._task.graph.neighbours, rc.View(now, belief, last_seen)
        found = self._take_late(seen, e, now, wander)
        catch, memory = self._catch(seen, e, now), self._scratch
        new = rc.reconcile(self.tracks, shore, edges, e, view, wander, catch, memory, ways, lost)
        if settings.wind:
            wd.settle(self.wind, shore, e, ways)
            wd.estimate(self.wind, self.tracks, shore, e)
        n = int(self.tracks.number[e])
        sighted = self.tracks.node[e, n - new : n].copy()
        st.remember(self.stragglers, e, now, last_seen, foragers_at)
        if settings.particles:
            sighted = self._settle_losses(e, now, sighted)
        for late in found:
            hs.sight(self.spots, self._cloud, shore, e, late.step, late.node, drift[0], drift[1])
        self._expect(seen, e, now, sighted)

    def _take_late(
        self, seen: Observation, e: int, now: int, wander: float
    ) -> Sequence[lt.Sighted]:
        """Take in looks of earlier steps heard just now, the oldest first; what they show first."""
        late = seen.late_looks[e]
        late = late[late[:, 0] >= 0]
        steps = late[:, 0]
        if not steps.size:
            return ()
        found = []
        for step in np.unique(steps).tolist():
            looks = np.flatnonzero(steps == step)
            who, at = late[looks, 1], late[looks, 2]
            views, radius = self._task.views, self._task.radius_number[who]
            lt.show(step, at, seen.late_shown[e, looks], radius, views, self._glance)
            found.append(self._take_step(e, step, now, self._collecting(e, at, who), wander))
        if self.settings.particles:
            st.retest(self.stragglers, self._shore, self._keys[e], e, int(steps[-1]), now - 1)
        return found

    def _collecting(self, e: int, at: Int32Array, who: Int32Array) -> Int32Array:
        """(forager,) nodes of those whose looks (look,) these are and that take all there is."""
        agents = self._foragers.group.agents
        nodes = np.full(agents.size, NOWHERE, np.int32)
        if self._task.pickup is None:
            for f, agent in enumerate(agents):
                mine = at[who == agent]
                nodes[f] = mine[0] if mine.size and self._had_room[e, f] else NOWHERE
        return nodes

    def _take_step(
        self, e: int, step: int, now: int, foragers_at: Int32Array, wander: float
    ) -> lt.Sighted:
        """Take in what the glance shows of a step."""
        tracks, shore, ways, lost = self.tracks, self._shore, self._ways, self._lost
        seen, past, particles = self._glance.last_seen, now - step, self.stragglers
        drift = self.wind.mean[e] * self.settings.advection
        hs.look(self.spots, e, step, self._currents.nodes(step), seen)
        st.remember(particles, e, step, seen, foragers_at)
        lt.work_back(tracks, shore, e, step, past, drift)
        lt.collect(tracks, shore, e, step, foragers_at, drift, ways, lost)
        edges, view = self._task.graph.neighbours, rc.View(step, self._glance.belief, seen)
        nobody, memory = rc.Catch(foragers_at[:0], self._taken[e, :0]), self._scratch
        new = rc.reconcile(tracks, shore, edges, e, view, wander, nobody, memory, ways, lost)
        new = lt.doubt(tracks, particles, shore, e, new, step, now, drift, ways, lost)
        last = slice(int(tracks.number[e]) - new, int(tracks.number[e]))
        nodes = tracks.node[e, last].copy()
        lt.carry_on(tracks, shore, e, step, past, drift)
        after = tracks.node[e, last]
        if self.settings.particles:
            known = [st.find(particles, shore, e, node) for node in after]
            nodes = nodes[~np.array(known, np.bool_)]
        return lt.Sighted(step, nodes)

    def _catch(self, seen: Observation, e: int, now: int) -> rc.Catch:
        """What foragers took in the step just made, and where one gave up."""
        agents = self._foragers.group.agents
        at, taken = seen.agent_node[e][agents], seen.taken[e][agents]
        caught = taken - self._taken[e]
        self._taken[e] = taken
        fresh = seen.agent_seen[e][agents] == now
        self._later[e, at[fresh & (seen.pickup[e][agents] == UNREACHABLE)]] = now + LATER
        at_once = self._task.pickup is None
        return rc.Catch(at[:0], caught[:0]) if at_once else rc.Catch(at, caught)

    def _settle_losses(self, e: int, now: int, sighted: Int32Array) -> Int32Array:
        """Take in what was lost and found; those of the new sightings that are really new."""
        particles, key, lost = self.stragglers, self._keys[e], self._lost
        if particles.number[e]:
            new = [not st.find(particles, self._shore, e, node) for node in sighted]
            sighted = sighted[np.array(new, np.bool_)]
            st.advance(particles, self._shore, key, e, now)
        for i in range(lost.number[0]):
            st.lose(particles, self.wind, self._shore, key, e, lost.node[i], int(lost.step[i]), now)
        return sighted

    def _expect(self, seen: Observation, e: int, now: int, sighted: Int32Array) -> None:
        """Expected unseen items of an episode."""
        spots, wind, last_seen = self.spots, self.wind, seen.last_seen[e]
        nodes, expected = self._currents.nodes(now), self.expected[e]
        hs.weigh(self._currents.axis, wind.grid, wind.chance[e], spots.share[e])
        hs.look(spots, e, now, nodes, last_seen)
        if sighted.size:
            drift = wind.mean[e]
            hs.sight(spots, self._cloud, self._shore, e, now, sighted, drift[0], drift[1])
        if not self.settings.hotspot:
            self.expected[e] = _unseen(seen, e)
            return
        hs.expect(spots, self._cloud, e, nodes, expected)
        if self.settings.particles and spots.number[e]:
            self._expect_stragglers(e, now)
        expected[last_seen == now] = 0.0
        if self.tracks.number[e] == 0 and spots.number[e] and expected.sum() < 1.0:
            # The episode goes on, so there is something left: if not where it should be, then
            # where nobody has looked for long.
            if expected.sum() < HOPELESS:
                expected += np.minimum(now - last_seen.astype(np.float64), 2.0 * now + 1.0)
            expected /= max(1e-9, expected.sum())

    def _expect_stragglers(self, e: int, now: int) -> None:
        particles, key, expected = self.stragglers, self._keys[e], self.expected[e]
        total, real = 0.0, REAL
        if self.tracks.number[e] <= FEW and expected.sum() < LATE:
            spread = self.settings.spread_node
            tries = TRIES_FAST if self.settings.fast else TRIES
            st.try_more(particles, self.spots, self.wind, self._shore, key, e, now, spread, tries)
            expected[:] = 0.0
            total, real = float(self.spots.total[e]), REAL_LATE
        st.expect_stragglers(particles, self._shore, e, total, real, expected)

    def _decide(self, seen: Observation, e: int) -> None:
        at, yaw, preferences = seen.agent_node[e], seen.agent_yaw[e], self._preferences[e]
        sighted = self.spots.number[e] > 0
        self._list_items(e, int(seen.step[e]) - 1, sighted)
        room, energy, busy = seen.room_left[e], seen.energy_left[e], False
        holder = int(seen.holder[e])  # whose move alone counts, unless it is nobody's
        if holder == NOBODY or self._task.fleet.collects[holder]:
            drift = self.wind.mean[e]
            busy = self._foragers.send(at, yaw, drift, room, energy, preferences) > 0
            if not busy:
                self._wait(at, e, sighted, preferences)
            self._foragers.hold(at, room, energy, preferences)
        looks = holder == NOBODY or self._lone or not self._task.fleet.collects[holder]
        if looks and not (self._lone and busy):
            self._look(seen, e, sighted, preferences)
        if holder != NOBODY and not self._touch.always:
            self._keep_in_touch(seen, e, busy)

    def _look(
        self, seen: Observation, e: int, sighted: bool, preferences: NDArray[np.float64]
    ) -> None:
        """Let the scouts go where most is worth seeing."""
        at, scouting = seen.agent_node[e], self._scouts.scouting
        if sighted or not self.settings.hotspot:
            scouting.look(at, self._worth_seeing(seen, e), preferences)
        elif self._in_vain(seen, e):
            scouting.look(at, _unseen(seen, e), preferences)
        else:
            self._search(at, self.spots.chance[e, 0], preferences)

    def _keep_in_touch(self, seen: Observation, e: int, busy: bool) -> None:
        """Send one who acts by itself to where it brings news, or waits for it, or looks alone."""
        agent, touch, foragers = int(seen.holder[e]), self._touch, self._foragers
        group, goal = self._scouts.group, NOBODY
        if not self._task.fleet.collects[agent]:
            ways = group.ways_of(agent)
            goal = touch.tells(seen, e, self.tracks.born[e, : self.tracks.number[e]], ways)
        elif not busy and foragers.is_able(agent, seen.room_left[e], seen.energy_left[e]):
            ways, goal = foragers.group.ways_of(agent), touch.waits(seen, e)
            if goal != NOBODY and touch.looks_alone(seen, e):
                self._look_alone(seen, e, agent)
                return
        if goal != NOBODY:
            here, preferences = seen.agent_node[e, agent], self._preferences[e, agent]
            towards(ways, here, goal, self._nothing, preferences)

    def _look_alone(self, seen: Observation, e: int, agent: int) -> None:
        """Let a forager search for the hotspot by itself."""
        if agent not in self._alone:
            itself = np.array([agent], np.int64)
            self._alone[agent] = Lookers.of(self._task, self.settings, itself)
        (cover, block), scouting = self._alone[agent].blocks[0], self._alone[agent].scouting
        chance = self.spots.chance[e, 0] * self._touch.part(seen, e)
        mass = _summed(block, chance, cover.landmark.size)
        self._touch.passed(e, cover, int(seen.agent_node[e, agent]), mass)
        scouting.look(seen.agent_node[e], mass, self._preferences[e], [cover])

    def _in_vain(self, seen: Observation, e: int) -> bool:
        """Whether the search for the first hotspot shows no new nodes, or few are left to show.

        Then the assumptions are wrong, or nothing would be noticed anywhere by them; scouts look
        at what nobody has seen for the rest of the search.
        """
        count, now = int((seen.last_seen[e] >= 0).sum()), int(seen.step[e]) - 1
        if count > self._viewed[e]:
            self._viewed[e], self._news[e] = count, now
        self._vain[e] |= (
            now - self._news[e] > PATIENCE or count > MOST_SEEN * seen.last_seen.shape[1]
        )
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
            mass = _summed(self._belongs, chance, self._landmarks.size)
            regret = regrets(group.ways, self._landmarks, mass, group.kind, at[group.agents], AHEAD)
            chance = chance * (CALM + regret)[self._belongs]
        mass = _summed(lookers.blocks[0].block, chance, 1)
        lookers.scouting.look(at, mass, preferences, [b.cover for b in lookers.blocks])

    def _list_items(self, e: int, now: int, sighted: bool) -> None:
        """Tracks, and the nodes where most unseen items are expected, as things to collect."""
        items, n = self._foragers.items, int(self.tracks.number[e])
        items.row[:n], items.col[:n] = self.tracks.row[e, :n], self.tracks.col[e, :n]
        items.weight[:n] = np.where(self._later[e, self.tracks.node[e, :n]] > now, FAILED, 1.0)
        if sighted and self.settings.hotspot:
            best = np.argsort(-self.expected[e], kind="stable")[:PROBABLE]
            best = best[self.expected[e, best] > LEAST]
            m = best.size
            items.row[n : n + m] = self._shore.rows[best]
            items.col[n : n + m] = self._shore.cols[best]
            items.weight[n : n + m] = self.expected[e, best]
            n += m
        items.number[0] = n

    def _wait(
        self, at: Int32Array, e: int, sighted: bool, preferences: NDArray[np.float64]
    ) -> None:
        """Send foragers without a stop to where they are near to what may come."""
        group = self._foragers.group
        sighted = sighted or not self.settings.hotspot
        field = self.expected[e] if sighted else self.spots.chance[e, 0]
        mass = _summed(self._belongs, field, self._landmarks.size)
        for f, agent in enumerate(group.agents):
            ways = group.ways[group.kind[f]]
            if self.settings.preposition and mass.sum() > 0:
                approach(ways, self._landmarks, mass, at[agent], preferences[agent])
            else:
                towards(ways, at[agent], at[agent], self._nothing, preferences[agent])

    def _worth_seeing(self, seen: Observation, e: int) -> NDArray[np.float64]:
        """What seeing each node is worth to the fleet (node,) [item]."""
        now = int(seen.step[e]) - 1
        mass: NDArray[np.float64] = self.expected[e].copy()
        if not self.settings.refresh:
            return mass
        n = int(self.tracks.number[e])
        age = np.minimum(OLDEST, now - self.tracks.seen[e, :n])
        mass += _summed(self.tracks.node[e, :n], AGE_SHARE * age, mass.size)
        known = seen.known[e, : seen.n_known[e]]
        tracked = np.zeros(mass.size, np.bool_)
        tracked[self.tracks.node[e, :n]] = True
        age = np.minimum(OLDEST, now - seen.last_seen[e, known].astype(np.float64))
        mass[known] += np.where(tracked[known], 0.0, GHOST_SHARE * age)
        return mass
