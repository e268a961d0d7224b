"""Observations of somebody else's are checked before kernels index by them."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.graph_planner.policies import create_policy
from mjforage.mission.plain import Plain, plain_truth
from mjforage.mission.task import GroundTruth, Observation, Task
from mjforage.scenario.roles import Role
from tests.graph_planner.driver import observation_of, task_of, truth_of

OPEN = navigation_graph(np.ones((6, 7), np.bool_), 1.0, True)
TASK = task_of(
    OPEN, scouts=Role(1, 2, 2.0, collects=False), foragers=Role(1, 1, 1.0, collects=True)
)


def seen() -> Observation:
    return observation_of(TASK, [(1, 1), (3, 3)], {(2, 2): 1}, episodes=2)


def lent() -> Observation:
    observation = seen()
    for array in observation:
        array.flags.writeable = False
    return observation


def test_what_a_mission_hands_over_is_handed_on_as_it_is() -> None:
    observation = lent()
    plain = Plain(TASK, 2)
    assert plain(observation) is observation
    again = observation._replace(step=lent().step)
    assert plain(again) is again


def test_what_is_of_other_types_is_converted() -> None:
    observation = seen()
    other = observation._replace(
        agent_node=observation.agent_node.astype(np.int64),
        belief=np.asfortranarray(observation.belief),
    )
    pairs: Any = zip(observation, Plain(TASK, 2)(other), strict=True)
    for one, array in pairs:
        assert array.dtype == one.dtype and array.flags.c_contiguous
        np.testing.assert_array_equal(array, one)


def delayed(column: int, number: int) -> NDArray[np.int32]:
    scans = np.full((2, 1, 3), -1, np.int32)
    scans[0, 0, column] = number
    return scans


WRONG: list[tuple[dict[str, Any], str]] = [
    ({"agent_node": np.full((2, 2), 42, np.int32)}, r"agent_node = 42: expected 0 to 41"),
    ({"agent_node": np.full((2, 2), -1, np.int32)}, r"agent_node = -1: expected 0 to 41"),
    ({"agent_node": np.full((2, 2), 1e12)}, r"agent_node = 1000000000000.0: expected 0 to 41"),
    ({"agent_node": np.full((2, 2), np.nan)}, r"agent_node = nan: expected 0 to 41"),
    ({"agent_node": np.zeros((2, 3), np.int32)}, r"agent_node: has shape \(2, 3\), expected \(2,"),
    ({"belief": np.full((2, 42), -3, np.int16)}, r"belief = -3: expected 0 to 32767"),
    ({"belief": np.full((2, 42), 1e9)}, r"belief = 1000000000.0: expected 0 to 32767"),
    ({"belief": np.zeros((2, 41), np.int16)}, r"belief: has shape \(2, 41\), expected \(2, 42\)"),
    ({"n_known": np.full(2, 43, np.int32)}, r"n_known = 43: expected 0 to 42"),
    ({"known": np.full((2, 42), 1 << 30, np.int32)}, r"known = 1073741824: expected 0 to 41"),
    ({"step": np.full(2, 500, np.int32)}, r"step = 500: expected 1 to 151"),
    ({"pickup": np.full((2, 2), 9, np.int8)}, r"pickup = 9: expected 0 to 3"),
    ({"owner": np.full(2, 2, np.int32)}, r"owner = 2: expected -1 to 1"),
    ({"agent_yaw": np.full((2, 2), np.inf)}, r"agent_yaw = inf: expected"),
    ({"energy_left": np.full((2, 2), np.nan)}, r"energy_left = nan: expected"),
    ({"active": np.ones(5, np.bool_)}, r"active: has shape \(5,\), expected \(2,\)"),
    ({"delayed_scans": delayed(0, 151)}, r"delayed_shown: has shape"),
]


@pytest.mark.parametrize(("fields", "words"), WRONG)
@pytest.mark.parametrize("name", ["greedy", "levy", "wanderer", "lawnmower", "pso", "random"])
def test_what_does_not_fit_is_refused_by_name(
    name: str, fields: dict[str, Any], words: str
) -> None:
    policy = create_policy(name)
    policy.reset(TASK, seen().keys)
    with pytest.raises(UserError, match=rf"^observation\.{words}.*; hand on what the mission"):
        policy.act(seen()._replace(**fields))


@pytest.mark.parametrize(("column", "number"), [(0, 200), (1, 2), (2, 42), (2, -2)])
def test_delayed_scans_are_of_agents_at_nodes(column: int, number: int) -> None:
    shown = np.zeros((2, 1, int(np.diff(TASK.views.start, axis=1).max())), np.int16)
    with pytest.raises(UserError, match=f"delayed_scans .* = {number}: expected"):
        Plain(TASK, 2)(seen()._replace(delayed_scans=delayed(column, number), delayed_shown=shown))


def test_an_observation_of_other_episodes_or_another_map_is_refused() -> None:
    """A mission's own too: kernels would write beyond what `reset` made ready."""
    other = Task(navigation_graph(np.ones((9, 9), np.bool_), 1.0, True), *_rest(TASK))
    for task, rows in ((TASK, 1), (other, 2)):
        with pytest.raises(UserError, match="hand on what the mission gives"):
            Plain(task, rows)(lent())


def _rest(task: Task) -> tuple[Any, ...]:
    return task.fleet, task.rules, task.horizon


def test_what_takes_the_place_of_a_lent_array_is_looked_at() -> None:
    plain, observation = Plain(TASK, 2), lent()
    plain(observation)
    for name in ("agent_node", "step", "known", "owner"):
        wrong = np.full_like(getattr(observation, name), 999)
        with pytest.raises(UserError, match=f"{name} = 999"):
            plain(observation._replace(**{name: wrong}))
    short = observation.active[:1]  # it may not be written, and is no lent array
    with pytest.raises(UserError, match=r"active: has shape \(1,\), expected \(2,\)"):
        plain(observation._replace(active=short))


def test_a_truth_tells_of_nodes_and_places() -> None:
    truth = truth_of(TASK, seen())
    assert plain_truth(truth, TASK) is truth
    for wrong, words in (
        (truth._replace(item_node=truth.item_node + 100), r"truth\.item_node = 1\d\d: expected -1"),
        (truth._replace(item_rc=truth.item_rc * np.nan), r"truth\.item_rc = nan: expected"),
        (truth._replace(item_rc=truth.item_rc[:, :0]), r"truth\.item_rc: has shape \(2, 0, 2\)"),
        (truth._replace(item_drift_rc=np.zeros(2)), r"truth\.item_drift_rc: has shape \(2,\)"),
    ):
        with pytest.raises(UserError, match=words):
            plain_truth(GroundTruth(*wrong), TASK)
