"""A row's beliefs brought up to date as one kernel; `beliefs` says in which order and why.

In Python the two dozen calls of a decision took longer than what they do.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.graph_planner.belief_planner import hotspots as hs
from mjforage.graph_planner.belief_planner import missed_detections as ms
from mjforage.graph_planner.belief_planner import reconciling as rc
from mjforage.graph_planner.belief_planner import tracks as tr
from mjforage.graph_planner.belief_planner import wind as wd
from mjforage.graph_planner.belief_planner.boundary import Boundary
from mjforage.graph_planner.belief_planner.routes import NOWHERE
from mjforage.graph_planner.belief_planner.spatial_prior import SpatialPrior
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.mission.task import UNREACHABLE, Observation

LATER = 6  # steps for which an item counts less where a hull gave up


class Assumed(NamedTuple):
    """Assumptions of the settings and the task."""

    advection: bool
    wind: bool
    hotspot: bool
    at_once: bool  # whether foragers take all there is in their node
    false_rate: float  # items per node and step that are seen and are none
    least: float  # unseen items that may be anywhere


class Sensors(NamedTuple):
    """Views of all agents."""

    foragers: NDArray[np.int64]  # (forager,) indices in the fleet
    radius_number: NDArray[np.int64]  # (agent,)
    views: NodeLists
    neighbours: Int32Array  # (node, 8)


class Store(NamedTuple):
    """All that is believed of a batch, and scratch."""

    assumed: Assumed
    sensors: Sensors
    tracks: tr.Tracks
    wind: wd.Wind
    spots: hs.Hotspots
    history: ms.ViewHistory  # with `missed_detections`
    boundary: Boundary
    prior: SpatialPrior
    ways: tr.Ended  # empty between decisions
    lost: tr.Lost
    tracked: NDArray[np.int16]  # (node,) scratch: tracks counted in a node
    axis: NDArray[np.float64]  # (value,) drifts per axis that the hypotheses combine
    expected: NDArray[np.float64]  # (row, node) unseen items
    later: NDArray[np.int64]  # (row, node) step until which hulls fail there
    taken: NDArray[np.int64]  # (row, forager) items
    had_room: NDArray[np.bool_]  # (row, forager) before the step just made


@kernel
def wander_of(store: Store, e: int) -> float:
    """Growth of an unseen track's uncertainty [node/step]."""
    return float(2.0 * store.wind.deviation[e].max() + 0.05)


@kernel
def begin(store: Store, seen: Observation, e: int) -> Int32Array:
    """Move tracks on into the step just made; nodes (forager,) of those that took all there was,
    `NOWHERE` for others.
    """
    now, assumed, foragers = seen.step[e] - 1, store.assumed, store.sensors.foragers
    store.ways.number[0], store.lost.number[0] = 0, 0
    foragers_at = np.full(foragers.size, np.int32(NOWHERE), np.int32)
    for f in range(foragers.size):
        agent = foragers[f]
        if store.had_room[e, f] and assumed.at_once and seen.agent_seen[e, agent] == now:
            foragers_at[f] = seen.agent_node[e, agent]
        store.had_room[e, f] = seen.room_left[e, agent] > 0
    if now > 0:
        tracks, boundary, drift = store.tracks, store.boundary, store.wind.mean[e]
        tr.collect(tracks, boundary, e, now, foragers_at, store.ways, store.lost)
        if assumed.advection:
            tr.carry(tracks, boundary, e, drift[0], drift[1])
    return foragers_at


@kernel
def remember(
    store: Store,
    e: int,
    step: int,
    last_seen: NDArray[np.int16],
    at: Int32Array,
    who: NDArray[np.int64],
    foragers_at: Int32Array,
) -> None:
    """Keep a view of a step: of agents (look,) at their nodes (look,)."""
    sensors, boundary = store.sensors, store.boundary
    radius = sensors.radius_number[who]
    looking = ms.Looking(at, radius, sensors.views, boundary.rows, boundary.cols)
    ms.look_at(store.history.missed_detections, e, step, last_seen, looking)
    ms.remember(store.history, e, step, last_seen, foragers_at)


@kernel
def catch_of(store: Store, seen: Observation, e: int) -> rc.Catch:
    """Items that foragers took in the step just made, and nodes where one gave up."""
    now, foragers = seen.step[e] - 1, store.sensors.foragers
    many = 0 if store.assumed.at_once else foragers.size
    at, caught = np.empty(many, np.int32), np.empty(many, np.int64)
    for f in range(foragers.size):
        agent = foragers[f]
        node, taken = seen.agent_node[e, agent], seen.taken[e, agent]
        if many:
            at[f], caught[f] = node, taken - store.taken[e, f]
        store.taken[e, f] = taken
        if seen.agent_seen[e, agent] == now and seen.pickup[e, agent] == UNREACHABLE:
            store.later[e, node] = now + LATER
    return rc.Catch(at, caught)


@kernel
def settle(store: Store, seen: Observation, e: int, foragers_at: Int32Array) -> Int32Array:
    """Make tracks and drift agree with the present views; nodes of new items (sighting,)."""
    now, assumed, tracks, boundary = seen.step[e] - 1, store.assumed, store.tracks, store.boundary
    who = np.flatnonzero(seen.agent_seen[e] == now)
    last_seen = seen.last_seen[e]
    remember(store, e, now, last_seen, seen.agent_node[e][who], who, foragers_at)
    missed_detections = store.history.missed_detections
    doubts = rc.Doubts(missed_detections, assumed.false_rate, store.expected[e], assumed.least)
    new = rc.reconcile(
        tracks,
        boundary,
        store.sensors.neighbours,
        e,
        rc.View(now, seen.belief[e], last_seen),
        wander_of(store, e),
        catch_of(store, seen, e),
        doubts,
        store.tracked,
        store.ways,
        store.lost,
    )
    if assumed.wind:
        wd.settle(store.wind, boundary, e, store.ways)
        wd.estimate(store.wind, tracks, boundary, e)
    n = tracks.number[e]
    sighted = tracks.node[e, n - new : n].copy()
    if assumed.false_rate > 0.0:
        retract(store, e)
    return sighted


@kernel
def retract(store: Store, e: int) -> None:
    """Take back the first sightings of tracks that were given up.

    They were of nothing, or else the item will be sighted again, and would count twice. To take
    back but those that were unlikely, and never of what a forager may have taken, was worse:
    `docs/evidence/design-choices.md`.
    """
    lost, spots = store.lost, store.spots
    for i in range(lost.number[0]):
        hs.retract(spots, store.prior, store.boundary, e, lost.born_node[i], lost.born[i])


@kernel
def expect(store: Store, seen: Observation, e: int, nodes: Int32Array, sighted: Int32Array) -> None:
    """Bring the hotspots, and unseen items expected, up to date.

    Parameters
    ----------
    nodes : (hypothesis, node) where an item of each start is now
    sighted : (sighting,) nodes of new items
    """
    now, spots, wind, expected = seen.step[e] - 1, store.spots, store.wind, store.expected[e]
    missed_detections = store.history.missed_detections
    hs.weigh(store.axis, wind.grid, wind.chance[e], spots.share[e])
    hs.look(spots, e, nodes, missed_detections.factor)
    if sighted.size:
        drift = wind.mean[e]
        hs.sight(spots, store.prior, store.boundary, e, now, sighted, drift[0], drift[1])
    if not store.assumed.hotspot:
        return
    hs.expect(spots, store.prior, e, nodes, expected)
    if ms.is_certain(missed_detections):
        for node in range(expected.size):
            if seen.last_seen[e, node] == now:
                expected[node] = 0.0


@kernel
def learn(store: Store, seen: Observation, e: int, nodes: Int32Array) -> None:
    """All of that, for a row without delayed scans.

    `nodes`: (hypothesis, node) where an item of each start is now.
    """
    foragers_at = begin(store, seen, e)
    expect(store, seen, e, nodes, settle(store, seen, e, foragers_at))
