"""What is believed of each row of a batch: items and their drift, and what is still unseen.

Tracks of what was seen, the drift from their ways, hotspots and stragglers from what was not: every
decision brings them up to date with what is in view, and with looks that are heard late.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from graph_planner.belief_planner import hotspots as hs
from graph_planner.belief_planner import late as lt
from graph_planner.belief_planner import misses as ms
from graph_planner.belief_planner import reconciling as rc
from graph_planner.belief_planner import stragglers as st
from graph_planner.belief_planner import tracks as tr
from graph_planner.belief_planner import wind as wd
from graph_planner.belief_planner.cloud import cloud_of
from graph_planner.belief_planner.currents import currents_of
from graph_planner.belief_planner.routes import NOWHERE
from graph_planner.belief_planner.shore import shore_of
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
IDLE, OLD = 0.05, 135.0  # without a belief: items in a node not seen for so many steps
LEAST_EXPECTED = 0.1  # of the mean unseen items per node: so many may be anywhere
LATER = 6  # steps for which an item counts less where a hull gave up


def neglected(seen: Observation, e: int) -> NDArray[np.float64]:
    """Items expected in each node (node,) without a belief: more where nobody looked for long."""
    age: NDArray[np.float64] = seen.step[e] - 1.0 - seen.last_seen[e].astype(np.float64)
    return IDLE * np.minimum(1.0, age / OLD)


class Beliefs:
    """What is believed of a batch of rows.

    Attributes
    ----------
    tracks, wind, spots, stragglers : see the rooms of those names
    expected : (row, node) unseen items
    later : (row, node) step until which hulls fail there, as far as is known
    """

    def __init__(self, task: Task, settings: BeliefSettings, keys: UInt64Array) -> None:
        graph, rows = task.graph, keys.size
        self._settings, self._task, self._foragers = settings, task, task.fleet.collectors
        capacity = int(ROOM * settings.items) + 128
        self._keys = [np.uint64(stream_key(key, Stream.POLICY)) for key in keys]
        self.tracks = tr.tracks(rows, capacity)
        self.wind = wd.wind(rows, settings)
        largest = settings.drift_node_per_step
        self._currents = currents_of(graph, task.walls, largest, task.horizon)
        hypotheses = len(self._currents.drift)
        self.spots = hs.hotspots(rows, len(graph), hypotheses, capacity, settings)
        foragers, noise = self._foragers.size, settings.noise_node_per_step
        self._misses = ms.misses(rows, len(graph), task.horizon, ms.assumed_chances(task, settings))
        about = len(graph), task.horizon, foragers, noise, self._misses
        self.stragglers = st.stragglers(rows, *about)
        self._cloud = cloud_of(graph, settings.spread_node)
        self._shore = shore_of(graph, task.walls)
        self._ways, self._scratch = tr.ended(4 * capacity), rc.scratch(len(graph))
        self._lost = tr.losses(capacity)
        self._glance = lt.glance(len(graph))
        self.expected = np.zeros((rows, len(graph)))
        self.later = np.zeros((rows, len(graph)), np.int64)
        self._taken = np.zeros((rows, foragers), np.int64)
        self._had_room = np.ones((rows, foragers), np.bool_)

    def learn(self, seen: Observation, e: int) -> None:
        """Bring tracks, drift and expectations of an episode up to date."""
        now, shore, ways, lost = int(seen.step[e]) - 1, self._shore, self._ways, self._lost
        belief, last_seen = seen.belief[e], seen.last_seen[e]
        settings, drift = self._settings, self.wind.mean[e]
        ways.number[0] = lost.number[0] = 0
        agents = self._foragers
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
        looked = np.flatnonzero(seen.agent_seen[e] == now)
        self._remember(e, now, last_seen, seen.agent_node[e][looked], looked, foragers_at)
        about = wander, self._catch(seen, e, now), self._doubts(e), self._scratch
        new = rc.reconcile(self.tracks, shore, edges, e, view, *about, ways, lost)
        if settings.wind:
            wd.settle(self.wind, shore, e, ways)
            wd.estimate(self.wind, self.tracks, shore, e)
        n = int(self.tracks.number[e])
        sighted = self.tracks.node[e, n - new : n].copy()
        if settings.false_rate > 0.0:
            self._retract(e)
        if settings.particles:
            sighted = self._settle_losses(e, now, sighted)
        for late in found:
            if not late.node.size:
                continue
            hs.sight(self.spots, self._cloud, shore, e, late.step, late.node, drift[0], drift[1])
        self._expect(seen, e, now, sighted)

    def _remember(
        self,
        e: int,
        step: int,
        last_seen: NDArray[np.int16],
        at: Int32Array,
        who: NDArray[np.int64],
        foragers_at: Int32Array,
    ) -> None:
        """Keep a view of a step: of agents (look,) at their nodes (look,)."""
        task = self._task
        water = task.graph.rows, task.graph.cols
        looking = ms.Looking(at, task.radius_number[who], task.views, *water)
        ms.look_at(self._misses, e, step, last_seen, looking)
        st.remember(self.stragglers, e, step, last_seen, foragers_at)

    def _doubts(self, e: int) -> rc.Doubts:
        """What a view may have missed or invented."""
        least = LEAST_EXPECTED * self._settings.items / self.expected.shape[1]
        return rc.Doubts(self._misses, self._settings.false_rate, self.expected[e], least)

    def _retract(self, e: int) -> None:
        """Take back the first sightings of tracks that were given up.

        They were of nothing, or else the item will be sighted again, and would count twice. To take
        back but those that were unlikely, and never of what a forager may have taken, was worse:
        `docs/sensing.md`.
        """
        lost = self._lost
        for i in range(lost.number[0]):
            about = lost.born_node[i], int(lost.born[i])
            hs.retract(self.spots, self._cloud, self._shore, e, *about)

    def forecast(self) -> NDArray[np.float64]:
        """(row, node) items expected: unseen ones, and known ones where they should be.

        A track counts as -ln(1 - r), so that there is an item with its chance r.
        """
        items, tracks = self.expected.copy(), self.tracks
        for e, n in enumerate(tracks.number.tolist()):
            surely = -np.log1p(-np.minimum(tr.CERTAIN_PLACE, tracks.real[e, :n]))
            np.add.at(items[e], tracks.node[e, :n], surely)
        return items

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
            who, at = late[looks, 1].astype(np.int64), late[looks, 2]
            views, radius = self._task.views, self._task.radius_number[who]
            lt.show(step, at, seen.late_shown[e, looks], radius, views, self._glance)
            found.append(self._take_step(e, step, now, at, who, wander))
        if self._settings.particles:
            st.retest(self.stragglers, self._shore, self._keys[e], e, now - 1)
        return found

    def _collecting(self, e: int, at: Int32Array, who: NDArray[np.int64]) -> Int32Array:
        """(forager,) nodes of those whose looks (look,) these are and that take all there is."""
        agents = self._foragers
        nodes = np.full(agents.size, NOWHERE, np.int32)
        if self._task.pickup is None:
            for f, agent in enumerate(agents):
                mine = at[who == agent]
                nodes[f] = mine[0] if mine.size and self._had_room[e, f] else NOWHERE
        return nodes

    def _take_step(
        self, e: int, step: int, now: int, at: Int32Array, who: NDArray[np.int64], wander: float
    ) -> lt.Sighted:
        """Take in what the glance shows of a step, of agents (look,) at their nodes (look,)."""
        foragers_at = self._collecting(e, at, who)
        tracks, shore, ways, lost = self.tracks, self._shore, self._ways, self._lost
        seen, past, particles = self._glance.last_seen, now - step, self.stragglers
        drift = self.wind.mean[e] * self._settings.advection
        self._remember(e, step, seen, at, who, foragers_at)
        hs.look(self.spots, e, self._currents.nodes(step), self._misses.factor)
        lt.work_back(tracks, shore, e, step, past, drift)
        lt.collect(tracks, shore, e, step, foragers_at, drift, ways, lost)
        edges, view = self._task.graph.neighbours, rc.View(step, self._glance.belief, seen)
        nobody = rc.Catch(foragers_at[:0], self._taken[e, :0])
        about = wander, nobody, self._doubts(e), self._scratch
        new = rc.reconcile(tracks, shore, edges, e, view, *about, ways, lost)
        new = lt.doubt(tracks, particles, shore, e, new, step, now, drift, ways, lost)
        last = slice(int(tracks.number[e]) - new, int(tracks.number[e]))
        nodes = tracks.node[e, last].copy()
        lt.carry_on(tracks, shore, e, step, past, drift)
        after = tracks.node[e, last]
        if self._settings.particles:
            known = [st.find(particles, shore, e, node) for node in after]
            nodes = nodes[~np.array(known, np.bool_)]
        return lt.Sighted(step, nodes)

    def _catch(self, seen: Observation, e: int, now: int) -> rc.Catch:
        """What foragers took in the step just made, and where one gave up."""
        agents = self._foragers
        at, taken = seen.agent_node[e][agents], seen.taken[e][agents]
        caught = taken - self._taken[e]
        self._taken[e] = taken
        fresh = seen.agent_seen[e][agents] == now
        self.later[e, at[fresh & (seen.pickup[e][agents] == UNREACHABLE)]] = now + LATER
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
        hs.look(spots, e, nodes, self._misses.factor)
        if sighted.size:
            drift = wind.mean[e]
            hs.sight(spots, self._cloud, self._shore, e, now, sighted, drift[0], drift[1])
        if not self._settings.hotspot:
            self.expected[e] = neglected(seen, e)
            return
        hs.expect(spots, self._cloud, e, nodes, expected)
        if self._settings.particles and spots.number[e]:
            self._expect_stragglers(e, now)
        if ms.is_certain(self._misses):
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
            spread = self._settings.spread_node
            tries = TRIES_FAST if self._settings.fast else TRIES
            st.try_more(particles, self.spots, self.wind, self._shore, key, e, now, spread, tries)
            expected[:] = 0.0
            total, real = float(self.spots.total[e]), REAL_LATE
        st.expect_stragglers(particles, self._shore, e, total, real, expected)
