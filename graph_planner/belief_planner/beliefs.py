"""Beliefs of each row of a batch: items and their drift, and items still unseen.

Tracks of seen items, drift from their displacements, hotspots of unseen items: every decision
updates them by the nodes in view, and by delayed scans.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel
from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.belief_planner import hotspots as hs
from mjforage.graph_planner.belief_planner import late as lt
from mjforage.graph_planner.belief_planner import missed_detections as ms
from mjforage.graph_planner.belief_planner import reconciling as rc
from mjforage.graph_planner.belief_planner import tracks as tr
from mjforage.graph_planner.belief_planner import updating as up
from mjforage.graph_planner.belief_planner import wind as wd
from mjforage.graph_planner.belief_planner.boundary import boundary_of
from mjforage.graph_planner.belief_planner.drift_hypotheses import drift_hypotheses_of
from mjforage.graph_planner.belief_planner.routes import NOWHERE
from mjforage.graph_planner.belief_planner.settings import BeliefSettings
from mjforage.graph_planner.belief_planner.spatial_prior import spatial_prior_of
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.mission.task import Observation, Task

ROOM = 4  # tracks kept, in multiples of the number of items expected
HOPELESS = 1e-3  # unseen items expected in all, below which the belief is given up
IDLE, OLD = 0.05, 135.0  # without a belief: items in a node not seen for so many steps
LEAST_EXPECTED = 0.1  # of the mean unseen items per node: so many may be anywhere


def stale_nodes(seen: Observation, e: int) -> NDArray[np.float64]:
    """Items expected in each node (node,) without a belief: more where it was not seen for long."""
    age: NDArray[np.float64] = seen.step[e] - 1.0 - seen.last_seen[e].astype(np.float64)
    return IDLE * np.minimum(1.0, age / OLD)


class Beliefs:
    """Beliefs of a batch of rows.

    Attributes
    ----------
    tracks, wind, spots : see the modules of those names
    expected : (row, node) unseen items
    later : (row, node) step until which hulls fail there, as far as is known
    """

    def __init__(self, task: Task, settings: BeliefSettings, keys: UInt64Array) -> None:
        graph, rows = task.graph, keys.size
        self._settings, self._task, self._foragers = settings, task, task.fleet.collectors
        capacity, nodes = int(ROOM * settings.items) + 128, len(graph)
        self.tracks = tr.tracks(rows, capacity)
        self.wind = wd.wind(rows, settings)
        largest = settings.drift_node_per_step
        self._hypotheses = drift_hypotheses_of(graph, task.walls, largest, task.horizon)
        hypotheses = len(self._hypotheses.drift)
        self.spots = hs.hotspots(rows, nodes, hypotheses, capacity, settings)
        self._missed_detections = ms.missed_detections(
            rows, nodes, task.horizon, ms.assumed_chances(task, settings)
        )
        about = nodes, task.horizon, self._foragers.size, self._missed_detections
        self._history = ms.view_history(rows, *about)
        self._boundary = boundary_of(graph, task.walls)
        self._glance = lt.glance(nodes)
        self.expected = np.zeros((rows, nodes))
        self.later = np.zeros((rows, nodes), np.int64)
        self._store = self._stored(capacity)
        self._learn = BoundKernel(up.learn, self._store)
        self._begin = BoundKernel(up.begin, self._store)
        self._settle = BoundKernel(up.settle, self._store)
        self._expect = BoundKernel(up.expect, self._store)

    def _stored(self, capacity: int) -> up.Store:
        """All of that for the kernels."""
        task, settings, (rows, nodes) = self._task, self._settings, self.expected.shape
        assumed = up.Assumed(
            settings.advection,
            settings.wind,
            settings.hotspot,
            task.pickup is None,
            float(settings.false_rate),
            float(LEAST_EXPECTED * settings.items / nodes),
        )
        return up.Store(
            assumed,
            up.Sensors(self._foragers, task.radius_number, task.views, task.graph.neighbours),
            self.tracks,
            self.wind,
            self.spots,
            self._history,
            self._boundary,
            spatial_prior_of(task.graph, settings.spread_node),
            tr.ended(4 * capacity),
            tr.losses(capacity),
            np.zeros(nodes, np.int16),
            self._hypotheses.axis,
            self.expected,
            self.later,
            np.zeros((rows, self._foragers.size), np.int64),
            np.ones((rows, self._foragers.size), np.bool_),
        )

    def learn(self, seen: Observation, e: int) -> None:
        """Bring tracks, drift and expectations of a row of a plain observation up to date."""
        now, store = int(seen.step[e]) - 1, self._store
        nodes = self._hypotheses.nodes(now)
        if (seen.delayed_scans[e, :, 0] >= 0).any():
            foragers_at = self._begin(seen, e)
            found = self._take_late(seen, e, now)
            sighted, drift = self._settle(seen, e, foragers_at), self.wind.mean[e]
            for late in found:
                if late.node.size:
                    about = self.spots, store.prior, self._boundary, e, late.step, late.node
                    hs.sight(*about, drift[0], drift[1])
            self._expect(seen, e, nodes, sighted)
        else:
            self._learn(seen, e, nodes)
        if not self._settings.hotspot:
            self.expected[e] = stale_nodes(seen, e)
        elif self.tracks.number[e] == 0 and self.spots.number[e]:
            self._keep_hoping(seen, e, now)

    def _keep_hoping(self, seen: Observation, e: int, now: int) -> None:
        """Keep some expectation, since the episode goes on: at the places of known items, else
        where no agent has looked for long.
        """
        expected = self.expected[e]
        if expected.sum() < 1.0:
            if expected.sum() < HOPELESS:
                unseen_for = now - seen.last_seen[e].astype(np.float64)
                expected += np.minimum(unseen_for, 2.0 * now + 1.0)
            expected /= max(1e-9, expected.sum())

    def forecast(self) -> NDArray[np.float64]:
        """(row, node) items expected: unseen ones, and known ones where they should be.

        A track counts as -ln(1 - r), so that there is an item with its chance r.
        """
        items = self.expected.copy()
        tr.add_expected(self.tracks, items)
        return items

    def _take_late(self, seen: Observation, e: int, now: int) -> Sequence[lt.Sighted]:
        """Process the scans received late, the oldest first; return the items first sighted."""
        late = seen.delayed_scans[e]
        late = late[late[:, 0] >= 0]
        steps = late[:, 0]
        found = []
        for step in np.unique(steps).tolist():
            looks = np.flatnonzero(steps == step)
            who, at = late[looks, 1].astype(np.int64), late[looks, 2]
            views, radius = self._task.views, self._task.radius_number[who]
            lt.show(step, at, seen.delayed_shown[e, looks], radius, views, self._glance)
            found.append(self._take_step(e, step, now, at, who))
        return found

    def _collecting(self, e: int, at: Int32Array, who: NDArray[np.int64]) -> Int32Array:
        """(forager,) nodes of the scans (look,) of foragers that had room, else `NOWHERE`."""
        agents = self._foragers
        nodes = np.full(agents.size, NOWHERE, np.int32)
        if self._task.pickup is None:
            for f, agent in enumerate(agents):
                mine = at[who == agent]
                nodes[f] = mine[0] if mine.size and self._store.had_room[e, f] else NOWHERE
        return nodes

    def _take_step(
        self, e: int, step: int, now: int, at: Int32Array, who: NDArray[np.int64]
    ) -> lt.Sighted:
        """Take in what the glance shows of a step, of agents (look,) at their nodes (look,)."""
        foragers_at = self._collecting(e, at, who)
        store, tracks, past = self._store, self.tracks, now - step
        boundary, ways, lost, seen = self._boundary, store.ways, store.lost, self._glance.last_seen
        drift = self.wind.mean[e] * self._settings.advection
        up.remember(store, e, step, seen, at, who, foragers_at)
        hs.look(self.spots, e, self._hypotheses.nodes(step), self._missed_detections.factor)
        lt.work_back(tracks, boundary, e, step, past, drift)
        lt.collect(tracks, boundary, e, step, foragers_at, drift, ways, lost)
        edges, view = self._task.graph.neighbours, rc.View(step, self._glance.belief, seen)
        nobody = rc.Catch(foragers_at[:0], store.taken[e, :0])
        false_rate, least = store.assumed.false_rate, store.assumed.least
        doubts = rc.Doubts(self._missed_detections, false_rate, self.expected[e], least)
        about = up.wander_of(store, e), nobody, doubts, store.tracked
        new = rc.reconcile(tracks, boundary, edges, e, view, *about, ways, lost)
        new = lt.doubt(tracks, self._history, boundary, e, new, step, now, drift, ways, lost)
        last = slice(int(tracks.number[e]) - new, int(tracks.number[e]))
        nodes = tracks.node[e, last].copy()
        lt.carry_on(tracks, boundary, e, step, past, drift)
        return lt.Sighted(step, nodes)
