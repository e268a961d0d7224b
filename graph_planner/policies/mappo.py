"""Multi-agent PPO: shipped weights, an actor per team. Playing them needs torch, not TorchRL."""

from mjforage.graph_planner.networks.weights import ACTOR
from mjforage.graph_planner.policies.ddqn import ShippedPolicy
from mjforage.graph_planner.policies.registry import register


@register("mappo")
class MappoPolicy(ShippedPolicy):
    """Multi-agent PPO, actors shared per team, a critic that sees all in training."""

    weights, kind = "mappo", ACTOR
