"""Task family: a scenario on generated harbours in turn.

A harbour's core is built when its turn comes and dropped after it, so that memory does not grow
with the family; the graphs of the last few stay with `navigation_graph`.
"""

from collections.abc import Callable
from typing import Any

from mjforage.base.randomness import UInt64Array
from mjforage.learning.environments.choices import scenarios_of
from mjforage.learning.environments.cores import common_shapes
from mjforage.learning.environments.options import EnvironmentOptions
from mjforage.learning.training.rounds import Round
from mjforage.learning.training.tasks import TrainingTask
from mjforage.scenario.harbours import is_family
from mjforage.scenario.scenario import Scenario

Make = Callable[[Scenario], TrainingTask]


class TaskFamily:
    """A scenario of a training run on harbours in turn.

    Attributes
    ----------
    scenario : as given; its map names the family
    notes : what tells the maps and rules that are played on from others
    examples : what is played on the first harbour and on the last
    """

    def __init__(self, scenario: Scenario, make: Make) -> None:
        """Prepare.

        Raises `UserError` if the family's name is not well formed, or the scenario fits on none of
        its harbours.

        Parameters
        ----------
        scenario : whose map is a family, such as `harbours:0-39`
        make : what plays a scenario on one map
        """
        self.scenario, self._make = scenario, make
        self._scenarios = scenarios_of(scenario)
        self.notes: list[dict[str, Any]] = []
        for each in self._scenarios:  # all are tried now, not hours later
            self.notes += make(each).notes
        self.examples: list[EnvironmentOptions] = [
            options for each in ends(self._scenarios) for options in make(each).options
        ]

    def round(self, keys: UInt64Array, turn: int) -> Round:
        """One episode of each key (env,), not yet started, on the harbour whose turn it is.

        Raises `UserError` if the observation's arrays have not the same shapes there.
        """
        task = self._make(self._scenarios[turn % len(self._scenarios)])
        common_shapes([*self.examples[:1], *task.options[:1]])
        return task.round(keys)


def ends(scenarios: list[Scenario]) -> list[Scenario]:
    """The first and the last, which stand for a family where all would take minutes."""
    return scenarios[:1] + scenarios[1:][-1:]


def training_task_of(scenario: Scenario, make: Make) -> TrainingTask | TaskFamily:
    """Task of the rounds of a scenario: its map, or its family of harbours in turn.

    Raises `UserError` as `TrainingTask` and `TaskFamily`.
    """
    return TaskFamily(scenario, make) if is_family(scenario.map.file) else make(scenario)
