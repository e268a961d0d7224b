"""`mjforage/Foraging-v0`: the whole fleet as one agent."""

from typing import Any, ClassVar, Unpack

import gymnasium
import numpy as np
from numpy.typing import NDArray

from mjforage.learning.environments.checks import checked_moves, checked_options
from mjforage.learning.environments.options import EnvironmentArguments
from mjforage.learning.environments.single import METADATA, SingleEnvironment, summed
from mjforage.learning.environments.spaces import MASK, Arrays, arrays_space, shown


class ForagingEnv(SingleEnvironment, gymnasium.Env[Arrays, NDArray[np.int64]]):
    """One decision of all agents per step.

    **Action** `MultiDiscrete([9] * agents)`: per agent 0-7 compass from north clockwise, 8 stay.
    An illegal move, or one to a node that an agent of higher index took, becomes staying put where
    that is legal, else the first legal compass move; `info["illegal"]` counts them.

    **Observation** a dict of arrays with a leading agent axis, of the kind chosen:

    | kind | array | shape per agent | dtype | range | entries |
    |---|---|---|---|---|---|
    | egocentric | `local_map` | (8, 15, 15) | float32 | [0, 1] | table of `Egocentric` |
    | | `global_map` | (7, 16, 16) | float32 | [0, 1] | likewise |
    | | `moves` | (9, 11) | float32 | [0, 1] | table of the module `moves` |
    | | `own` | (12,) | float32 | [0, 1] | table of `Egocentric` |
    | paper | `map` | (6, rows, columns) | float32 | [0, 1] | table of `PaperChannels` |
    | both | `action_mask` | (9,) | int8 | 0, 1 | 1: legal before anybody has chosen |

    The tables, with units, are in `graph_planner.encodings`. Over a link each agent's arrays show
    what it has seen and received itself.

    **Reward** the sum over agents and terms; `info["reward/<term>"]` has each weighted term's, and
    `info["episode_terms/<term>"]` their sums since the episode began; `info["agent_rewards"]`
    (agent,) is each agent's own reward.
    **End** terminated when no item is left or no agent has energy; truncated at the horizon.
    **Episode** decided by the seed of the last `reset(seed=...)` and the number of resets since.
    """

    metadata: ClassVar[dict[str, Any]] = METADATA  # type: ignore[misc]

    def __init__(self, **arguments: Unpack[EnvironmentArguments]) -> None:
        SingleEnvironment.__init__(self, arguments)
        agents = self._core.agents
        self.observation_space = arrays_space(self._core.shapes, (agents,), self._dtype)
        self.action_space = gymnasium.spaces.MultiDiscrete([9] * agents)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Arrays, dict[str, Any]]:
        """Start the next episode; with a seed, the first one of that seed."""
        checked_options(options)
        super().reset(seed=seed)
        self._start(seed, self.np_random)
        return self._observed(), self._core.fact()

    def step(self, action: NDArray[np.int64]) -> tuple[Arrays, float, bool, bool, dict[str, Any]]:
        """One decision of the fleet.

        Returns: observation, its leading axis the agents; reward summed over them; terminated;
        truncated; `info`. Raises `UserError` if the action is not of its space, or there was no
        reset.

        Parameters
        ----------
        action : (agent,) moves 0-8
        """
        moves = checked_moves(action, (self._core.agents,))
        outcome = self._play(moves)
        reward, ended, late, info = summed(outcome)
        info["agent_rewards"] = outcome.rewards[0].copy()
        return self._observed(), reward, ended, late, self._core.fact() | info

    def _observed(self) -> Arrays:
        seen: Arrays = {name: shown(level, self._dtype) for name, level in self._seen().items()}
        return {**seen, MASK: self._core.masks[0]}
