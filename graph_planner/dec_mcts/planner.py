"""The belief planner's knowledge and habits, with searches by trees in the place of its own."""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.belief_planner.foraging import Foraging
from mjforage.graph_planner.belief_planner.planner import BeliefPlanner
from mjforage.graph_planner.belief_planner.scouting import Scouting
from mjforage.graph_planner.belief_planner.settings import BeliefSettings
from mjforage.graph_planner.dec_mcts.foraging import TreeForaging
from mjforage.graph_planner.dec_mcts.scouting import TreeScouting
from mjforage.graph_planner.dec_mcts.search import DecisionContext, TreeOptions
from mjforage.mission.task import Observation, Task


class TreePlanner(BeliefPlanner):
    """Beliefs and plans of a batch of rows, by decentralised Monte-Carlo tree search."""

    def __init__(self, task: Task, keys: UInt64Array, options: TreeOptions) -> None:
        self._options, self._context = options, DecisionContext(options.trust)
        super().__init__(task, keys)

    def _foraging(self, settings: BeliefSettings) -> Foraging:
        return TreeForaging(self._task, settings, self._options, self._context)

    def _scouting(self, settings: BeliefSettings, agents: NDArray[np.int64]) -> Scouting:
        return TreeScouting(self._task, settings, agents, self._options, self._context)

    def _decide(self, seen: Observation, e: int) -> None:
        self._context.is_of(seen, e)
        super()._decide(seen, e)
