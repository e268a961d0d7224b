"""Who is on the water: roles, teams and the flat agent table that kernels read."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from graph_planner.fields import Within

UNLIMITED = int(np.iinfo(np.int64).max)
"""Capacity of an agent that can take any number of items aboard."""


@dataclass(frozen=True)
class Role:
    """What every agent of one team can do. Any number of roles; `collects` makes a forager."""

    count: Annotated[int, Within(0, 255, "agents")]
    """Agents in the team."""
    moves: Annotated[int, Within(1, 100, "nodes")]
    """Nodes an agent moves per decision, in one direction."""
    radius: Annotated[float, Within(0, 1000, "node")]
    """Sensing radius."""
    collects: bool
    """Whether it removes the items of the node it is in (a forager) or not (a scout)."""
    capacity: Annotated[int, Within(0, 1_000_000, "items")] = 0
    """Items an agent can take aboard in one episode; 0 means unlimited."""
    energy: Annotated[float, Within(0, 1e12, "node")] = 0.0
    """Distance an agent can travel in one episode; 0 means unlimited."""


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
