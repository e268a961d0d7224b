"""Target values against the same in numpy."""

import numpy as np
import pytest

from mjforage.base.randomness import episode_keys
from mjforage.graph_planner.belief_planner.beliefs import Beliefs
from mjforage.graph_planner.belief_planner.boundary import boundary_of
from mjforage.graph_planner.belief_planner.settings import BeliefSettings
from mjforage.graph_planner.belief_planner.stops import floating
from mjforage.graph_planner.belief_planner.target_values import (
    FAILED,
    LEAST,
    TargetValues,
    likeliest,
)
from mjforage.graph_planner.belief_planner.tracks import Tracks
from mjforage.graph_planner.graph.navigation import navigation_graph
from tests.graph_planner.driver import observation_of, task_of

SEA = navigation_graph(np.ones((12, 12), np.bool_), 1.0, False)
TASK = task_of(SEA)
NOW = 20


def believing(settings: BeliefSettings) -> tuple[Beliefs, TargetValues]:
    """Two rows; in the second two tracks in (3, 3), one in (4, 4), and unseen items in places."""
    beliefs = Beliefs(TASK, settings, episode_keys(0, np.arange(2)))
    tracks: Tracks = beliefs.tracks
    tracks.number[1] = 3
    for i, (cell, seen) in enumerate((((3, 3), 18), ((3, 3), 5), ((4, 4), -40))):
        tracks.row[1, i], tracks.col[1, i] = cell
        tracks.node[1, i], tracks.seen[1, i] = SEA.node_of_cell[cell], seen
        tracks.real[1, i] = 0.5 + 0.1 * i
    beliefs.spots.number[1] = 4
    beliefs.expected[1] = np.random.default_rng(0).choice([0.0, 0.01, 0.3, 0.7], len(SEA))
    beliefs.later[1, SEA.node_of_cell[4, 4]] = NOW + 1
    return beliefs, TargetValues(beliefs, settings, boundary_of(SEA))


@pytest.mark.parametrize("room", [1, 7, 40, 200])
def test_the_likeliest_nodes_come_first_and_of_equal_ones_the_lower_number(room: int) -> None:
    for seed in range(20):
        rng = np.random.default_rng(seed)
        expected = rng.choice([0.0, LEAST, 0.5, 2.0, rng.uniform()], 144)
        best = np.empty(room, np.int64)
        found = best[: likeliest(expected, best)]
        order = np.argsort(-expected, kind="stable")[:room]
        np.testing.assert_array_equal(found, order[expected[order] > LEAST])


@pytest.mark.parametrize("hotspot", [True, False])
def test_items_are_tracks_and_where_unseen_ones_are_likeliest(hotspot: bool) -> None:
    beliefs, wanted = believing(BeliefSettings(hotspot=hotspot))
    items = floating(200)
    wanted.list_items(1, NOW, items)
    n = int(items.number[0])
    assert n == (43 if hotspot else 3)
    assert items.row[:3].tolist() == [3.0, 3.0, 4.0]
    assert items.weight[:3] == pytest.approx([0.5, 0.6, 0.7 * FAILED])
    best = np.argsort(-beliefs.expected[1], kind="stable")[: n - 3]
    np.testing.assert_array_equal(items.row[3:n], SEA.rows[best])
    np.testing.assert_array_equal(items.col[3:n], SEA.cols[best])
    np.testing.assert_array_equal(items.weight[3:n], beliefs.expected[1, best])
    wanted.list_items(0, NOW, items)
    assert items.number[0] == 0  # nothing was seen in that row


@pytest.mark.parametrize("refresh", [True, False])
def test_known_items_and_ghosts_are_worth_seeing_again(refresh: bool) -> None:
    """.02 items for every step up to 30: 2 and 15, more than 30; a ghost 8 steps unseen."""
    beliefs, wanted = believing(BeliefSettings(refresh=refresh))
    known = {(3, 3): 2, (7, 7): 1}
    last_seen = np.full(len(SEA), NOW - 8, np.int16)
    seen = observation_of(TASK, [], known, last_seen, NOW + 1, episodes=2)
    extra = np.zeros(len(SEA))
    for cell, steps in (((3, 3), 17), ((4, 4), 30), ((7, 7), 8)):
        extra[SEA.node_of_cell[cell]] = 0.02 * steps * refresh
    np.testing.assert_allclose(wanted.worth_seeing(seen, 1), beliefs.expected[1] + extra)
