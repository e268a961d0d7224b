"""The view of a policy that is a plain function: one episode before one decision."""

from collections.abc import Mapping
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.api import checks
from mjforage.base.errors import UserError
from mjforage.base.randomness import Stream, uniforms
from mjforage.base.references import nearest
from mjforage.base.views import read_only
from mjforage.graph_planner.graph.navigation import COMPASS, STAY
from mjforage.mission.task import NEVER, Observation, Task

Where = int | tuple[int, int]
"""A node by its number, or by the (row, column) of its cell."""


class View:
    """One episode as its agents know it, before one decision; read-only.

    Agents have names such as ``scouts_0``. A place is a node: its number, or the (row, column) of
    its cell. Row 0 is the north edge, column 0 the west edge. With a radio
    link each agent is asked for by what it knows itself.

    Examples
    --------
    >>> import mjforage as mf
    >>> def nearest(view):
    ...     return {agent: view.toward_nearest_item(agent) for agent in view.collectors}
    >>> mf.evaluate("open-bay", [nearest], episodes=1, horizon=20).policies
    ('nearest',)
    """

    def __init__(
        self, task: Task, observation: Observation, row: int, legal: NDArray[np.bool_]
    ) -> None:
        """View of a row of a batch, with its legal moves (agent, 9)."""
        self._task, self._seen, self._row, self._legal = task, observation, row, legal

    @cached_property
    def agents(self) -> tuple[str, ...]:
        """Names of all agents."""
        return self._task.fleet.names

    @property
    def collectors(self) -> tuple[str, ...]:
        """Names of the agents that collect items."""
        return self._named(self._task.fleet.collectors)

    @property
    def scouts(self) -> tuple[str, ...]:
        """Names of the agents that only discover items."""
        return self._named(self._task.fleet.discoverers)

    @property
    def step(self) -> int:
        """Number of the decision that is asked for, 1 for the first."""
        return int(self._seen.step[self._row])

    @property
    def horizon(self) -> int:
        """Decisions in an episode, unless all items are collected earlier."""
        return self._task.horizon

    @property
    def water(self) -> NDArray[np.bool_]:
        """(row, column) True where there is water."""
        return self._task.graph.navigable

    @property
    def pitch_m(self) -> float:
        """Distance between the centres of neighbouring nodes [m]."""
        return self._task.graph.pitch_m

    @cached_property
    def items(self) -> Mapping[int, int]:
        """Believed number of items by node, of the nodes where it is not 0."""
        nodes = np.flatnonzero(self._seen.belief[self._row] > 0)
        counts = self._seen.belief[self._row, nodes]
        return MappingProxyType(dict(zip(nodes.tolist(), counts.tolist(), strict=True)))

    @cached_property
    def belief(self) -> NDArray[np.int16]:
        """(row, column) believed number of items; 0 on land."""
        return self._grid(self._seen.belief[self._row].astype(np.int16))

    @cached_property
    def age(self) -> NDArray[np.float64]:
        """(row, column) decisions since the node was last seen; inf if never, 0 on land."""
        seen = self._seen.last_seen[self._row]
        since = np.where(seen == NEVER, np.inf, self.step - 1.0 - seen)
        return self._grid(since)

    def node(self, agent: str) -> int:
        """Node where an agent is, at its last measurement received."""
        return int(self._seen.agent_node[self._row, self._index(agent)])

    def cell(self, where: str | Where) -> tuple[int, int]:
        """(row, column) of an agent or a node."""
        node = self.node(where) if isinstance(where, str) else self._node(where)
        return int(self._task.graph.rows[node]), int(self._task.graph.cols[node])

    def xy_m(self, where: str | Where) -> tuple[float, float]:
        """Position of an agent's or a node's centre, x east and y north [m]."""
        x, y = self._task.graph.metres(np.asarray(self.cell(where), np.float64))
        return float(x), float(y)

    def known_at(self, agent: str) -> int:
        """Decision after which an agent's place was measured; `step` - 1 is now."""
        return int(self._seen.agent_seen[self._row, self._index(agent)])

    def energy_left(self, agent: str) -> float:
        """Distance that an agent can still travel [node]; inf without a limit."""
        return float(self._seen.energy_left[self._row, self._index(agent)])

    def room_left(self, agent: str) -> int:
        """Items that an agent can still take aboard."""
        return int(self._seen.room_left[self._row, self._index(agent)])

    def legal_moves(self, agent: str) -> tuple[str, ...]:
        """Moves that are legal while nobody is in the way: compass names, and "stay"."""
        legal = self._legal[self._index(agent)]
        return tuple(name for name, one in zip(COMPASS, legal, strict=True) if one)

    def end_of(self, agent: str, move: str | int) -> int:
        """Node where a legal move of an agent ends.

        Raises
        ------
        UserError
            If the move is not legal.
        """
        number = checks.move_number(move, "end_of", agent)
        if COMPASS[number] not in self.legal_moves(agent):
            raise UserError(
                f"move {move!r} of {agent}: is not legal here; choose "
                f"{', '.join(self.legal_moves(agent))}"
            )
        return self._end(self._index(agent), number)

    def distances(self, where: str | Where) -> NDArray[np.float64]:
        """(node,) distance by water from an agent or a node to every node [node]."""
        node = self.node(where) if isinstance(where, str) else self._node(where)
        table = self._task.graph.distances
        if table.size:
            return np.asarray(table[node], np.float64)
        return self._task.graph.distances_from(np.array([node], np.int32))

    def distance(self, start: str | Where, end: str | Where) -> float:
        """Distance by water between two agents or nodes [node]."""
        node = self.node(end) if isinstance(end, str) else self._node(end)
        return float(self.distances(start)[node])

    def toward(self, agent: str, where: str | Where) -> str:
        """Legal move of an agent that ends nearest to an agent or a node, by water.

        Of equal ones the first, from north clockwise; "stay" comes last.
        """
        index, distance = self._index(agent), self.distances(where)
        moves = [COMPASS.index(name) for name in self.legal_moves(agent)]
        return COMPASS[min(moves, key=lambda move: distance[self._end(index, move)])]

    def toward_nearest_item(self, agent: str) -> str | None:
        """Legal move of an agent towards the nearest known item; None if none is known."""
        if not self.items:
            return None
        distance = self.distances(agent)
        return self.toward(agent, min(self.items, key=lambda node: distance[node]))

    @cached_property
    def rng(self) -> np.random.Generator:
        """Generator of this episode, decision and belief owner.

        It gives the same numbers whatever the batch, the worker or the order of policies.
        """
        owner = int(self._seen.owner[self._row])
        keys = self._seen.keys[self._row : self._row + 1]
        words = uniforms(keys[:, None], 4 * (owner + 1) + np.arange(4), self.step, Stream.POLICY)
        seed = (words.ravel() * 2.0**32).astype(np.uint64).tolist()
        return np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed)))

    def _end(self, index: int, move: int) -> int:
        at = int(self._seen.agent_node[self._row, index])
        arrays = self._task.arrays
        end = int(arrays.targets[arrays.stride_number[index], at, move])
        return end if end >= 0 or move != STAY else at

    def _named(self, indices: NDArray[np.int64]) -> tuple[str, ...]:
        return tuple(self.agents[index] for index in indices.tolist())

    def _index(self, agent: str) -> int:
        if agent not in self.agents:
            raise UserError(f"agent {agent!r}: unknown; {nearest(str(agent), self.agents)}")
        return self.agents.index(agent)

    def _node(self, where: Where) -> int:
        graph = self._task.graph
        if isinstance(where, tuple) and len(where) == 2:
            rows, columns = graph.shape
            row, column = (checks.whole("row and column", part) for part in where)
            inside = 0 <= row < rows and 0 <= column < columns
            node = int(graph.node_of_cell[row, column]) if inside else -1
        else:
            number = checks.whole("node", where)
            node = number if 0 <= number < len(graph) else -1
        if node < 0:
            raise UserError(
                f"node {where}: is no water of this map; give 0 to {len(graph) - 1}, or the "
                "(row, column) of a cell of water"
            )
        return node

    def _grid(self, values: NDArray[Any]) -> NDArray[Any]:
        return read_only(self._task.graph.grid(values))
