"""The ledger and scans that may miss items: what is in view is seen or not, by item and step."""

import numpy as np
from numpy.typing import NDArray

from mjforage.scenario.roles import Role
from mjforage.scenario.scenario import Sensors
from tests.mjforage.mission.watching import Watched, task_of

TASK = task_of((1, 3), scouts=Role(count=1, moves=1, radius=1.0, collects=False))
EPISODES = 400
ITEMS = [0, 0, 2]  # and the agent in the middle: all three nodes are in view


def watched(detection: float, steps: int) -> Watched:
    return Watched(TASK, Sensors(detection=detection), [1], ITEMS, steps, EPISODES)


def share(values: NDArray[np.bool_]) -> float:
    return float(values.mean())


def test_certain_detection_sees_all_and_none_sees_nothing() -> None:
    assert (watched(1.0, 0).knowledge.belief == [2, 0, 1]).all()
    blind = watched(0.0, 3)
    assert (blind.knowledge.belief == 0).all()
    assert (blind.entries.t_discovered == -1).all()
    assert (blind.entries.truth == [2, 0, 1]).all(), "the truth stays what it is"
    assert (blind.knowledge.last_seen == 3).all(), "looking counts, whether or not anything is seen"


def test_only_what_was_seen_is_credited() -> None:
    once = watched(0.5, 0)
    first = once.entries.t_discovered == 0
    assert (once.entries.discovered_by[first] == 0).all()
    assert (once.entries.discovered_by[~first] == -1).all()
    in_node = first[:, :2].sum(axis=1)
    assert (once.knowledge.belief[:, 0] == in_node).all()


def test_draws_do_not_depend_on_the_batch() -> None:
    whole = watched(0.5, 0).knowledge.belief
    some = Watched(TASK, Sensors(detection=0.5), [1], ITEMS, 0, np.arange(5, 7))
    assert (some.knowledge.belief == whole[5:7]).all()


def test_a_look_of_both_teams_is_credited_to_the_scout_whatever_the_order_of_the_file() -> None:
    forager, scout = Role(1, 1, 1.0, True), Role(1, 1, 1.0, False)
    for roles in ({"foragers": forager, "scouts": scout}, {"scouts": scout, "foragers": forager}):
        task = task_of((1, 3), **roles)
        for sensors in (Sensors(), Sensors(false_rate=1e-9)):
            by = Watched(task, sensors, [1, 1], ITEMS, 0, 1).entries.discovered_by
            assert (by[0] == task.fleet.discoverers[0]).all()
