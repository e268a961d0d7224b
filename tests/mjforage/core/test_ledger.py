"""The ledger under a detection probability: what is in view is seen or not, by item and step."""

import numpy as np
from numpy.typing import NDArray

from graph_planner.fleet import Fleet, Role
from graph_planner.knowledge import Knowledge, Looks
from graph_planner.moves import MoveRules
from graph_planner.navigation import navigation_graph
from graph_planner.randomness import episode_keys
from graph_planner.task import Task
from mjforage.core.ledger import Ledger
from mjforage.core.looking import Lookout

GRAPH = navigation_graph(np.ones((1, 3), np.bool_), 1.0, True)
SCOUT = Fleet.of({"scouts": Role(count=1, moves=1, radius=1.0, collects=False)})
TASK = Task(GRAPH, SCOUT, MoveRules(True, True), 100)
EPISODES = 400
KEYS = episode_keys(0, np.arange(EPISODES))
AGENT = np.ones((EPISODES, 1), np.int32)  # in the middle: all three nodes are in view
ITEMS = np.tile(np.array([0, 0, 2], np.int32), (EPISODES, 1))


class Watched:
    """A scout that stays where it is, what it knows, and the ledger of what it watches."""

    def __init__(self, detection: float, steps: int, rows: slice = slice(None)) -> None:
        keys, nodes = KEYS[rows], AGENT[rows]
        ledger, everyone = Ledger(TASK, detection), np.ones(keys.size, np.bool_)
        ledger.reset(ITEMS[rows])
        self.entries = ledger.entries
        looks = Looks(
            active=everyone,
            step=np.zeros(keys.size, np.int32),
            agent_node=nodes,
            sighted=ledger.entries.sighted,
            energy_left=np.full(nodes.shape, np.inf),
            room_left=np.zeros(nodes.shape, np.int64),
            taken=np.zeros(nodes.shape, np.int64),
            pickup=np.zeros(nodes.shape, np.int8),
            agent_yaw=np.zeros(nodes.shape),
        )
        self.knowledge = Knowledge.of_starts(looks, len(GRAPH))
        lookout = Lookout(TASK, detection, keys, ledger.entries, self.knowledge)
        nobody = np.full(ITEMS[rows].shape, -1, np.int16)
        for step in range(steps + 1):
            looks = looks._replace(step=np.full(keys.size, step, np.int32))
            lookout.look(looks, ITEMS[rows], nobody)


def share(values: NDArray[np.bool_]) -> float:
    return float(values.mean())


def test_certain_detection_sees_all_and_none_sees_nothing() -> None:
    assert (Watched(1.0, 0).knowledge.belief == [2, 0, 1]).all()
    blind = Watched(0.0, 3)
    assert (blind.knowledge.belief == 0).all()
    assert (blind.entries.t_discovered == -1).all()
    assert (blind.entries.truth == [2, 0, 1]).all(), "the truth stays what it is"
    assert (blind.knowledge.last_seen == 3).all(), "looking counts, whether or not anything is seen"


def test_each_item_is_seen_with_its_probability_at_every_step_anew() -> None:
    """Counts in a node are binomial; first discovery is geometric."""
    p, now, later = 0.3, Watched(0.3, 0).knowledge.belief, Watched(0.3, 5)
    tolerance = 4 * 0.5 / np.sqrt(EPISODES)
    for count, expected in ((0, 0.7**2), (1, 2 * 0.3 * 0.7), (2, 0.3**2)):
        assert abs(share(now[:, 0] == count) - expected) < tolerance
        assert abs(share(later.knowledge.belief[:, 0] == count) - expected) < tolerance
    for step in range(3):
        found = share(later.entries.t_discovered == step)
        assert abs(found - p * (1 - p) ** step) < tolerance / np.sqrt(3)


def test_only_what_was_seen_is_credited() -> None:
    watched = Watched(0.5, 0)
    first = watched.entries.t_discovered == 0
    assert (watched.entries.discovered_by[first] == 0).all()
    assert (watched.entries.discovered_by[~first] == -1).all()
    in_node = first[:, :2].sum(axis=1)
    assert (watched.knowledge.belief[:, 0] == in_node).all()


def test_draws_do_not_depend_on_the_batch() -> None:
    whole = Watched(0.5, 0).knowledge.belief
    assert (Watched(0.5, 0, slice(5, 7)).knowledge.belief == whole[5:7]).all()


def test_a_look_of_both_teams_is_credited_to_the_scout_whatever_the_order_of_the_file() -> None:
    forager, scout = Role(1, 1, 1.0, True), Role(1, 1, 1.0, False)
    for roles in ({"foragers": forager, "scouts": scout}, {"scouts": scout, "foragers": forager}):
        fleet = Fleet.of(roles)
        task = Task(GRAPH, fleet, MoveRules(True, True), 100)
        at, ledger = np.ones((1, 2), np.int32), Ledger(task)
        ledger.reset(ITEMS[:1])
        looks = Looks(
            active=np.ones(1, np.bool_),
            step=np.zeros(1, np.int32),
            agent_node=at,
            sighted=ledger.entries.sighted,
            energy_left=np.full(at.shape, np.inf),
            room_left=np.zeros(at.shape, np.int64),
            taken=np.zeros(at.shape, np.int64),
            pickup=np.zeros(at.shape, np.int8),
            agent_yaw=np.zeros(at.shape),
        )
        knowledge = Knowledge.of_starts(looks, len(GRAPH))
        lookout = Lookout(task, 1.0, KEYS[:1], ledger.entries, knowledge)
        lookout.look(looks, ITEMS[:1], np.full((1, 3), -1, np.int16))
        assert (ledger.entries.discovered_by[0] == fleet.discoverers[0]).all()
