"""`mjforage/Foraging-v0`: the whole fleet as one agent."""

from typing import Any, ClassVar, Unpack

import gymnasium
import numpy as np
from numpy.typing import NDArray

from mjforage.environments.choice import RENDER_MODES, Choice, Options
from mjforage.environments.game import Episodes, Game
from mjforage.environments.pictures import Picture
from mjforage.environments.spaces import MASK, Pictures, picture_space, values

LANE = np.zeros(1, np.int64)


class ForagingEnv(gymnasium.Env[Pictures, NDArray[np.int64]]):
    """One decision of all agents per step.

    **Action** `MultiDiscrete([9] * agents)`: per agent 0-7 compass from north clockwise, 8 stay.
    An illegal move, or one to a node that an agent of higher index took, becomes staying put where
    that is legal, else the first legal compass move; `info["illegal"]` counts them.

    **Observation** a dict of float32 in [0, 1] with a leading agent axis, of the kind chosen:

    | kind | arrays per agent | table |
    |---|---|---|
    | egocentric | crop (8, 15, 15), globe (7, 16, 16), moves (9, 11), self (12,) | `Egocentric` |
    | paper | map (6, rows, columns) | `PaperChannels` |

    and `action_mask` (agents, 9) int8, 1 where a move is legal before anybody has chosen. The
    tables are in `graph_planner.perception`; a value is level / 255.

    **Reward** the sum over agents and terms; `info["reward/<term>"]` has each weighted term's.
    **End** terminated when no item is left or nobody has energy; truncated at the horizon.
    **Episode** decided by the seed of the last `reset(seed=...)` and the number of resets since.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": RENDER_MODES, "render_fps": 10}  # type: ignore[misc]

    def __init__(self, **options: Unpack[Options]) -> None:
        """See `mjforage.environments.choice.Choice` for the options.

        Raises
        ------
        UserError
            If one is not valid.
        """
        choice = Choice(**options)
        self.render_mode = choice.render_mode
        self._game = Game(choice)
        self._episodes = Episodes()
        self._picture = Picture() if choice.render_mode else None
        agents = self._game.agents
        self.observation_space = picture_space(self._game.shapes, (agents,))
        self.action_space = gymnasium.spaces.MultiDiscrete([9] * agents)

    @property
    def game(self) -> Game:
        """The mission and all about it."""
        return self._game

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Pictures, dict[str, Any]]:
        """Start the next episode; with a seed, the first one of that seed."""
        super().reset(seed=seed)
        self._game.start(LANE, self._episodes.following(seed, self.np_random))
        self._note()
        return self._observed(), self._game.facts()

    def step(self, action: NDArray[np.int64]) -> tuple[Pictures, float, bool, bool, dict[str, Any]]:
        """One decision of the fleet."""
        outcome = self._game.step(np.asarray(action, np.int64)[None])
        self._note()
        info = self._game.facts() | {"illegal": int(outcome.illegal[0])}
        for name, term in outcome.terms.items():
            info[f"reward/{name}"] = float(term[0].sum())
        ended = bool(outcome.terminated[0]), bool(outcome.truncated[0])
        return self._observed(), float(outcome.rewards[0].sum()), *ended, info

    def render(self) -> Any:
        """The map from above, (height, width, 3) uint8, or None without a render mode."""
        if self._picture is None:
            return None
        return self._picture.draw(self._game.mission, self._game.choice.world)

    def _note(self) -> None:
        if self._picture is not None:
            self._picture.see(self._game.mission)

    def _observed(self) -> Pictures:
        seen: Pictures = {name: values(level[0]) for name, level in self._game.see(LANE).items()}
        return {**seen, MASK: self._game.masks[0]}
