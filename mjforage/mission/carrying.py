"""Items at graph level that wind and water carry, in time and place, each by its leeway."""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import UInt64Array
from mjforage.base.rows import scatter_rows
from mjforage.forcing import LEEWAY, Forcing
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.navigation import NavigationGraph
from mjforage.mission.item_classes import draw_classes, leeways
from mjforage.scenario.debris import item_choices
from mjforage.scenario.place import Place
from mjforage.scenario.scenario import Scenario

FloatArray = NDArray[np.float64]


class Carrier:
    """Drift of the items of a batch by wind and current, without gusts, which last seconds."""

    def __init__(self, graph: NavigationGraph, scenario: Scenario, place: Place | None) -> None:
        """Prepare; raises `UserError` if an item class is not known, or as `Forcing.create`."""
        self._choices, self._period_s = item_choices(scenario.physics), scenario.period_s
        self._graph, self._scenario, self._place = graph, scenario, place
        self._forced(np.zeros(1, np.uint64))

    def reset(self, keys: UInt64Array, item_node: Int32Array) -> None:
        """Start a batch; of items (episode, item) -1 is padding."""
        self._keys, self._t_s = keys, np.zeros(keys.size)
        self._leeway = leeways(draw_classes(keys, item_node, self._choices))
        self._forced(keys)

    def restart(self, rows: NDArray[np.int64], keys: UInt64Array, item_node: Int32Array) -> None:
        """Start other episodes in some rows (row,) of the batch."""
        of_rows = leeways(draw_classes(keys, item_node, self._choices))
        self._leeway = scatter_rows(self._leeway, rows, of_rows)
        self._keys = scatter_rows(self._keys, rows, keys)
        self._t_s[rows] = 0.0
        self._forced(self._keys)

    def _forced(self, keys: UInt64Array) -> None:
        self._forcing = Forcing.of(self._scenario, keys, self._graph, self._place)

    def drift_rc(self, rc: FloatArray, items: bool) -> FloatArray:
        """(episode, place, 2) steady velocity now, as `Dynamics.drift_rc` [node/step]."""
        return self._forcing.carried_rc(self._t_s, rc, self._leeway if items else LEEWAY)

    def carry(self, active: NDArray[np.bool_], rc: FloatArray) -> FloatArray:
        """Way (episode, item, 2) of active episodes in the coming decision [node].

        By the midpoint rule: the velocity after half the time, where half the way then leads.
        """
        half_s = 0.5 * self._period_s
        there = rc + 0.5 * self.drift_rc(rc, True)
        way = self._forcing.carried_rc(self._t_s + half_s, there, self._leeway)
        self._t_s[active] += self._period_s
        return way
