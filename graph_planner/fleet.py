"""Who is on the water: roles, teams and the flat agent table that kernels read."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

UNLIMITED = int(np.iinfo(np.int64).max)
"""Capacity of an agent that can take any number of items aboard."""


@dataclass(frozen=True)
class Role:
    """What every agent of one team can do. Any number of roles; `collects` makes a forager.

    Attributes
    ----------
    count : agents in the team, 0 or more
    moves : nodes an agent moves per decision, in one direction, 1 or more
    radius : sensing radius [node], 0 or more
    collects : whether it removes the items of the node it is in (a forager) or not (a scout)
    capacity : items an agent can take aboard in one episode; 0 means unlimited
    energy : distance an agent can travel in one episode [node]; 0 means unlimited
    """

    count: int = field(metadata={"low": 0, "high": 255})
    moves: int = field(metadata={"low": 1, "high": 100})
    radius: float = field(metadata={"low": 0, "high": 1000})
    collects: bool
    capacity: int = field(default=0, metadata={"low": 0, "high": 1_000_000})
    energy: float = field(default=0.0, metadata={"low": 0, "high": 1e12})


def agent_names(team: NDArray[np.int64], team_names: Sequence[str]) -> tuple[str, ...]:
    """Names of agents (agent,) of given teams: `scouts-0`, `scouts-1`, `foragers-0`, ..."""
    seen = dict.fromkeys(range(len(team_names)), -1)
    names = []
    for number in team.tolist():
        seen[number] += 1
        names.append(f"{team_names[number]}-{seen[number]}")
    return tuple(names)


@dataclass(frozen=True)
class Fleet:
    """The teams as one table of agents, in the order of the scenario's teams.

    Every array is (agent,).
    """

    team_names: tuple[str, ...]
    team: NDArray[np.int64]
    moves: NDArray[np.int64]
    radius: NDArray[np.float64]
    collects: NDArray[np.bool_]
    capacity: NDArray[np.int64]
    energy: NDArray[np.float64]

    @classmethod
    def of(cls, teams: Mapping[str, Role]) -> "Fleet":
        """Lay the teams out agent by agent."""
        roles = list(teams.values())
        counts = [role.count for role in roles]

        return cls(
            team_names=tuple(teams),
            team=np.repeat(np.arange(len(roles), dtype=np.int64), counts),
            moves=np.repeat(np.asarray([r.moves for r in roles], np.int64), counts),
            radius=np.repeat(np.asarray([r.radius for r in roles], np.float64), counts),
            collects=np.repeat(np.asarray([r.collects for r in roles], np.bool_), counts),
            capacity=np.repeat(
                np.asarray([r.capacity or UNLIMITED for r in roles], np.int64), counts
            ),
            energy=np.repeat(np.asarray([r.energy or np.inf for r in roles], np.float64), counts),
        )

    def __len__(self) -> int:
        return int(self.team.size)

    @property
    def names(self) -> tuple[str, ...]:
        """`scouts-0`, `scouts-1`, ...: team name and number within the team."""
        return agent_names(self.team, self.team_names)

    @property
    def scouts(self) -> NDArray[np.int64]:
        """Indices of the agents that do not collect."""
        return np.flatnonzero(~self.collects)

    @property
    def foragers(self) -> NDArray[np.int64]:
        """Indices of the agents that collect."""
        return np.flatnonzero(self.collects)

    @property
    def credit_order(self) -> NDArray[np.int64]:
        """Agents in the order in which a shared first sighting is credited: scouts first."""
        return np.concatenate((self.scouts, self.foragers))
