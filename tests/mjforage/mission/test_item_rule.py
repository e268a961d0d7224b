"""Items exactly on the border of their node's square, worked out by hand."""

import numpy as np
import pytest

from mjforage.base.randomness import episode_keys
from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.graph_planner.graph.walls import WALLS
from mjforage.mission.dynamics import start_state
from mjforage.mission.initial_state import InitialState
from mjforage.mission.item_rule import ItemRule
from mjforage.scenario.roles import Fleet, Role
from tests.graph_planner.charts import grid

SCOUT = Fleet.of({"scouts": Role(count=1, moves=1, radius=1.0, collects=False)})


def drifted(rows: tuple[str, ...], drift: float, walls: str) -> list[tuple[float, tuple[int, int]]]:
    """Row and cell of an item that starts in the middle of (1, 0), after each of three steps."""
    graph = navigation_graph(grid(*rows), 1.0, False)
    node = graph.node_of_cell[1, 0]
    initial = InitialState(
        n_items=np.ones(1, np.int32),
        item_rc=np.array([[[1.0, 0.0]]]),
        item_node=np.array([[node]], np.int32),
        drift_rc=np.array([[drift, 0.0]]),
        agent_node=np.array([[node]], np.int32),
    )
    state = start_state(initial, np.stack((graph.rows, graph.cols), axis=1).astype(np.float64))
    rule = ItemRule(graph, SCOUT, 0.0, walls)
    rule.reset(initial, episode_keys(0, np.arange(1)), state)
    found = []
    for step in range(1, 4):
        rule.advance(np.ones(1, np.bool_), np.full(1, step, np.int32))
        at = int(state.item_node[0, 0])
        found.append((float(state.item_rc[0, 0, 0]), (int(graph.rows[at]), int(graph.cols[at]))))
    return found


@pytest.mark.parametrize("walls", WALLS)
def test_the_upper_border_belongs_to_a_square_and_the_lower_one_to_the_next(walls: str) -> None:
    water = (".", ".", ".")
    north = [(0.75, (1, 0)), (0.5, (1, 0)), (0.25, (0, 0))]
    south = [(1.25, (1, 0)), (1.5, (2, 0)), (1.75, (2, 0))]
    assert drifted(water, -0.25, walls) == north
    assert drifted(water, 0.25, walls) == south


@pytest.mark.parametrize("walls", WALLS)
def test_an_item_on_the_border_of_land_is_put_back_once_it_is_beyond(walls: str) -> None:
    quays = ("#", ".", "#")
    north, south = drifted(quays, -0.25, walls), drifted(quays, 0.25, walls)
    assert north == [(0.75, (1, 0)), (0.5, (1, 0)), (pytest.approx(0.51), (1, 0))]
    assert south == [(1.25, (1, 0)), (pytest.approx(1.49), (1, 0)), (pytest.approx(1.49), (1, 0))]
