"""The truth goes to bounds and to nobody else, and every table says which is which."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from graph_planner.policies import Policy, create_policy, is_bound, policy_names
from graph_planner.randomness import UInt64Array
from graph_planner.task import Observation, Task, Truth
from mjforage.core.mission import Mission
from mjforage.core.scenario_file import load_scenario
from mjforage.core.setup import Setup
from mjforage.view.report.policy_pairs import comparison_table
from mjforage.view.report.run_logs import load_logs
from mjforage.view.report.text_tables import full_table, headline_table, policy_name


class Watcher:
    """Stays put and remembers what it was told."""

    def reset(self, task: Task, keys: UInt64Array) -> None:
        self.told: list[Truth] = []
        self._moves = np.zeros((keys.size, len(task.fleet), 9))
        self._moves[:, :, 8] = 1.0

    def act(self, observation: Observation) -> NDArray[np.float64]:
        return self._moves


class Peeper(Watcher):
    def reveal(self, truth: Truth) -> None:
        self.told.append(Truth(truth.item_rc.copy(), truth.item_node.copy(), truth.drift_rc.copy()))


def played(policy: Policy) -> Mission:
    mission = Mission(Setup.of(load_scenario("comb-port", ["horizon=5"])))
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


def test_the_oracle_alone_is_marked() -> None:
    assert [name for name in policy_names() if is_bound(name)] == ["oracle"]
    assert policy_name("oracle", ["oracle"]) == "oracle (bound)"
    assert not hasattr(create_policy("belief"), "reveal")


def test_tables_mark_bounds_and_pick_the_best_without_them(
    evaluate_small: Callable[..., Path], tmp_path: Path
) -> None:
    logs = load_logs(evaluate_small(tmp_path / "run", policies=("greedy", "random", "oracle")))
    paired = comparison_table(logs)
    assert paired is not None
    for table in (headline_table(logs), full_table(logs)):
        heads = {row.head for row in table.rows if not row.paper}
        assert heads == {"greedy", "random", "oracle (bound)"}
        assert not any(row.best for row in table.rows if "bound" in row.head)
    assert {row.group for row in paired.rows} >= {"greedy − oracle (bound)"} or {
        row.group for row in paired.rows
    } >= {"oracle (bound) − greedy"}
