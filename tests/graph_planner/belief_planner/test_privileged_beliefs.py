"""Privileged beliefs: the truth of items that received looks have shown, and of nothing else."""

import numpy as np
from numpy.typing import NDArray

from mjforage.graph_planner.belief_planner.privileged_beliefs import UNREPORTED, PrivilegedBeliefs
from mjforage.graph_planner.belief_planner.settings import BeliefSettings
from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.mission.task import GroundTruth, Observation
from mjforage.scenario.roles import Role
from tests.graph_planner.driver import observation_of, task_of

SEA = navigation_graph(np.ones((20, 30), np.bool_), 1.0, False)
TASK = task_of(SEA, scouts=Role(1, 2, 4.0, False), foragers=Role(1, 1, 1.0, True))
AT = [(10, 10), (10, 20)]
DRIFT = np.array([[0.02, -0.06]])
HIDDEN, SHOWN, TAKEN = (2.0, 25.0), (10.2, 12.9), (11.0, 9.0)


def truth_of(*places: tuple[float, float], gone: tuple[int, ...] = ()) -> GroundTruth:
    """Items at places, some of them taken."""
    item_rc = np.array([places])
    node = np.array([[SEA.node_of_cell[round(r), round(c)] for r, c in places]], np.int32)
    node[0, list(gone)] = -1
    return GroundTruth(item_rc, node, DRIFT, np.broadcast_to(DRIFT, item_rc.shape).copy())


def seen_at(step: int, shows: dict[tuple[int, int], int]) -> Observation:
    """Beliefs after a look of the scout at a step, at which only these nodes are in view."""
    last_seen = np.full(len(SEA), -1, np.int16)
    for cell in shows:
        last_seen[SEA.node_of_cell[cell]] = step
    known = {cell: items for cell, items in shows.items() if items}
    return observation_of(TASK, AT, known, last_seen, step=step + 1)


def beliefs() -> PrivilegedBeliefs:
    return PrivilegedBeliefs(TASK, BeliefSettings.of(TASK.prior), np.array([7], np.uint64))


def believed_items(believed: PrivilegedBeliefs) -> NDArray[np.float64]:
    """(item, 2) places at which items are believed."""
    n, tracks = int(believed.tracks.number[0]), believed.tracks
    return np.stack((tracks.row[0, :n], tracks.col[0, :n]), axis=1)


def test_an_item_once_shown_is_known_until_it_is_taken_and_others_are_not() -> None:
    believed, places = beliefs(), (HIDDEN, SHOWN, TAKEN)
    believed.set_ground_truth(truth_of(*places))
    believed.learn(seen_at(0, {(10, 12): 0, (2, 2): 0}), 0)
    assert believed_items(believed).size == 0 and (believed.wind.mean == 0.0).all(), (
        "nothing is known yet"
    )
    believed.set_ground_truth(truth_of(*places))
    believed.learn(seen_at(1, {(10, 13): 1, (11, 9): 1}), 0)
    np.testing.assert_array_equal(believed_items(believed), [SHOWN, TAKEN])
    np.testing.assert_array_equal(believed.wind.mean, DRIFT)
    assert believed.since[0].tolist() == [UNREPORTED, 1, 1]
    far = (15.0, 3.0)  # where it has drifted, out of sight
    believed.set_ground_truth(truth_of(HIDDEN, far, TAKEN, gone=(2,)))
    believed.learn(seen_at(2, {(0, 0): 0}), 0)
    np.testing.assert_array_equal(believed_items(believed), [far])
    assert believed.tracks.born[0, 0] == 1 and believed.tracks.seen[0, 0] == 2


def test_late_looks_tell_of_what_they_show_at_their_own_step() -> None:
    """The item has left the node since, and another has come into it."""
    believed = beliefs()
    believed.set_ground_truth(truth_of((10.0, 22.0), (3.0, 3.0)))
    believed.learn(seen_at(0, {(0, 0): 0}), 0)
    now, cell = truth_of((14.0, 26.0), (10.0, 22.0)), SEA.node_of_cell[10, 22]
    view = TASK.views.of(int(SEA.node_of_cell[10, 20]), int(TASK.radius_number[0]))
    shown = (view == cell).astype(np.int16)[None, None]
    assert shown.sum() == 1
    looks = np.array([[[0, 0, SEA.node_of_cell[10, 20]]]], np.int32)
    believed.set_ground_truth(now)
    seen = seen_at(1, {(0, 0): 0})._replace(delayed_scans=looks, delayed_shown=shown)
    believed.learn(seen, 0)
    np.testing.assert_array_equal(believed_items(believed), [(14.0, 26.0)])
    assert believed.since[0].tolist() == [0, UNREPORTED]
