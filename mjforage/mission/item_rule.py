"""The graph world's rule for items: foragers remove what is in their node, the rest drift.

Items drift by a constant vector plus independent noise per item and step (definitions, section 1).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, inlined, kernel
from mjforage.base.device import Launch
from mjforage.base.randomness import Stream, UInt64Array, fill_bits, stream_key
from mjforage.base.rows import scatter_all
from mjforage.forcing.item_noise import to_symmetric
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.navigation import NavigationGraph, Water
from mjforage.graph_planner.graph.walls import WALLS, into_water, put_back
from mjforage.mission.capture_chances import Chances, chances_of
from mjforage.mission.capture_rule import Stays, collect_by_chance
from mjforage.mission.carrying import Carrier
from mjforage.mission.dynamics import Transition
from mjforage.mission.initial_state import InitialState, item_places
from mjforage.mission.task import IDLE, TAKEN
from mjforage.scenario.place import Place
from mjforage.scenario.roles import Fleet
from mjforage.scenario.scenario import Scenario

_AHEAD = 1.0 - 1e-6  # [node] of both offsets together, with room for rounding


class Surroundings(NamedTuple):
    """Conditions that act on the items of a batch."""

    collects: NDArray[np.bool_]  # (agent,)
    room_left: NDArray[np.int64]  # (episode, agent) items
    places: NDArray[np.int64]  # (episode,) see `item_places`
    keys: UInt64Array  # (episode,)
    drift_rc: NDArray[np.float64]  # (episode, 2) [node/step]
    carried: NDArray[np.float64]  # (episode, item x 2) way by wind and current, or (episode, 0)
    noise: float  # half width of the drift's random part [node/step]
    water: Water
    corners: NDArray[np.bool_]  # (node, 4) see `NavigationGraph.corners`
    walls: int  # place in `WALLS`


class Scratch(NamedTuple):
    """Memory for the items of one episode at a time."""

    draws: UInt64Array  # (item,)
    shift: NDArray[np.float64]  # (item x 2) by which they move
    beyond: NDArray[np.uint8]  # (item x 2) whether each of their coordinates left its node's square
    gone: Int32Array  # (item,) those of which one did


@kernel
def collect(
    active: NDArray[np.bool_],
    collects: NDArray[np.bool_],
    room_left: NDArray[np.int64],
    state: Transition,
) -> None:
    """Let every forager remove the items in its node, in index order, while it has room."""
    agent_node, item_node, collected_by = state.agent_node, state.item_node, state.collected_by
    pickup = state.pickup
    for e in range(active.size):
        if not active[e]:
            continue
        for agent in range(collects.size):
            if not collects[agent]:
                continue
            node, found, pickup[e, agent] = agent_node[e, agent], 0, IDLE
            for k in range(item_node.shape[1]):  # without a branch: a vector loop
                found += item_node[e, k] == node
            if found == 0:
                continue
            pickup[e, agent] = TAKEN if room_left[e, agent] > 0 else IDLE
            for k in range(item_node.shape[1]):
                if item_node[e, k] == node and room_left[e, agent] > 0:
                    item_node[e, k] = -1
                    collected_by[e, k] = agent
                    room_left[e, agent] -= 1


COLLECT = Launch(collect, shared="collects")


@inlined
def _nearest_of_four(
    framed: Int32Array, here: int, row: int, col: int, off_row: float, off_col: float
) -> int:
    """The nearest of the four nodes around an item that lies on land less than a node from one.

    Parameters
    ----------
    here : node whose centre is (row, col); ties go to the lowest number
    off_row, off_col : the item's signed distance from it, below 1 node in all
    """
    down, right = 2 * (off_row >= 0) - 1, 2 * (off_col >= 0) - 1
    off_row, off_col, nearest = abs(off_row), abs(off_col), here
    squared = off_row * off_row + off_col * off_col
    for at_row, at_col in ((1, 0), (0, 1), (1, 1)):
        node = framed[np.uint64(row + 1 + at_row * down), np.uint64(col + 1 + at_col * right)]
        there = (at_row - off_row) ** 2 + (at_col - off_col) ** 2
        nearer = (there < squared) | ((there == squared) & (node < nearest))
        nearer = nearer & (node >= 0)
        nearest = int(node) if nearer else nearest
        squared = there if nearer else squared
    return nearest


@kernel
def _drift(
    around: Surroundings,
    item_rc: NDArray[np.float64],
    centre: NDArray[np.float32],
    item_node: Int32Array,
    scratch: Scratch,
    active: NDArray[np.bool_],
    step: Int32Array,
) -> None:
    """Move every item left by the episode's drift and its own noise, and put those that left the
    square of their node into the node they are in, or back into the water.

    The loops over all items have no branch and go through what lies side by side: the compiler
    makes vectors of the first two, and whether an item on a quay leaves its square is a coin toss
    that no processor predicts.

    `item_rc`, `centre`: (episode, item x 2) row, column, row, ... of the items and of their nodes.
    """
    keys, drift_rc, noise, corners = around.keys, around.drift_rc, around.noise, around.corners
    places, carried = around.places, around.carried
    water, walls = around.water, around.walls
    framed, rows, cols = water
    bottom, right_edge = framed.shape[0] - 3, framed.shape[1] - 3
    draws, shift, beyond, gone = scratch
    for e in range(active.size):
        if not active[e]:
            continue
        n_items = places[e]
        fill_bits(stream_key(keys[e], Stream.NOISE), step[e], n_items, draws)
        drift_row, drift_col = drift_rc[e, 0], drift_rc[e, 1]
        for k in range(n_items):
            noise_row, noise_col = to_symmetric(draws[k])
            to_row, to_col = drift_row + noise * noise_row, drift_col + noise * noise_col
            left = item_node[e, k] >= 0
            shift[2 * k] = to_row if left else 0.0
            shift[2 * k + 1] = to_col if left else 0.0
        for j in range(min(carried.shape[1], 2 * n_items)):
            shift[j] += carried[e, j] if item_node[e, j // 2] >= 0 else 0.0
        for j in range(2 * n_items):
            moved = item_rc[e, j] + shift[j]
            item_rc[e, j] = moved
            beyond[j] = abs(moved - centre[e, j]) >= 0.5
        n_gone = 0
        for k in range(n_items):
            gone[n_gone] = k
            n_gone += (beyond[2 * k] | beyond[2 * k + 1]) & (item_node[e, k] >= 0)
        for i in range(n_gone):
            k_gone = np.uint64(gone[i])  # unsigned: an index that never counts from the end
            at_row, at_col = 2 * k_gone, 2 * k_gone + np.uint64(1)
            row, col = item_rc[e, at_row], item_rc[e, at_col]
            before = int(item_node[e, k_gone])
            centre_row, centre_col = centre[e, at_row], centre[e, at_col]
            off_row, off_col = row - centre_row, col - centre_col
            far_row, far_col = abs(off_row), abs(off_col)
            inside = (row >= 0.0) & (row <= bottom) & (col >= 0.0) & (col <= right_edge)
            after = -1
            if inside:
                after = int(framed[np.uint64(row + 1.5), np.uint64(col + 1.5)])
            if after < 0:
                # On a quay, mostly straight ahead of its node or in a corner: no other is nearer.
                ahead = far_row + far_col < _AHEAD
                side = 2 * np.uint64(off_row >= 0) + np.uint64(off_col >= 0)
                near = inside & (far_row * far_row + far_col * far_col < 1.0)
                if near & (ahead | corners[np.uint64(before), side]):
                    after = before
                    row, col = put_back(walls, row, col, centre_row, centre_col)
                elif near:
                    r, c = rows[before], cols[before]
                    after = _nearest_of_four(framed, before, r, c, off_row, off_col)
                    row, col = put_back(walls, row, col, rows[after], cols[after])
                else:
                    row, col, after = into_water(water, walls, row, col)
                item_rc[e, at_row], item_rc[e, at_col] = row, col
            if after != before:
                item_node[e, k_gone] = after
                centre[e, at_row], centre[e, at_col] = rows[after], cols[after]


@kernel
def _advance(
    around: Surroundings,
    state: Transition,
    item_rc: NDArray[np.float64],
    centre: NDArray[np.float32],
    scratch: Scratch,
    active: NDArray[np.bool_],
    step: Int32Array,
) -> None:
    """One step of the items of every active episode: collect, then drift."""
    collect(active, around.collects, around.room_left, state)
    _drift(around, item_rc, centre, state.item_node, scratch, active, step)


@kernel
def _advance_by_chance(
    chances: Chances,
    stays: Stays,
    around: Surroundings,
    state: Transition,
    item_rc: NDArray[np.float64],
    centre: NDArray[np.float32],
    scratch: Scratch,
    active: NDArray[np.bool_],
    step: Int32Array,
) -> None:
    """The same where foragers miss items."""
    framed, keys, room_left = around.water.framed, around.keys, around.room_left
    collects = around.collects
    collect_by_chance(chances, stays, framed, keys, active, step, collects, room_left, state)
    _drift(around, item_rc, centre, state.item_node, scratch, active, step)


class ItemRule:
    """Items of a batch of episodes, moved by the paper's rule.

    Attributes
    ----------
    advance : one step once all have moved, from `active` and `step` (episode,): collect, then drift
    """

    def __init__(
        self,
        graph: NavigationGraph,
        fleet: Fleet,
        noise: float,
        walls: str,
        chances: Chances | None = None,
        carrier: Carrier | None = None,
    ) -> None:
        """Prepare.

        Parameters
        ----------
        noise : half width of the drift's random part [node/step]
        walls : boundary condition of items that drift onto land, of `WALLS`
        chances : of agents to take an item, see `chances_of`; None: they take all in their node
        carrier : wind and current that carry items beside their constant drift, if any
        """
        self._graph, self._fleet, self._noise = graph, fleet, noise
        self.chances, self._walls, self._carrier = chances, WALLS.index(walls), carrier

    def reset(self, initial: InitialState, keys: UInt64Array, state: Transition) -> None:
        """Start a batch of episodes.

        `state`: of the world at step 0; `advance` changes its items.
        """
        if self._carrier is not None:
            self._carrier.reset(keys, initial.item_node)
        self._begin(self._surroundings(initial, keys), Stays.of(state), state)

    def restart(
        self,
        rows: NDArray[np.int64],
        initial: InitialState,
        keys: UInt64Array,
        fresh: Transition,
        state: Transition,
    ) -> None:
        """Start other episodes in some rows (row,) of the batch.

        `fresh`, `state`: of these episodes (row, ...) at step 0, and of the whole batch with them;
        `advance` changes the items of the latter.
        """
        if self._carrier is not None:
            self._carrier.restart(rows, keys, initial.item_node)
        names = "keys", "places", "drift_rc", "room_left"
        around = scatter_all(self._around, rows, self._surroundings(initial, keys), only=names)
        self._begin(around, scatter_all(self._stays, rows, Stays.of(fresh)), state)

    def _surroundings(self, initial: InitialState, keys: UInt64Array) -> Surroundings:
        return Surroundings(
            collects=self._fleet.collects,
            room_left=np.tile(self._fleet.capacity, (keys.size, 1)),
            places=item_places(initial.item_node),
            keys=keys,
            drift_rc=initial.drift_rc,
            carried=np.empty((keys.size, 0)),
            noise=self._noise,
            water=self._graph.water,
            corners=self._graph.corners,
            walls=self._walls,
        )

    def drift_rc(self, rc: NDArray[np.float64], items: bool) -> NDArray[np.float64]:
        """(episode, place, 2) drift now, as `Dynamics.drift_rc` [node/step]."""
        if self._carrier is not None:
            return self._carrier.drift_rc(rc, items)
        return np.broadcast_to(self._around.drift_rc[:, None], rc.shape)

    @property
    def room_left(self) -> NDArray[np.int64]:
        """(episode, agent) items that can still be taken aboard; live."""
        return self._around.room_left

    def _begin(self, around: Surroundings, stays: Stays, state: Transition) -> None:
        water, items = around.water, state.item_node
        if self._carrier is not None:
            around = around._replace(carried=np.zeros((len(items), 2 * items.shape[1])))
        self._around, self._stays, self._item_rc = around, stays, state.item_rc
        centre = np.stack((water.rows[items], water.cols[items]), axis=-1)
        scratch = Scratch(
            draws=np.empty(items.shape[1], np.uint64),
            shift=np.empty(2 * items.shape[1]),
            beyond=np.empty(2 * items.shape[1], np.uint8),
            gone=np.empty(items.shape[1], np.int32),
        )
        by_episode = len(items), -1
        places = state.item_rc.reshape(by_episode), centre.reshape(by_episode).astype(np.float32)
        fixed = around, state, *places, scratch
        if self.chances is None:
            self._kernel = BoundKernel(_advance, *fixed)
        else:
            self._kernel = BoundKernel(_advance_by_chance, self.chances, stays, *fixed)
        self.advance = self._kernel if self._carrier is None else self._carry

    def _carry(self, active: NDArray[np.bool_], step: Int32Array) -> None:
        """One step of items that wind and current carry."""
        assert self._carrier is not None
        way = self._carrier.carry(active, self._item_rc)
        self._around.carried[:] = way.reshape(self._around.carried.shape)
        self._kernel(active, step)


def item_rule(
    graph: NavigationGraph, fleet: Fleet, scenario: Scenario, place: Place | None
) -> ItemRule:
    """The rule of a scenario; raises `UserError` as `chances_of` and `Carrier`."""
    carrier = Carrier(graph, scenario, place) if scenario.weather.forced else None
    about = scenario.weather.noise_node_per_step, scenario.rules.walls
    return ItemRule(graph, fleet, *about, chances_of(fleet, scenario), carrier)
