"""The fleet: roles, teams and the flat agent table that kernels read."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.fields import Handler, JsonSchema, Within
from mjforage.base.views import read_only

UNLIMITED = int(np.iinfo(np.int64).max)
"""Capacity of an agent that can take any number of items aboard."""
FROM_VESSEL: Literal["from vessel"] = "from vessel"
MOST_MOVES = 100  # nodes per decision


@dataclass(frozen=True)
class _Moves:
    """Reads nodes per decision, or the words that leave them to the vessel."""

    def __get_pydantic_core_schema__(self, kind: Any, handler: Handler) -> Any:
        from pydantic_core.core_schema import int_schema, no_info_wrap_validator_function

        return no_info_wrap_validator_function(self._read, int_schema(ge=1, le=MOST_MOVES))

    def __get_pydantic_json_schema__(self, core: object, handler: Handler) -> JsonSchema:
        number = {"minimum": 1, "maximum": MOST_MOVES, "unit": "node"}
        return {"type": ["integer", "string"], "pattern": f"^{FROM_VESSEL}$", **number}

    def _read(self, entry: object, number: Handler) -> object:
        from pydantic_core import PydanticCustomError

        if isinstance(entry, str) and entry != FROM_VESSEL:
            raise PydanticCustomError(
                "words", f' = "{{it}}"; give a number, or "{FROM_VESSEL}"', {"it": entry[:60]}
            )
        return entry if entry == FROM_VESSEL else number(entry)


@dataclass(frozen=True)
class Role:
    """Capabilities of every agent of one team. A fleet has any number of roles."""

    count: Annotated[int, Within(0, 255, "agents")]
    """Agents in the team."""
    moves: Annotated[int | Literal["from vessel"], _Moves()]
    """Nodes an agent moves per decision, in one direction; or "from vessel": the most that its
    vessel makes in time in any of the eight directions, after a turn of 90 degrees."""
    radius: Annotated[float, Within(0, 1000, "node")]
    """Sensing radius."""
    collects: bool
    """True if it removes the items of the node it is in."""
    capacity: Annotated[int, Within(0, 1_000_000, "items")] = 0
    """Items an agent can take aboard in one episode; 0 means unlimited."""
    energy: Annotated[float, Within(0, 1e12, "node")] = 0.0
    """Distance an agent can travel in one episode; 0 means unlimited."""
    carries: bool = False
    """True if it takes over the items that others have aboard."""
    draught_m: Annotated[float, Within(0, 20, "m")] = 0.0
    """Draught of its hull. Nodes of a place that are no deeper are closed to the whole fleet, by
    the largest of the teams; 0: it closes none."""
    relays: bool = False
    """True if it passes on the scans that it receives, also where `link.relay` is off."""
    antenna_m: Annotated[float, Within(0.01, 200, "m")] = 1.0
    """Height of its antenna above the water, for `link.model = "two-ray"`."""

    @property
    def nodes(self) -> int:
        """Nodes per decision; `UserError` where they follow from a vessel that nobody has asked."""
        if self.moves == FROM_VESSEL:
            raise UserError(f'moves = "{FROM_VESSEL}": no vessel is known here; give a number')
        return self.moves


def choosing_order(teams: Mapping[str, Role]) -> tuple[str, ...]:
    """Names of the teams in the order in which they choose, where a scenario gives none.

    Teams that collect come first, then the others, each by name: the order in which a file lists
    them plays no part.
    """
    return tuple(sorted(teams, key=lambda name: (not teams[name].collects, name)))


def agent_names(team: NDArray[np.int64], team_names: Sequence[str]) -> tuple[str, ...]:
    """Names of agents (agent,) of given teams: `scouts_0`, `scouts_1`, `foragers_0`, ..."""
    seen = dict.fromkeys(range(len(team_names)), -1)
    names = []
    for number in team.tolist():
        seen[number] += 1
        names.append(f"{team_names[number]}_{seen[number]}")
    return tuple(names)


@dataclass(frozen=True)
class Fleet:
    """The teams as one table of agents, in the order of the scenario's teams.

    Every array is (agent,), by what an agent can do; `order` lists the agents as they choose.
    """

    team_names: tuple[str, ...]
    team: NDArray[np.int64]
    moves: NDArray[np.int64]
    radius: NDArray[np.float64]
    collects: NDArray[np.bool_]
    capacity: NDArray[np.int64]
    energy: NDArray[np.float64]
    carries: NDArray[np.bool_]
    relays: NDArray[np.bool_]
    antenna_m: NDArray[np.float64]
    order: NDArray[np.int64]

    def __post_init__(self) -> None:
        for name, column in vars(self).items():
            object.__setattr__(self, name, read_only(column))

    @classmethod
    def of(cls, teams: Mapping[str, Role], order: Sequence[str] = ()) -> "Fleet":
        """Lay the teams out agent by agent.

        Parameters
        ----------
        order : names of all teams as they choose; empty: see `choosing_order`. Within a team the
            highest number chooses first
        """
        roles, names = list(teams.values()), list(teams)
        counts = [role.count for role in roles]
        team = np.repeat(np.arange(len(roles), dtype=np.int64), counts)
        choosing = [names.index(name) for name in order or choosing_order(teams)]
        in_order = [np.flatnonzero(team == number)[::-1] for number in choosing]
        return cls(
            team_names=tuple(teams),
            team=team,
            moves=np.repeat(np.asarray([r.nodes for r in roles], np.int64), counts),
            radius=np.repeat(np.asarray([r.radius for r in roles], np.float64), counts),
            collects=np.repeat(np.asarray([r.collects for r in roles], np.bool_), counts),
            capacity=np.repeat(
                np.asarray([r.capacity or UNLIMITED for r in roles], np.int64), counts
            ),
            energy=np.repeat(np.asarray([r.energy or np.inf for r in roles], np.float64), counts),
            carries=np.repeat(np.asarray([r.carries for r in roles], np.bool_), counts),
            relays=np.repeat(np.asarray([r.relays for r in roles], np.bool_), counts),
            antenna_m=np.repeat(np.asarray([r.antenna_m for r in roles], np.float64), counts),
            order=np.concatenate([np.empty(0, np.int64), *in_order]),
        )

    def __len__(self) -> int:
        return int(self.team.size)

    @property
    def names(self) -> tuple[str, ...]:
        """`scouts_0`, `scouts_1`, ...: team name and number within the team."""
        return agent_names(self.team, self.team_names)

    @property
    def discoverers(self) -> NDArray[np.int64]:
        """Indices of the agents that discover without collecting: the scouts of the metrics."""
        return np.flatnonzero(~self.collects)

    @property
    def collectors(self) -> NDArray[np.int64]:
        """Indices of the agents that collect: the foragers of the metrics."""
        return np.flatnonzero(self.collects)

    @property
    def credit_order(self) -> NDArray[np.int64]:
        """Agents as a shared first sighting is credited: first those that do not collect."""
        return np.concatenate((self.discoverers, self.collectors))
