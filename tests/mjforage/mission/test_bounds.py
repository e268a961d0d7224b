"""The truth goes to bounds and to nobody else, and every table says which is which."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.belief_planner.privileged_beliefs import UNREPORTED
from mjforage.graph_planner.policies import create_policy, is_upper_bound, policy_names
from mjforage.mission.mission import Mission
from mjforage.mission.policy import Policy
from mjforage.mission.setup import Setup
from mjforage.mission.task import GroundTruth, Observation, Task
from mjforage.scenario.scenario_file import load_scenario
from mjforage.view.report.policy_pairs import comparison_table
from mjforage.view.report.run_logs import load_logs, policy_name
from mjforage.view.report.text_tables import full_table, headline_table


class Watcher:
    """Stays put and remembers what it was told."""

    def reset(self, task: Task, keys: UInt64Array) -> None:
        self.told: list[GroundTruth] = []
        self._moves = np.zeros((keys.size, len(task.fleet), 9))
        self._moves[:, :, 8] = 1.0

    def act(self, observation: Observation) -> NDArray[np.float64]:
        return self._moves


class Peeper(Watcher):
    def set_ground_truth(self, truth: GroundTruth) -> None:
        self.told.append(GroundTruth._make(part.copy() for part in truth))


class ApartPeeper(Peeper):
    decentralised = True

    def act(self, observation: Observation) -> NDArray[np.float64]:
        self.rows = observation.keys.size
        return super().act(observation)


def played(policy: Policy, *overrides: str) -> Mission:
    mission = Mission(Setup.of(load_scenario("comb-port", ["horizon=5", *overrides])))
    mission.reset(0, np.arange(3))
    mission.run(policy)
    return mission


def test_a_bound_is_shown_the_truth_before_every_decision() -> None:
    peeper, watcher = Peeper(), Watcher()
    mission = played(peeper)
    assert len(peeper.told) == 5
    np.testing.assert_array_equal(peeper.told[0].item_rc, mission.initial.item_rc)
    np.testing.assert_array_equal(peeper.told[3].drift_rc, mission.initial.drift_rc)
    assert (peeper.told[4].item_rc != peeper.told[3].item_rc).any()
    played(watcher)
    assert watcher.told == []


@pytest.mark.parametrize(("link", "owners"), [("none", 4), ("ideal", 1)])
def test_a_bound_that_is_apart_decides_for_each_owner(link: str, owners: int) -> None:
    peeper, pooled = ApartPeeper(), Peeper()
    mission = played(peeper, f"link.model={link}")
    assert peeper.rows == 3 * owners
    told, start = peeper.told[0], mission.initial
    np.testing.assert_array_equal(told.item_rc, np.repeat(start.item_rc, owners, axis=0))
    np.testing.assert_array_equal(told.item_node, np.repeat(start.item_node, owners, axis=0))
    np.testing.assert_array_equal(told.drift_rc, np.repeat(start.drift_rc, owners, axis=0))
    played(pooled, f"link.model={link}")
    assert pooled.told[0].item_node.shape[0] == 3


LINK = ("horizon=60", "link.model=disk", "link.range_m=40", "link.latency=1")


class Recorder:
    """The oracle of what was received; keeps what it is shown and answers."""

    decentralised = True

    def __init__(self) -> None:
        self.oracle = create_policy("oracle(received=true)")
        self.seen: list[Observation] = []
        self.told: list[GroundTruth] = []
        self.answers: list[NDArray[np.float64]] = []

    def reset(self, task: Task, keys: UInt64Array) -> None:
        self.oracle.reset(task, keys)

    def set_ground_truth(self, truth: GroundTruth) -> None:
        self.told.append(GroundTruth._make(part.copy() for part in truth))
        self.oracle.set_ground_truth(truth)  # type: ignore[attr-defined]

    def act(self, observation: Observation) -> NDArray[np.float64]:
        self.seen.append(Observation._make(part.copy() for part in observation))
        self.answers.append(self.oracle.act(observation).copy())
        return self.answers[-1]


def answers_to(first: Recorder, mission: Mission, hidden: NDArray[np.bool_]) -> Recorder:
    """What it answers where some items (row, item) never were, all else as it was."""
    again = Recorder()
    again.reset(mission.task, first.seen[0].keys)
    for seen, truth in zip(first.seen, first.told, strict=True):
        item_rc = np.where(hidden[..., None], 0.0, truth.item_rc)
        again.set_ground_truth(
            truth._replace(item_rc=item_rc, item_node=np.where(hidden, -1, truth.item_node))
        )
        again.act(seen)
    return again


def test_the_oracle_of_what_was_received_knows_nothing_else() -> None:
    first = Recorder()
    mission = Mission(Setup.of(load_scenario("comb-port", LINK)))
    mission.reset(2, np.arange(2))
    mission.run(first)
    since = first.oracle._planner.beliefs.since  # type: ignore[attr-defined]
    unheard = since == UNREPORTED
    assert unheard.any() and not unheard.all()
    apart = unheard.reshape(2, 4, -1)
    assert (apart != apart[:, :1]).any(), "owners have received different items"
    kept = answers_to(first, mission, unheard)
    for one, other in zip(first.answers, kept.answers, strict=True):
        np.testing.assert_array_equal(one, other)
    lost = answers_to(first, mission, ~unheard)
    assert any((a != b).any() for a, b in zip(first.answers, lost.answers, strict=True))


def test_the_oracle_alone_is_marked() -> None:
    assert [name for name in policy_names() if is_upper_bound(name)] == ["oracle"]
    assert policy_name("oracle", ["oracle"]) == "oracle (bound)"
    assert is_upper_bound("oracle(received=true)")
    assert not hasattr(create_policy("belief"), "set_ground_truth")


def test_tables_mark_bounds_and_pick_the_best_without_them(
    evaluate_small: Callable[..., Path], tmp_path: Path
) -> None:
    logs = load_logs(evaluate_small(tmp_path / "run", policies=("greedy", "random", "oracle")))
    paired = comparison_table(logs)
    for table in (headline_table(logs), full_table(logs)):
        heads = {row.head for row in table.rows if not row.paper}
        assert heads == {"greedy", "random", "oracle (bound)"}
        assert not any(row.best for row in table.rows if "bound" in row.head)
    assert {row.group for row in paired.rows} >= {"greedy − oracle (bound)"} or {
        row.group for row in paired.rows
    } >= {"oracle (bound) − greedy"}
