"""Decentralised Monte-Carlo tree search: each agent plans for itself, and shares its plan.

G. Best, O. M. Cliff, T. Patten, R. R. Mettu and R. Fitch, "Dec-MCTS: Decentralized planning for
multi-robot active perception", International Journal of Robotics Research 38(2-3), 2019. Beliefs
about items are those of the policy `belief`; the searches are those of `graph_planner.dec_mcts`.
Over a link an owner plays the others' searches too, from its own knowledge.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.option_ranges import check_at_least, check_positive
from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.belief_planner.foraging import Foraging
from mjforage.graph_planner.belief_planner.planner import BeliefPlanner
from mjforage.graph_planner.belief_planner.scouting import Scouting
from mjforage.graph_planner.belief_planner.settings import LAW_OF_ITEMS, BeliefSettings
from mjforage.graph_planner.dec_mcts.foraging import TreeForaging
from mjforage.graph_planner.dec_mcts.scouting import TreeScouting
from mjforage.graph_planner.dec_mcts.search import DecisionContext, TreeOptions
from mjforage.graph_planner.policies.registry import register
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


@register("dec-mcts")
class DecMctsPolicy:
    """Decentralised tree search: agents plan by turns against distributions of the others' plans.

    Parameters
    ----------
    rounds : in which agents plan and exchange distributions, in each decision
    simulations : of each agent in a round
    candidates : sequences in a distribution
    samples : of the others' sequences by which a distribution is updated in a round
    discount : worth of an item that is met a decision later
    look_discount : worth of a view that is had a decision later
    explore : factor of the confidence bound
    forget : worth of a simulation one simulation later (discounted bounds)
    heat : temperature of the distributions at first, in ranges of the utility
    cool : factor of the temperature from round to round
    rate : of the gradient steps of the distributions
    roam : how much rollouts differ from the greedy one
    depth : most stops, or moves, in a sequence
    trust : decisions unheard of after which a team-mate is counted on half of the time
    """

    told = LAW_OF_ITEMS

    def __init__(
        self,
        rounds: int = 4,
        simulations: int = 48,
        candidates: int = 8,
        samples: int = 8,
        discount: float = 0.97,
        look_discount: float = 0.97,
        explore: float = 0.1,
        forget: float = 0.995,
        heat: float = 0.1,
        cool: float = 0.6,
        rate: float = 0.3,
        roam: float = 0.5,
        depth: int = 10,
        trust: float = 20.0,
    ) -> None:
        given: dict[str, Any] = {n: v for n, v in locals().items() if n in TreeOptions._fields}
        counts = {name: given[name] for name in ("rounds", "simulations", "candidates")}
        check_at_least("dec-mcts", 1, samples=samples, depth=depth, **counts)
        for name in ("discount", "look_discount", "forget", "cool", "rate"):
            if not 0.0 < given[name] <= 1.0:
                raise UserError(f"dec-mcts: {name} {given[name]} is no share; give above 0 to 1")
        for name in ("discount", "look_discount"):
            if given[name] == 1.0:
                raise UserError(f"dec-mcts: {name} {given[name]} is too large; give less than 1")
        check_at_least("dec-mcts", 0, explore=explore, roam=roam)
        check_positive("dec-mcts", heat=heat, trust=trust)
        kinds = TreeOptions.__annotations__.items()
        self._options = TreeOptions(**{name: kind(given[name]) for name, kind in kinds})

    def reset(self, task: Task, keys: UInt64Array) -> None:
        """Get ready for a batch of episodes (episode,)."""
        self.planner = TreePlanner(task, keys, self._options)

    def act(self, observation: Observation) -> NDArray[np.float64]:
        """Preferences (episode, agent, 9)."""
        return self.planner.act(observation)

    def forecast(self) -> NDArray[np.float64]:
        """(row, node) items expected, known and unseen ones, as of the last answer."""
        return self.planner.beliefs.forecast()
