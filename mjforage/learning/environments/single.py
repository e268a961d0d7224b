"""Base of the environments of one episode at a time: the core, its episodes, its figure."""

from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from mjforage.graph_planner.encodings.encoder import Levels
from mjforage.learning.environments.checks import RENDER_MODES, checked_started
from mjforage.learning.environments.core import EnvironmentCore, Episodes, Outcome
from mjforage.learning.environments.episode_figure import EpisodeFigure
from mjforage.learning.environments.options import EnvironmentArguments, EnvironmentOptions

ONLY = np.zeros(1, np.int64)  # number of the one sub-environment
METADATA: dict[str, Any] = {"render_modes": RENDER_MODES, "render_fps": 10}


class SingleEnvironment:
    """Base of an environment; its options are those of `EnvironmentOptions`.

    Raises `UserError` if an option is not valid.
    """

    metadata: ClassVar[dict[str, Any]] = METADATA

    def __init__(self, arguments: EnvironmentArguments, by_turns: bool = False) -> None:
        options = EnvironmentOptions.of(arguments)
        self.render_mode, self._dtype = options.render_mode, options.dtype
        turns = len(options.setup.fleet) if by_turns else 1
        self._core = EnvironmentCore(options, turns=turns)
        self._episodes = Episodes()
        self._figure = EpisodeFigure() if options.render_mode else None

    @property
    def core(self) -> EnvironmentCore:
        """The mission and all about it."""
        return self._core

    def render(self) -> Any:
        """The map from above, (height, width, 3) uint8, or None without a render mode."""
        if self._figure is None:
            return None
        checked_started(self._core.started, "render")
        return self._figure.draw(self._core, self._episodes)

    def _start(self, seed: int | None, entropy: np.random.Generator) -> None:
        """Begin the next episode; with a seed, the first one of that seed."""
        self._core.start(ONLY, self._episodes.following(seed, entropy))
        self._note()

    def _play(self, actions: NDArray[np.int64]) -> Outcome:
        """One decision (agent,) of the fleet."""
        outcome = self._core.step(actions[None])
        self._note()
        return outcome

    def _seen(self) -> dict[str, Levels]:
        """Levels (agent, ...) of the observation; live."""
        return {name: level[0] for name, level in self._core.see(ONLY).items()}

    def _note(self) -> None:
        if self._figure is not None:
            self._figure.see(self._core.mission)


def summed(outcome: Outcome) -> tuple[float, bool, bool, dict[str, Any]]:
    """Reward of the fleet, terminated, truncated, and the info of a step."""
    info: dict[str, Any] = {"illegal": int(outcome.illegal[0])}
    for name, term in outcome.terms.items():
        info[f"reward/{name}"] = float(term[0].sum())
        info[f"episode_terms/{name}"] = float(outcome.sums[name][0].sum())
    ended = bool(outcome.terminated[0]), bool(outcome.truncated[0])
    return float(outcome.rewards[0].sum()), *ended, info
