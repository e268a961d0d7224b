"""Late looks: they are taken in at their own step, and change nothing that was seen since."""

import numpy as np
import pytest

from mjforage.base.randomness import episode_keys
from mjforage.graph_planner.belief_planner import late as lt
from mjforage.graph_planner.belief_planner import reconciling as rc
from mjforage.graph_planner.belief_planner import tracks as tr
from mjforage.graph_planner.belief_planner.beliefs import Beliefs
from mjforage.graph_planner.belief_planner.boundary import boundary_of
from mjforage.graph_planner.belief_planner.missed_detections import (
    missed_detections,
    remember,
    view_history,
)
from mjforage.graph_planner.belief_planner.settings import BeliefSettings
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.mission.task import NEVER
from mjforage.scenario.roles import Role
from tests.graph_planner.driver import no_doubts, observation_of, task_of

SEA = navigation_graph(np.ones((12, 30), np.bool_), 1.0, False)
BOUNDARY = boundary_of(SEA)
EAST = np.array([0.0, 0.5])  # drift [node/step]
NOBODY = np.full(1, -1, np.int32)


class Past:
    """One episode's tracks, at step 10 with a drift to the east."""

    now = 10

    def __init__(self) -> None:
        nothing_missed = missed_detections(1, len(SEA), 20, np.ones(1))
        self.tracks = tr.tracks(1, 20)
        self.history = view_history(1, len(SEA), 20, 1, nothing_missed)
        self.ways, self.lost, self.memory = (
            tr.ended(90),
            tr.losses(20),
            np.zeros(len(SEA), np.int16),
        )

    def track(self, row: float, col: float, seen: int) -> None:
        i = int(self.tracks.number[0])
        node = SEA.node_of_cell[round(row), round(col)]
        tr.begin(self.tracks, BOUNDARY, 0, node, seen, self.ways)
        self.tracks.row[0, i], self.tracks.col[0, i] = row, col

    def receive(
        self,
        step: int,
        counts: dict[tuple[int, int], int],
        in_view: list[tuple[int, int]],
        foragers_at: Int32Array = NOBODY,
    ) -> int:
        """A late look at some cells; how many new tracks stay."""
        belief, seen = np.zeros(len(SEA), np.int16), np.full(len(SEA), NEVER, np.int16)
        for cell in in_view:
            belief[SEA.node_of_cell[cell]] = counts.get(cell, 0)
            seen[SEA.node_of_cell[cell]] = step
        past, tracks, ways, lost = self.now - step, self.tracks, self.ways, self.lost
        remember(self.history, 0, step, seen, foragers_at)
        lt.work_back(tracks, BOUNDARY, 0, step, past, EAST)
        lt.collect(tracks, BOUNDARY, 0, step, foragers_at, EAST, ways, lost)
        view, nobody = rc.View(step, belief, seen), rc.Catch(NOBODY[:0], np.zeros(0, np.int64))
        doubts = no_doubts(len(SEA))
        about = SEA.neighbours, 0, view, 0.1, nobody, doubts, self.memory, ways, lost
        new = rc.reconcile(tracks, BOUNDARY, *about)
        about_now = 0, new, step, self.now, EAST, ways, lost
        new = lt.doubt(tracks, self.history, BOUNDARY, *about_now)
        lt.carry_on(tracks, BOUNDARY, 0, step, past, EAST)
        return new

    @property
    def places(self) -> list[tuple[float, float]]:
        n = self.tracks.number[0]
        places = zip(self.tracks.row[0, :n], self.tracks.col[0, :n], strict=True)
        return [(float(r), float(c)) for r, c in places]


def test_tracks_that_a_look_says_nothing_of_stay_to_the_bit() -> None:
    past = Past()
    for row, col, seen in ((3.21, 14.37, 2), (7.0, 0.3, 4), (5.4, 28.9, 8)):
        past.track(row, col, seen)
    before = past.places
    assert past.receive(5, {}, [(10, 3)]) == 0
    assert past.places == before


def test_a_track_is_confirmed_where_it_was_then() -> None:
    past = Past()
    past.track(3.0, 15.0, 1)  # at column 12.5 in step 5
    assert past.receive(5, {(3, 12): 1}, [(3, c) for c in range(10, 15)]) == 0
    assert past.tracks.seen[0, 0] == 5
    (row, col), *_ = past.places
    assert (row, col) == pytest.approx((3.0, 15.0), abs=0.1)


def test_a_first_sighting_is_carried_on_to_where_it_must_be_now() -> None:
    past = Past()
    assert past.receive(6, {(3, 12): 1}, [(3, 12)]) == 1
    ((row, col),) = past.places
    assert (row, col) == pytest.approx((3.0, 14.0))
    assert past.tracks.born[0, 0] == past.tracks.seen[0, 0] == 6


def test_what_was_seen_since_accounts_for_a_count_and_stays() -> None:
    past = Past()
    past.track(3.0, 15.0, 8)
    before = past.places
    assert past.receive(5, {(3, 12): 1}, [(3, c) for c in range(10, 15)]) == 0
    assert past.places == before and past.tracks.seen[0, 0] == 8
    assert past.receive(5, {}, [(3, c) for c in range(10, 15)]) == 0, "and it is not given up"
    assert past.places == before
    assert past.receive(8, {}, [(3, c) for c in range(10, 18)]) == 0, "nor by another of that step"
    assert past.places == before


def test_what_the_look_pushes_out_of_sight_drifts_on_from_there() -> None:
    past = Past()
    past.track(3.0, 15.0, 1)
    past.receive(5, {}, [(3, 12)])
    ((row, col),) = past.places
    assert (row, col) != (3.0, 15.0) and abs(row - 3.0) + abs(col - 15.0) < 1.1


def test_what_was_not_there_is_given_up_or_out_of_sight() -> None:
    past = Past()
    past.track(3.0, 15.0, 1)
    assert past.receive(5, {}, [(r, c) for r in range(8) for c in range(8, 18)]) == 0
    assert past.places == [] and past.lost.number[0] == 1


@pytest.mark.parametrize("taken", [True, False])
def test_what_would_have_been_seen_or_taken_since_is_no_new_item(taken: bool) -> None:
    """In step 7 it would have been at column 12.5, that of node 13 by a hair, and then at 13."""
    past = Past()
    seen = np.full(len(SEA), NEVER, np.int16)
    at = NOBODY
    if taken:
        at = np.array([SEA.node_of_cell[3, 13]], np.int32)
    else:
        seen[SEA.node_of_cell[3, 13]] = 7
    remember(past.history, 0, 7, seen, at)
    assert past.receive(5, {(3, 12): 1}, [(3, 12)]) == 0
    assert past.places == [] and past.lost.number[0] == 1


def test_what_a_forager_came_to_was_taken_unless_it_was_seen_since() -> None:
    at = np.array([SEA.node_of_cell[3, 12]], np.int32)
    for seen, left, lost in ((1, 0, 1), (4, 0, 0), (7, 1, 0)):
        past = Past()
        past.track(3.0, 15.0, seen)  # at column 12 when the forager came, in step 5
        past.receive(5, {}, [(10, 3)], at)
        assert len(past.places) == left
        assert past.lost.number[0] == lost, "lost if it had not been seen just before"


def test_looks_of_one_step_are_shown_together() -> None:
    views = SEA.views((1.0,))
    nodes = np.array([SEA.node_of_cell[5, 5], SEA.node_of_cell[5, 6]], np.int32)
    shown = np.zeros((2, 5), np.int16)
    both = list(views.of(int(nodes[0]))).index(SEA.node_of_cell[5, 6])
    shown[0, both] = 2
    glance = lt.glance(len(SEA))
    for step in (3, 4):
        lt.show(step, nodes, shown, np.zeros(2, np.int64), views, glance)
        assert int((glance.last_seen == step).sum()) == 8
        assert (glance.last_seen[glance.last_seen != step] == NEVER).all()
        assert glance.belief[SEA.node_of_cell[5, 6]] == 2, "the larger count of a node"


def test_a_late_look_rules_out_what_it_would_have_in_its_own_time() -> None:
    """Of 13 decisions the fourth shows nothing around a scout, at once or in the last one."""
    task = task_of(SEA, scouts=Role(1, 2, 3.0, False))
    beliefs = Beliefs(task, BeliefSettings(), episode_keys(0, np.zeros(2, np.int64)))
    node = int(SEA.node_of_cell[5, 6])
    view = task.views.of(node, 0)
    for step in range(1, 14):
        seen = observation_of(task, [(5, 6)], step=step, episodes=2)
        seen.agent_seen[:] = 0
        seen.last_seen[0, view] = 3 if step > 3 else NEVER
        if step == 13:
            shown = np.full((2, 1, view.size), -1, np.int16)
            shown[1] = 0
            scans = np.array([[[-1, 0, 0]], [[3, 0, node]]], np.int32)
            seen = seen._replace(delayed_scans=scans, delayed_shown=shown)
        for e in range(2):
            beliefs.learn(seen, e)
    at_once, late = beliefs.spots.unseen
    np.testing.assert_allclose(late, at_once)
    assert (late == 0.0).any()


def test_an_item_that_a_late_look_shows_first_was_sighted_when_it_was_made() -> None:
    task, node = task_of(SEA, scouts=Role(1, 2, 3.0, False)), int(SEA.node_of_cell[5, 6])
    beliefs = Beliefs(task, BeliefSettings(), episode_keys(0, np.zeros(1, np.int64)))
    view = task.views.of(node, 0)
    for step in (1, 13):
        seen = observation_of(task, [(5, 6)], step=step)
        if step == 13:
            shown = (view == node).astype(np.int16)[None, None]
            scans = np.array([[[3, 0, node]]], np.int32)
            seen = seen._replace(delayed_scans=scans, delayed_shown=shown)
        beliefs.learn(seen, 0)
    spots = beliefs.spots
    assert (spots.number[0], spots.node[0, 0], spots.step[0, 0]) == (1, node, 3)
