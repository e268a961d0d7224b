"""All policies, those that search told to search briefly: for tests of what any policy must keep.

What a search finds is of their own tests; that a batch, a link or a fleet changes no bit of it
does not depend on how long it searches.
"""

from mjforage.graph_planner.policies import policy_names

BRIEF = {"dec-mcts": "dec-mcts(simulations=6)", "orienteering": "orienteering(solutions=30)"}


def brief_policies() -> list[str]:
    """Return every policy, as `create_policy` takes it."""
    return [BRIEF.get(name, name) for name in policy_names()]
