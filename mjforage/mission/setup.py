"""A scenario with its map: the graph, the fleet and the starts that every mission on it shares."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.randomness import UInt64Array
from mjforage.base.views import read_only
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.navigation import NavigationGraph, navigation_graph
from mjforage.mission.initial_state import InitialState, create_initial_state, nodes_around
from mjforage.mission.link.reach import reach_m
from mjforage.mission.moves import MoveRules, reachable_share
from mjforage.mission.resolver import Corruption
from mjforage.mission.task import Task
from mjforage.scenario.draughts import afloat, check_afloat
from mjforage.scenario.maps import (
    GridMap,
    check_starts,
    grid_of,
    load_map,
    load_starts,
    pitch_of,
    starts_of,
)
from mjforage.scenario.place import Place, north_deg
from mjforage.scenario.roles import FROM_VESSEL, Fleet
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.sizes import check_memory, map_bytes, mission_bytes


@dataclass(frozen=True, eq=False)
class Setup:
    """A scenario with its map read and its graph built."""

    scenario: Scenario
    grid: GridMap
    following: tuple[str, ...] = ()
    """Teams whose moves follow from their vessels."""

    @classmethod
    def of(
        cls,
        scenario: Scenario,
        cells: NDArray[np.bool_] | None = None,
        name: str = "array",
        place: Place | None = None,
        depth_m: NDArray[np.float64] | None = None,
        derive: Callable[[Scenario], Scenario] = lambda scenario: scenario,
    ) -> Self:
        """Load the map and check that the scenario fits on it.

        Parameters
        ----------
        cells : (row, column) water, in the place of the scenario's map
        name, place, depth_m : of those cells
        derive : works out the moves of teams that leave them to their vessels

        Raises
        ------
        UserError
            If the map cannot be used or a start is not on water.
        """
        choice = scenario.map
        how = {
            "corner_cutting": choice.corner_cutting,
            "largest_component": choice.largest_component,
        }
        if cells is None:
            grid = load_map(choice.file, water=choice.water, **how)
        else:
            grid = replace(grid_of(cells.copy(), name, **how), place=place)
            if depth_m is not None:
                grid = replace(grid, depth_m=np.where(grid.navigable, depth_m, np.nan))
        following = [name for name, role in scenario.team.items() if role.moves == FROM_VESSEL]
        scenario = derive(_on(grid, scenario))
        setup = cls(scenario, afloat(grid, scenario), tuple(following))
        setup.check_memory(1)
        own = setup.scenario.map.starts is not None
        owner = f"scenario {scenario.name}" if own else "the .starts.csv beside the map"
        check_afloat(setup.start_cells, setup.grid, scenario)
        check_starts(setup.start_cells, grid.navigable, owner, choice.file)
        nodes_around(setup.graph, setup.start_nodes, len(setup.fleet))
        return setup

    def check_memory(self, episodes: int, recorded: bool = False) -> None:
        """Check that this machine has the memory for so many episodes side by side.

        Parameters
        ----------
        recorded : True if one of them is recorded for films

        Raises
        ------
        UserError
            If it has not.
        """
        rows, columns = self.grid.navigable.shape
        about = self.scenario, (rows, columns), self.grid.nodes
        wanted = map_bytes(*about) + mission_bytes(*about, episodes, recorded)
        check_memory(
            f"scenario {self.scenario.name} on map {self.grid.name} ({rows} x {columns}), "
            f"{episodes} episodes at a time,",
            wanted,
            "take a smaller map, radius, horizon or team",
        )

    @property
    def asked(self) -> Scenario:
        """The scenario as it was asked for, with moves that follow from vessels; to be changed."""
        team = dict(self.scenario.team)
        team |= {name: replace(team[name], moves=FROM_VESSEL) for name in self.following}
        return replace(self.scenario, team=team) if self.following else self.scenario

    @property
    def start_cells(self) -> tuple[tuple[int, int], ...]:
        """(row, column) of the starts: the scenario's, else those beside the map, else none."""
        if self.scenario.map.starts is None:
            return load_starts(self.scenario.map.file) or ()
        return self.scenario.map.starts

    @property
    def reachable_shares(self) -> dict[str, float]:
        """Share of the nodes that each role can end a move on, from the first start (or node 0)."""
        first = int(self.start_nodes[0]) if self.start_nodes.size else 0
        return {
            name: reachable_share(self.graph, first, role.nodes, self.task.rules)
            for name, role in self.scenario.team.items()
        }

    @cached_property
    def graph(self) -> NavigationGraph:
        """The map as a graph."""
        choice = self.scenario.map
        return navigation_graph(self.grid.navigable, choice.pitch_m, choice.corner_cutting)

    @cached_property
    def fleet(self) -> Fleet:
        """The agents."""
        return Fleet.of(self.scenario.team, self.scenario.rules.order)

    @cached_property
    def task(self) -> Task:
        """Task of the policies."""
        scenario, rules = self.scenario, self.scenario.rules
        moves = MoveRules(rules.stay, rules.shorten, rules.jump)
        about = scenario.horizon, scenario.prior, rules.walls
        link = scenario.link
        reach = reach_m(link, self.fleet.antenna_m) / scenario.map.pitch_m
        if link.latency >= scenario.horizon:
            reach = 0.0
        return Task(
            *(self.graph, self.fleet, moves, *about),
            reach_node=reach,
            latency=link.latency,
            across_land=rules.sight == "disc",
        )

    @cached_property
    def start_nodes(self) -> Int32Array:
        """(start,) nodes to assign; empty for a random cluster."""
        nodes = [self.graph.node_of_cell[rc] for rc in self.start_cells]
        return read_only(np.array(nodes, np.int32))

    @cached_property
    def corruption(self) -> Corruption:
        """Agents whose actions are partly random."""
        choice = self.scenario.corruption
        names = np.array(self.fleet.team_names)[self.fleet.team]
        epsilon = np.where(names == choice.team, choice.epsilon, 0.0)
        return Corruption(read_only(epsilon), choice.whole_team)

    def create_initial_state(self, keys: UInt64Array) -> InitialState:
        """Initial state of the episodes with the given keys (episode,)."""
        scenario = self.scenario
        return create_initial_state(
            self.graph,
            scenario.items,
            scenario.weather,
            scenario.map.pitch_m / scenario.period_s,
            self.start_nodes,
            len(self.fleet),
            keys,
            scenario.rules.walls,
            north_deg(self.grid.place),
        )


def _on(grid: GridMap, scenario: Scenario) -> Scenario:
    """The scenario with the pitch of its map, and starts as nodes."""
    choice = replace(scenario.map, pitch_m=pitch_of(grid, scenario.map.pitch_m))
    if choice.starts_latlon:
        if choice.starts is not None:
            raise UserError(
                f"scenario {scenario.name}: has map.starts and map.starts_latlon; give one of them"
            )
        starts = starts_of(grid, choice.starts_latlon)
        choice = replace(choice, starts=starts, starts_latlon=())
    return replace(scenario, map=choice)
