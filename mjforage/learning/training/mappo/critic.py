"""Central critic: value of every agent's share of the return, from all observations.

Its size depends neither on the map nor on the fleet: agents' numbers are embedded one by one and
averaged over each team (Zaheer et al. 2017, *Deep Sets*), their maps are averaged, and the truth
is added (`critic_features`). An agent's value reads this and its own embedding: the agent-specific
global state that Yu et al. (2022, section 5.2) recommend. Needs torch.
"""

from collections.abc import Mapping, Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from mjforage.graph_planner.encodings import Shapes
from mjforage.graph_planner.networks.q_network import HEAD, LEVELS, WIDTH, eye, eye_size, key_of
from mjforage.learning.training.mappo.critic_features import CRITIC_FEATURES


class Critic(nn.Module):
    """Values in units of the returns' spread, see `trainer`."""

    def __init__(self, shapes: Shapes, teams: Sequence[NDArray[np.int64]]) -> None:
        """Build; `shapes`: of one agent's arrays; `teams`: agents of each team."""
        super().__init__()
        self.teams = [torch.from_numpy(ids.astype(np.int64)) for ids in teams]
        every = shapes | CRITIC_FEATURES
        self.maps = nn.ModuleDict(
            {key_of(name): eye(shape) for name, shape in every.items() if len(shape) == 3}
        )
        self.flat = [name for name, shape in shapes.items() if len(shape) < 3]
        self.pictures = [name for name, shape in every.items() if len(shape) == 3]
        numbers = sum(torch.Size(shapes[name]).numel() for name in self.flat)
        self.embedding = nn.Sequential(nn.Linear(numbers, HEAD), nn.ReLU())
        width = sum(eye_size(self.maps[key_of(name)], every[name]) for name in self.pictures)
        width += HEAD * len(teams) + CRITIC_FEATURES["truth.facts"][0]
        self.trunk = nn.Sequential(nn.Linear(width, WIDTH), nn.ReLU())
        self.value = nn.Sequential(nn.Linear(WIDTH + HEAD, HEAD), nn.ReLU(), nn.Linear(HEAD, 1))

    def forward(self, levels: Mapping[str, Tensor]) -> Tensor:
        """(row, agent, 1) values of levels (row, agent, ...) and `CRITIC_FEATURES` (row, ...)."""
        seen = {name: level.float() / LEVELS for name, level in levels.items()}
        own = self.embedding(torch.cat([seen[name].flatten(2) for name in self.flat], dim=2))
        parts = [
            own[:, ids].mean(dim=1) if len(ids) else own[:, :1, :].sum(dim=1) * 0.0
            for ids in self.teams
        ]
        for name in self.pictures:
            picture = seen[name] if name in CRITIC_FEATURES else seen[name].mean(dim=1)
            parts.append(self.maps[key_of(name)](picture))
        trunk = self.trunk(torch.cat([*parts, seen["truth.facts"]], dim=1))
        every = trunk[:, None].expand(-1, own.shape[1], -1)
        values: Tensor = self.value(torch.cat((every, own), dim=2))
        return values
