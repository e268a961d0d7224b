import numpy as np

from mjforage.base.randomness import episode_keys
from mjforage.mission.item_classes import draw_classes
from mjforage.physics.dynamics.item_bodies import read_items
from tests.mjforage.physics.dynamics.test_collecting import GRAPH, ON, state_of


def test_positions_of_bodies_become_nodes_and_land_the_nearest_one() -> None:
    """South-west cell at the origin, land east of it. Collected items are left alone."""
    state = state_of([0, 0, 0, -1])
    xy = np.array([[[1.9, 0.0], [2.1, -0.3], [4.4, 3.0], [8.0, 4.0]]])
    read_items(ON, xy, GRAPH.water, 4.0, state)
    south_west, north = GRAPH.node_of_cell[1, 0], GRAPH.node_of_cell[0, 1]
    assert state.item_node.tolist() == [[south_west, south_west, north, -1]]
    assert state.item_rc[0, 0].tolist() == [1.0, 0.475]


def test_classes_are_drawn_evenly_and_do_not_depend_on_the_batch() -> None:
    nodes = np.zeros((200, 50), np.int32)
    nodes[:, 40:] = -1
    keys, choices = episode_keys(1, np.arange(200)), np.array([4, 1])
    drawn = draw_classes(keys, nodes, choices)
    assert (drawn[:, 40:] == -1).all()
    assert abs((drawn[:, :40] == 4).mean() - 0.5) < 4 * 0.5 / np.sqrt(8000)
    assert (draw_classes(keys[7:8], nodes[7:8, :3], choices) == drawn[7:8, :3]).all()
