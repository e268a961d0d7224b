"""Multi-agent PPO: shipped weights, an actor per team. Playing them needs torch, not TorchRL."""

from graph_planner.policies.ddqn import ShippedPolicy
from graph_planner.policies.registry import register
from graph_planner.weights import ACTOR


@register("mappo")
class MappoPolicy(ShippedPolicy):
    """Multi-agent PPO, actors shared per team, a critic that sees all in training."""

    weights, kind = "mappo", ACTOR
