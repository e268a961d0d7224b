"""What every foraging environment can be told when it is made."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypedDict

from graph_planner.encodings import encoder_label
from mjforage.core.errors import UserError
from mjforage.core.once import say_once
from mjforage.core.scenario import Scenario
from mjforage.core.scenario_file import load_scenario
from mjforage.core.setup import Setup
from mjforage.learning.environments.harbour_picture import check_camera
from mjforage.learning.environments.rewards import PUBLISHED, checked_weights
from mjforage.learning.environments.spaces import DTYPES
from mjforage.physics.foretold import foretold
from mjforage.physics.worlds import WORLDS


class EnvironmentArguments(TypedDict, total=False):
    """Keyword arguments of the foraging environments, see `EnvironmentOptions`."""

    scenario: str | Scenario
    world: str
    observation: str
    reward: Mapping[str, float] | None
    map: str | None
    set: Sequence[str]
    render_mode: str | None
    camera: str | None
    dtype: str


@dataclass(frozen=True)
class EnvironmentOptions:
    """The arguments, checked.

    Attributes
    ----------
    scenario : preset, path of a TOML file, or a scenario
    world : name in `mjforage.physics.worlds.WORLDS`
    observation : reference to an encoder, see `graph_planner.encodings.create_encoder`
    reward : reference to a term -> weight, see `rewards`; absent: the published weights
    map : replaces the scenario's grid: a name, generated harbour, or path of a table, grid or image
    set : overrides KEY=VALUE of the scenario
    camera : of `mjforage render --camera`, to see the hulls in 3-D; None: the map from above
    dtype : "float32", values in [0, 1], or "uint8", levels that a learner divides by 255 itself

    Raises
    ------
    UserError
        If a name is not known or the scenario is not a valid one.
    """

    scenario: str | Scenario = "comb-port"
    world: str = "graph"
    observation: str = "egocentric"
    reward: Mapping[str, float] | None = None
    map: str | None = None
    set: Sequence[str] = ()
    render_mode: str | None = None
    camera: str | None = None
    dtype: str = "float32"
    setup: Setup = field(init=False)
    weights: dict[str, float] = field(init=False)

    def __post_init__(self) -> None:
        if self.world not in WORLDS:
            raise UserError(f"world = {self.world!r}: unknown; choose {', '.join(WORLDS)}")
        if self.dtype not in DTYPES:
            raise UserError(f"dtype = {self.dtype!r}: unknown; choose {', '.join(DTYPES)}")
        check_camera(self.camera, self.world, self.render_mode)
        object.__setattr__(self, "observation", encoder_label(self.observation))
        scenario = self.scenario
        if isinstance(scenario, str):
            scenario = load_scenario(scenario, self.set, self.map)
        elif self.map is not None or self.set:
            raise UserError("map and set change a scenario's file; give the scenario by its name")
        object.__setattr__(self, "setup", Setup.of(scenario))
        for line in foretold(self.setup, (self.world,)):
            say_once(line)
        weights = PUBLISHED if self.reward is None else self.reward
        object.__setattr__(self, "weights", checked_weights(weights))
