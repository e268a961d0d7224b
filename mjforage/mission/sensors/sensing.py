"""Imperfect scans: which items each agent detects, and false positives.

The draws are of (item, step), the same for all agents: agents at the same distance detect or miss
an item together. False positives are of (node, epoch). Scenario: `[sensors]`.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import betaincinv

from mjforage.base.compiled import kernel
from mjforage.base.randomness import Stream, UInt64Array, stream_key, uniform
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.mission.knowledge import Scans
from mjforage.mission.ledger import Ledger
from mjforage.mission.scan_log import widest_view
from mjforage.mission.sensors.detection import chances_by_square, squares_in_view
from mjforage.mission.sensors.map_filter import NOT_SEEN, MapFilter
from mjforage.mission.task import Task
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.sensors import Sensors

_EDGE = 1e-9  # of the cosine at which a field of view ends


class Sensing(NamedTuple):
    """Imperfect sensing of a batch of fleets."""

    chance: NDArray[np.float64]  # (square,) to detect an item, by squared distance
    share: NDArray[np.float64]  # (episode, item) by which that is multiplied
    merge: float  # chance to overlook an item beside another
    false_rate: float  # false positives per node and epoch
    false_hold: int  # decisions of an epoch
    half_view: float  # cosine of half the field of view
    collects: NDArray[np.bool_]  # (agent,)
    rows: Int32Array  # (node,)
    cols: Int32Array
    place: NDArray[np.int64]  # (node,) memory: one more than its place in a view, 0 not in it
    manned: NDArray[np.bool_]  # (node,) memory: a collector is there


def detection_chances(sensors: Sensors, task: Task) -> NDArray[np.float64]:
    """(square,) chance to detect an item, by its squared distance."""
    about = sensors.detection, sensors.half_range_node, sensors.slope_node
    return chances_by_square(squares_in_view(task), *about, sensors.detection_table)


def persistent_shares(sensors: Sensors, keys: UInt64Array, items: int) -> NDArray[np.float64]:
    """Factors on the chance to detect each item: (episode, item).

    p_k of a beta distribution of mean p and a + b = 1 / rho - 1, over p: the correlation of
    detecting an item in two steps is rho.
    """
    p = sensors.detection_table[0][1] if sensors.detection_table else sensors.detection
    if sensors.persistence == 0.0 or not 0.0 < p < 1.0:
        return np.ones((keys.size, items))
    together = 1.0 / sensors.persistence - 1.0
    draws = _draws(keys, items)
    return np.asarray(betaincinv(p * together, (1.0 - p) * together, draws) / p)


@kernel
def _draws(keys: UInt64Array, items: int) -> NDArray[np.float64]:
    """(episode, item) uniform in [0, 1)."""
    out = np.empty((keys.size, items))
    for e in range(keys.size):
        key = stream_key(keys[e], Stream.PERSISTENCE)
        for k in range(items):
            out[e, k] = uniform(key, k, 0)
    return out


def sensing(sensors: Sensors, task: Task, keys: UInt64Array, items: int) -> Sensing:
    """Sensing of a batch of episodes (keys), each of at most `items` items."""
    return Sensing(
        chance=detection_chances(sensors, task),
        share=persistent_shares(sensors, keys, items),
        merge=sensors.merge,
        false_rate=sensors.false_rate,
        false_hold=sensors.false_hold,
        half_view=math.cos(math.radians(sensors.fov_deg) / 2.0),
        collects=task.fleet.collects,
        rows=task.graph.rows,
        cols=task.graph.cols,
        place=np.zeros(len(task.graph), np.int64),
        manned=np.zeros(len(task.graph), np.bool_),
    )


def map_filter(scenario: Scenario, task: Task, rows: int) -> MapFilter:
    """Filter of counts for `rows` rows of knowledge; of size 0 if they believe the last scan."""
    nodes, sensors = len(task.graph), scenario.sensors
    weighs = sensors.map == "filtered" and not sensors.perfect
    prior, size = scenario.items.mean / nodes, rows if weighs else 0
    return MapFilter(
        density=np.full((size, nodes), prior),
        chance=detection_chances(sensors, task),
        false_rate=sensors.false_rate,
        prior=prior,
        views=task.views,
        radius_number=task.radius_number,
        rows=task.graph.rows,
        cols=task.graph.cols,
        counted=np.full(nodes, NOT_SEEN, np.int16),
        best=np.zeros(nodes),
    )


def no_shown(task: Task, episodes: int, perfect: bool) -> NDArray[np.int16]:
    """Memory for the counts of scans (episode, agent, place); of size 0 if scans are perfect."""
    places = 0 if perfect else widest_view(task)
    return np.full((episodes, len(task.fleet), places), NOT_SEEN, np.int16)


@kernel
def _mark_view(
    sensing: Sensing,
    views: NodeLists,
    radius: int,
    viewer: int,
    yaw: float,
    shown: NDArray[np.int16],
) -> None:
    """Note which nodes of a list are in the field of view: 0 items so far, and their places."""
    first, nodes, rows, cols = views.start[radius, viewer], views.nodes, sensing.rows, sensing.cols
    east, north = math.cos(yaw), math.sin(yaw)
    for i in range(first, views.start[radius, viewer + 1]):
        node = nodes[i]
        down, right = rows[node] - rows[viewer], cols[node] - cols[viewer]
        away = math.sqrt(float(down * down + right * right))
        ahead = right * east - down * north  # rows count southward
        in_view = away == 0.0 or ahead >= away * (sensing.half_view - _EDGE)
        shown[i - first] = 0 if in_view else NOT_SEEN
        sensing.place[node] = i - first + 1 if in_view else 0


@kernel
def _detect(
    sensing: Sensing,
    ledger: Ledger,
    key: np.uint64,
    e: int,
    step: int,
    agent: int,
    viewer: int,
    shown: NDArray[np.int16],
) -> None:
    """Count the items in view that an agent detects, and credit those not yet discovered."""
    rows, cols, place = sensing.rows, sensing.cols, sensing.place
    drawn, merging = stream_key(key, Stream.DETECTION), stream_key(key, Stream.MERGING)
    for k in range(ledger.places[e]):
        node = ledger.counted_node[e, k]
        if node < 0 or place[node] == 0:
            continue
        down, right = rows[node] - rows[viewer], cols[node] - cols[viewer]
        chance = sensing.chance[down * down + right * right] * sensing.share[e, k]
        if uniform(drawn, k, step) >= chance:
            continue
        beside = shown[place[node] - 1] > 0
        if beside and sensing.merge > 0.0 and uniform(merging, k, step) < sensing.merge:
            continue
        shown[place[node] - 1] += 1
        if ledger.t_discovered[e, k] < 0:
            ledger.t_discovered[e, k], ledger.discovered_by[e, k] = step, agent


@kernel
def _add_false_positives(
    sensing: Sensing, nodes: Int32Array, key: np.uint64, step: int, shown: NDArray[np.int16]
) -> None:
    """Add false positives in view (node,), but where a collector is: it would wait for ever."""
    epoch, drawn = step // sensing.false_hold, stream_key(key, Stream.FALSE_POSITIVES)
    for i in range(nodes.size):
        if shown[i] >= 0 and not sensing.manned[nodes[i]]:
            shown[i] += uniform(drawn, nodes[i], epoch) < sensing.false_rate


@kernel
def sense(
    sensing: Sensing,
    keys: UInt64Array,
    scans: Scans,
    credit_order: NDArray[np.int64],
    views: NodeLists,
    radius_number: NDArray[np.int64],
    ledger: Ledger,
) -> None:
    """Fill the counts of the scans of a step, and credit first detections.

    Parameters
    ----------
    scans : `shown` is filled in the rows of active episodes
    credit_order : (agent,) as agents are credited with what several detect first
    """
    at, start, collects = scans.agent_node, views.start, sensing.collects
    for e in range(scans.active.size):
        if not scans.active[e]:
            continue
        step = scans.step[e]
        for agent in range(collects.size):
            sensing.manned[at[e, agent]] |= collects[agent]
        for agent in credit_order:
            radius, viewer, shown = radius_number[agent], at[e, agent], scans.shown[e, agent]
            nodes = views.nodes[start[radius, viewer] : start[radius, viewer + 1]]
            _mark_view(sensing, views, radius, viewer, scans.agent_yaw[e, agent], shown)
            _detect(sensing, ledger, keys[e], e, step, agent, viewer, shown)
            if sensing.false_rate > 0.0:
                _add_false_positives(sensing, nodes, keys[e], step, shown)
            for i in range(nodes.size):
                sensing.place[nodes[i]] = 0
        for agent in range(collects.size):
            sensing.manned[at[e, agent]] = False
