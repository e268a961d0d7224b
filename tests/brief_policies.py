"""All policies, with brief searches: for tests of properties that every policy must have.

Tests of their own look at the results of searches. A batch, a link or a fleet changes no bit of
them, however long the search is.
"""

from mjforage.graph_planner.policies import policy_names

BRIEF = {"dec-mcts": "dec-mcts(simulations=6)"}


def brief_policies() -> list[str]:
    """Return every policy, as `create_policy` takes it."""
    return [BRIEF.get(name, name) for name in policy_names()]
