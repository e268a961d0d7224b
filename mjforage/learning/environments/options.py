"""Options of every foraging environment."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, TypedDict

from numpy.typing import NDArray

from mjforage.base.cached import warn_once
from mjforage.base.errors import UserError
from mjforage.base.references import nearest
from mjforage.graph_planner.encodings import encoder_label
from mjforage.learning.environments.checks import check_mode
from mjforage.learning.environments.choices import (
    Overrides,
    check_known,
    chosen_setup,
    on_each_map,
)
from mjforage.learning.environments.rewards import reward_weights
from mjforage.learning.environments.spaces import DTYPES
from mjforage.mission.setup import Setup
from mjforage.physics.run_warnings import run_warnings
from mjforage.physics.worlds import WORLDS
from mjforage.scenario.scenario import Scenario


class EnvironmentArguments(TypedDict, total=False):
    """Keyword arguments of the foraging environments, see `EnvironmentOptions`."""

    scenario: str | Path | Scenario
    world: str
    observation: str
    reward: str | Mapping[str, float]
    map: str | Path | NDArray[Any] | list[Any] | None
    set: Overrides
    render_mode: str | None
    dtype: str


@dataclass(frozen=True)
class EnvironmentOptions:
    """The arguments, checked.

    Raises `UserError` if a name is not known or the scenario is not a valid one.

    Attributes
    ----------
    scenario : preset, path of a TOML file, or a scenario
    world : name in `mjforage.physics.worlds.WORLDS`
    observation : reference to an encoder, see `mjforage.graph_planner.encodings.create_encoder`
    reward : "mission", "published" or "ddqn", or a mapping of terms and such names to weights, see
        `rewards.reward_weights`
    map : replaces the scenario's grid: a name, generated harbour, path of a table, grid or image;
        or an array (row, column), True or 1 where there is water, on which the fleet starts in a
        cluster
    set : overrides of the scenario: KEY -> value, or KEY=VALUE each
    dtype : "float32", values in [0, 1], or "uint8", levels that a learner divides by 255 itself
    """

    scenario: str | Path | Scenario = "comb-port"
    world: str = "graph"
    observation: str = "egocentric"
    reward: str | Mapping[str, float] = "mission"
    map: str | Path | NDArray[Any] | list[Any] | None = None
    set: Overrides = ()
    render_mode: str | None = None
    dtype: str = "float32"
    setup: Setup = field(init=False)
    weights: dict[str, float] = field(init=False)

    def __post_init__(self) -> None:
        if self.world not in WORLDS:
            raise UserError(f"world = {self.world!r}: unknown; {nearest(self.world, WORLDS)}")
        if self.dtype not in DTYPES:
            raise UserError(f"dtype = {self.dtype!r}: unknown; choose {', '.join(DTYPES)}")
        check_mode(self.render_mode)
        object.__setattr__(self, "observation", encoder_label(self.observation))
        object.__setattr__(self, "setup", chosen_setup(self.scenario, self.map, self.set))
        for line in run_warnings(self.setup, (self.world,)):
            warn_once(line)
        object.__setattr__(self, "weights", reward_weights(self.reward))

    @classmethod
    def of(cls, arguments: Mapping[str, Any]) -> "EnvironmentOptions":
        """Options from keyword arguments; raises as the class, and for unknown arguments."""
        known = [each.name for each in fields(cls) if each.init]
        check_known(arguments, known)
        return cls(**arguments)

    @classmethod
    def of_maps(cls, arguments: Mapping[str, Any], most: int) -> list["EnvironmentOptions"]:
        """Options of each of the maps that keyword arguments name; raises as `of`.

        `most`: so many of them, the first ones.
        """
        names = "scenario", "map", "set"
        given = [arguments.get(name, getattr(cls, name)) for name in names]
        others = {name: one for name, one in arguments.items() if name not in names}
        return [cls.of(others | each) for each in on_each_map(*given)[:most]]
