"""Training tasks: a scenario, or variants of it of which each episode draws one.

Settings that are drawn anew for every episode are domain randomisation (Tobin et al., IROS 2017).
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from itertools import product
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.errors import UserError
from mjforage.base.randomness import Stream, UInt64Array, stream_key, uniform
from mjforage.graph_planner.networks.weights import ground_note
from mjforage.learning.environments.core import EnvironmentCore
from mjforage.learning.environments.cores import create_core
from mjforage.learning.environments.options import EnvironmentOptions
from mjforage.learning.training.hyperparameters import WHERE
from mjforage.learning.training.rounds import Round
from mjforage.physics.worlds import create_mission
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.scenario_file import with_values

MOST = 256  # variants of a scenario: each is read and checked before training begins

Vary = Mapping[str, tuple[Any, ...]]


def variants(scenario: Scenario, vary: Vary) -> list[Scenario]:
    """A scenario with every combination of the values that some of its keys may have.

    Raises `UserError` if a key has no values, there are too many combinations, or one is no valid
    scenario.
    """
    for key, values in vary.items():
        if not values:
            raise UserError(f"{WHERE}: vary.{key} = []: no values; give some, such as [1, 2]")
    number = prod(len(values) for values in vary.values())
    if number > MOST:
        raise UserError(f"{WHERE}: vary makes {number} scenarios of one; give at most {MOST}")
    drawn = (dict(zip(vary, values, strict=True)) for values in product(*vary.values()))
    return [with_values(scenario, each, f"{WHERE}, vary") for each in drawn]


class TrainingTask:
    """A scenario of a training run, and its variants.

    Attributes
    ----------
    scenario : as given
    setup : of the scenario
    options, examples : of what is played: its variants, or the scenario itself
    """

    def __init__(self, options: EnvironmentOptions, num_envs: int, vary: Vary) -> None:
        """Prepare.

        Raises `UserError` if a variant is not valid or cannot be run in the world, or there is not
        the memory for so many episodes.

        Parameters
        ----------
        options : of the scenario
        num_envs : episodes of a round
        vary : key of the scenario -> values; each episode draws one of each key
        """
        self.setup, self.options, self._num_envs = options.setup, [options], num_envs
        self.scenario = self.setup.scenario
        self.setup.check_memory(num_envs)
        if vary:
            self.options = [
                replace(options, scenario=scenario) for scenario in variants(self.setup.asked, vary)
            ]
        self.examples, self._varied = self.options, bool(vary)
        if options.world != "graph":  # what a world refuses is said now, not hours later
            for each in self.options:
                create_mission(each.setup, each.world)

    @property
    def notes(self) -> list[dict[str, Any]]:
        """Identities of the maps and rules that are played on, each once."""
        notes = [ground_note(each.setup.task) for each in self.options]
        return [note for i, note in enumerate(notes) if note not in notes[:i]]

    @cached_property
    def _core(self) -> EnvironmentCore:
        return create_core(self.options[0], self._num_envs)

    def round(self, keys: UInt64Array, turn: int = 0) -> Round:
        """One episode of each key (env,), not yet started, the same in every turn."""
        if not self._varied:
            return Round([self._core], [np.arange(self._num_envs)])
        number = _drawn(keys, Stream.VARIANT, len(self.options))
        envs = [np.flatnonzero(number == one) for one in np.unique(number)]
        return Round([create_core(self.options[number[own[0]]], own.size) for own in envs], envs)


@kernel
def _drawn(keys: UInt64Array, stream: int, count: int) -> NDArray[np.int64]:
    """Number of the variant that the episode of each key (env,) has."""
    number = np.empty(keys.size, np.int64)
    for e in range(keys.size):
        number[e] = int(uniform(stream_key(keys[e], stream), 0, 0) * count)
    return number
