"""Rewards as named terms: each is a number per agent, times the weight of the same name.

| term | meaning of one unit |
|---|---|
| collected | all items of the episode, removed by anyone; shared equally by all agents |
| early | the same, times the share of the horizon that is left |
| known | potential: all items discovered by this agent and afloat |
| reach | potential: all items discovered and at the node of this agent (that collects) |
| fresh | potential: a map without idleness; shared equally by all agents |
| removed | an item removed by this agent |
| team_removed | an item removed by anyone, shared equally by all agents |
| discovered | an item first discovered by this agent |
| belief | a change of the belief map by one item in view; shared where views overlap |
| idleness | a node of idleness 1 that came into view (agents that do not collect) |
| distance | one node of geodesic distance to the nearest known item; 0 if none is known |
| approach | one node nearer to the nearest item known before the move (agents that collect) |
| blocked | a decision without a legal move |
| time | a decision of an episode that is not over |

A potential's term is its discounted difference, see the module `potentials`. One class in one file
each. A file that is put beside these is found without an edit elsewhere; a class in a package of
your own is found by the entry point `mjforage.rewards` or by `package.module:Class`.
"""

import importlib
import pkgutil

from mjforage.learning.environments.rewards.known import (
    REWARDS,
    RewardTerms,
    checked_names,
    checked_weights,
    create_term,
    labelled,
    reward,
    term_class,
)
from mjforage.learning.environments.rewards.potentials import Potential
from mjforage.learning.environments.rewards.presets import DDQN, PRESETS, PUBLISHED, reward_weights
from mjforage.learning.environments.rewards.term import Amounts, Before, Step, Term

__all__ = [
    "DDQN",
    "PRESETS",
    "PUBLISHED",
    "REWARDS",
    "Amounts",
    "Before",
    "Potential",
    "RewardTerms",
    "Step",
    "Term",
    "checked_names",
    "checked_weights",
    "create_term",
    "labelled",
    "reward",
    "reward_weights",
    "term_class",
]

for _module in pkgutil.iter_modules(__path__):
    importlib.import_module(f"{__name__}.{_module.name}")
