"""The planner as a whole, through the policy's own door."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.graph_planner.belief_planner.move_preferences import approach, regrets
from mjforage.graph_planner.belief_planner.settings import BeliefOptions, BeliefSettings
from mjforage.graph_planner.belief_planner.ways import ways_of
from mjforage.graph_planner.graph.navigation import TABLE_LIMIT, NavigationGraph, navigation_graph
from mjforage.graph_planner.policies import create_policy, is_upper_bound
from mjforage.graph_planner.policies.belief import BeliefPolicy
from mjforage.mission.moves import MoveRules
from mjforage.mission.task import NEVER, GroundTruth
from mjforage.scenario.prior import Prior
from mjforage.scenario.roles import Role
from tests.graph_planner.driver import observation_of, preferences, task_of

N, NE, E, SE, S, SW, W, NW, STAY = range(9)
SEA = navigation_graph(np.ones((30, 30), np.bool_), 1.0, False)
FAST = "belief(fast=true)"
PRIOR = Prior()


def test_the_oracle_is_a_bound_and_the_belief_planner_is_not() -> None:
    assert (
        is_upper_bound("oracle") and not is_upper_bound("belief") and not is_upper_bound("nothing")
    )


def test_the_oracle_goes_where_the_item_is_and_not_where_it_is_believed() -> None:
    task = task_of(SEA, foragers=Role(1, 1, 1.0, True))
    observation = observation_of(task, [(10, 10)], {(10, 20): 1})
    assert int(preferences("oracle", task, observation)[0, 0].argmax()) in (NE, E, SE)
    observation.belief[:] = 0
    observation.belief[0, SEA.node_of_cell[20, 10]] = 1
    assert int(preferences("oracle", task, observation)[0, 0].argmax()) in (NE, E, SE)


def test_the_oracle_knows_the_drift_of_each_item_that_is_left() -> None:
    """The first item drifted east and is gone; the other lies still, to the west."""
    task = task_of(
        navigation_graph(np.ones((1, 30), np.bool_), 1.0, False), boat=Role(1, 1, 1.0, True)
    )
    observation, policy = observation_of(task, [(0, 10)]), create_policy("oracle")
    policy.reset(task, observation.keys)
    places, drift = np.array([[[0.0, 3.0], [0.0, 6.0]]]), np.array([[[0.0, 4.0], [0.0, 0.0]]])
    node = np.array([[-1, 6]], np.int32)
    policy.set_ground_truth(GroundTruth(places, node, np.zeros((1, 2)), drift))  # type: ignore[attr-defined]
    assert int(policy.act(observation)[0, 0].argmax()) == W


def test_the_oracle_sees_every_item_of_many() -> None:
    """5,400 items out of reach come first in the list, the one beside the forager last."""
    cells = np.ones((90, 90), np.bool_)
    cells[:, 60] = False
    task = task_of(navigation_graph(cells, 1.0, False), foragers=Role(1, 1, 1.0, True))
    known = {(r, c): 1 for r in range(90) for c in range(60)} | {(45, 63): 1}
    observation = observation_of(task, [(45, 62)], known)
    assert int(preferences("oracle", task, observation)[0, 0].argmax()) == E


@pytest.mark.parametrize("name", [FAST, "belief", "belief(robust=true)"])
def test_a_forager_takes_the_item_beside_it(name: str) -> None:
    task = task_of(SEA, foragers=Role(1, 1, 1.0, True))
    seen = np.full(len(SEA), 0, np.int16)
    observation = observation_of(task, [(10, 10)], {(10, 11): 1}, seen)
    assert int(preferences(name, task, observation)[0, 0].argmax()) == E


def test_a_late_or_blocked_move_does_not_confuse_it() -> None:
    """The agents never move whatever is asked; items go by; it keeps asking for the right thing."""
    task = task_of(SEA, scouts=Role(1, 2, 4.0, False), foragers=Role(1, 1, 1.0, True))
    policy, cells = BeliefPolicy(), [(10, 8), (10, 10)]
    for step in range(1, 40):
        item = (10, 12 + step // 10)
        seen = np.full(len(SEA), step - 1, np.int16)
        observation = observation_of(task, cells, {item: 6}, seen, step)
        if step == 1:
            policy.reset(task, observation.keys)
        forager = policy.act(observation)[0, 1]
        assert int(forager.argmax()) in (NE, E, SE), step
    tracks = policy.planner.beliefs.tracks
    assert tracks.number[0] == 6 and (tracks.born[0, :6] == 0).all()
    assert policy.planner.beliefs.wind.mean[0] == pytest.approx([0.0, 0.1], abs=0.03)


class Watch:
    """The planner given views: everything within `reach` of the middle, and items there."""

    def __init__(
        self, scout_at: tuple[int, int] = (0, 0), prior: Prior = PRIOR, **parts: bool
    ) -> None:
        self.scout_at = scout_at
        self.task = task_of(SEA, scouts=Role(1, 1, 4.0, False), foragers=Role(1, 1, 1.0, True))
        self.task = replace(self.task, prior=prior)
        self.policy = BeliefPolicy(fast=True, **parts)
        self.last_seen = np.full(len(SEA), -1, np.int16)

    def look(self, step: int, reach: int, *items: tuple[int, int]) -> NDArray[np.float64]:
        """Decide at a step, with the nodes within reach of (15, 15) in view."""
        near = np.maximum(np.abs(SEA.rows - 15), np.abs(SEA.cols - 15)) <= reach
        self.last_seen[near] = step - 1
        known = {item: items.count(item) for item in items}
        observation = observation_of(
            self.task, [self.scout_at, (29, 29)], known, self.last_seen.copy(), step
        )
        if step == 1:
            self.policy.reset(self.task, observation.keys)
        return self.policy.act(observation)

    @property
    def sightings(self) -> int:
        return int(self.policy.planner.beliefs.spots.number[0])


@pytest.mark.parametrize("ghost", [False, True])
def test_a_scout_goes_back_to_what_was_known_long_ago(ghost: bool) -> None:
    """All has been seen; an item in the west not since step 1, one in the east always.

    As a ghost the western one is believed, but no track of the planner's: it lies where the
    forager has just been.
    """
    task = task_of(SEA, scouts=Role(1, 1, 4.0, False), foragers=Role(1, 1, 1.0, True))
    policy, known = BeliefPolicy(fast=True), {(15, 5): 1, (15, 25): 1}
    last_seen = np.zeros(len(SEA), np.int16)
    for step in range(1, 30):
        last_seen[SEA.cols > 10] = step - 1
        forager = (15, 5) if ghost and step == 2 else (29, 29)
        observation = observation_of(task, [(15, 15), forager], known, last_seen.copy(), step)
        if step == 1:
            policy.reset(task, observation.keys)
        scout = policy.act(observation)[0, 0]
    assert (policy.planner.beliefs.tracks.number[0] == 1) == ghost
    assert int(scout.argmax()) in (SW, W, NW)


@pytest.mark.parametrize("name", [FAST, "dec-mcts(rounds=1, simulations=4)"])
def test_roles_of_several_speeds_and_ranges_work_together(
    ragged_coast: NavigationGraph, name: str
) -> None:
    task = task_of(
        ragged_coast,
        drone=Role(1, 3, 5.0, False),
        scout=Role(1, 2, 3.0, False),
        tug=Role(1, 2, 1.0, True, capacity=3),
        boat=Role(1, 1, 0.0, True, energy=50.0),
    )
    nodes = (3, 90, 140, 200)
    cells = [(int(ragged_coast.rows[v]), int(ragged_coast.cols[v])) for v in nodes]
    observation = observation_of(task, cells, {cells[0]: 1}, np.zeros(len(ragged_coast), np.int16))
    assert np.isfinite(preferences(name, task, observation).max(axis=2)).all()


def test_a_map_beyond_the_distance_table_works() -> None:
    side = int(TABLE_LIMIT**0.5) + 2
    large = navigation_graph(np.ones((side, side), np.bool_), 1.0, False)
    assert len(large) > TABLE_LIMIT and large.distances.size == 0
    task = task_of(large, s=Role(1, 2, 4.0, False), f=Role(1, 1, 1.0, True))
    seen = np.full(len(large), -32768, np.int16)
    observation = observation_of(task, [(40, 30), (40, 40)], {(40, 50): 1}, seen)
    observation.last_seen[0, large.node_of_cell[40, 50]] = 0
    moves = preferences(FAST, task, observation)
    assert int(moves[0, 1].argmax()) in (NE, E, SE)


def test_without_hotspots_foragers_go_only_to_what_was_seen() -> None:
    """An item was seen and is gone; items are expected wherever nobody has looked for long."""
    moves = {}
    for hotspot in (True, False):
        watch = Watch(hotspot=hotspot, preposition=False)
        watch.last_seen[:] = NEVER
        watch.look(1, 1, (15, 15))
        moves[hotspot] = watch.look(2, 1)[0, 1].argmax()
        assert (watch.policy.forecast().sum() > 0.5) and watch.sightings == 1
    assert moves[True] in (N, NW, W) and moves[False] == STAY


def test_without_hotspots_scouts_look_where_nobody_has_looked_for_long() -> None:
    task = task_of(SEA, scouts=Role(1, 1, 4.0, False), foragers=Role(1, 1, 1.0, True))
    last_seen = np.where(SEA.cols > 17, 0, 39).astype(np.int16)
    observation = observation_of(task, [(15, 15), (0, 0)], {}, last_seen, step=40)
    for planner in (FAST, "belief(fast=true, hotspot=false)"):
        assert int(preferences(planner, task, observation)[0, 0].argmax()) in (NE, E, SE)


def run_warnings(seen: list[tuple[tuple[int, int], ...]], detection: float = 1.0) -> float:
    """Chance of an item in (15, 15) after decisions by what is seen around it, known items only."""
    watch = Watch((15, 13), Prior(detection=detection))
    for step, items in enumerate(seen, 1):
        watch.look(step, 1, *items)
    node = SEA.node_of_cell[15, 15]
    unseen = watch.policy.planner.beliefs.expected[0, node]
    return float(1.0 - np.exp(unseen - watch.policy.forecast()[0, node]))


def test_a_known_item_is_foretold_by_its_chance() -> None:
    """In view it is there with .95; missed once by sensors that see half of all, with .8182."""
    here = (15, 15)
    assert run_warnings([(here,)]) == pytest.approx(0.95)
    assert run_warnings([(here, here)]) == pytest.approx(1.0 - 0.05**2)
    assert run_warnings([(here,), ()], detection=0.5) == pytest.approx(0.8182, abs=1e-4)
    assert run_warnings([((15, 16),)]) == 0.0


def test_items_in_the_node_of_a_full_forager_are_still_there() -> None:
    task = task_of(SEA, foragers=Role(2, 1, 1.0, True, 3))
    policy = BeliefPolicy(fast=True)
    for step in (1, 2, 3):
        seen = np.full(len(SEA), step - 1, np.int16)
        observation = observation_of(task, [(10, 11), (10, 20)], {(10, 11): 2}, seen, step)
        observation.room_left[0, 0] = 0
        if step == 1:
            policy.reset(task, observation.keys)
        policy.act(observation)
    tracks = policy.planner.beliefs.tracks
    assert tracks.number[0] == 2 and (tracks.born[0, :2] <= 1).all()


def test_robust_assumptions_are_wide() -> None:
    wide = BeliefSettings.of(Prior(), BeliefOptions(robust=True))
    assert (wide.hotspots, wide.drift_node_per_step, wide.items_sd) == (3, 0.2, 37.5)
    assert BeliefSettings.of(Prior()) == BeliefSettings()


def test_waiting_foragers_go_to_where_they_are_near_to_everything() -> None:
    ways = ways_of(SEA, 1, MoveRules(True, True))
    marks = SEA.node_of_cell[[5, 25], [15, 15]].astype(np.int32)
    move, at = np.zeros(9), int(SEA.node_of_cell[15, 3])
    approach(ways, marks, np.array([1.0, 1.0]), at, move)
    assert int(move.argmax()) in (NE, E, SE)
    approach(ways, marks, np.array([1.0, 9.0]), int(SEA.node_of_cell[15, 15]), move)
    assert int(move.argmax()) in (SE, S, SW)


def test_what_lies_behind_the_foragers_is_regretted_most() -> None:
    """One forager half-way between two places goes to the likelier; the other costs two a step."""
    ways = (ways_of(SEA, 1, MoveRules(True, True)),)
    marks = SEA.node_of_cell[[15, 15], [1, 29]].astype(np.int32)
    at, kind = SEA.node_of_cell[15:16, 15].copy(), np.zeros(1, np.int64)
    regret = regrets(ways, marks, np.array([1.0, 2.0]), kind, at, 6)
    np.testing.assert_allclose(regret, [2.0, 0.0])
