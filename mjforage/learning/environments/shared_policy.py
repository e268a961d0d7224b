"""`mjforage/SharedPolicy-v0`: one agent at a time, through a policy that all share."""

from typing import Any, ClassVar, Unpack

import gymnasium
import numpy as np
from numpy.typing import NDArray

from mjforage.graph_planner.encodings.masks import legal_of_agent
from mjforage.graph_planner.graph.navigation import STAY
from mjforage.learning.environments.checks import checked_moves, checked_options, checked_started
from mjforage.learning.environments.options import EnvironmentArguments
from mjforage.learning.environments.single import METADATA, SingleEnvironment, summed
from mjforage.learning.environments.spaces import MASK, Arrays, arrays_space, shown
from mjforage.mission.moves import preferences_of


class SharedPolicyEnv(SingleEnvironment, gymnasium.Env[Arrays, np.int64]):
    """One decision of one agent per step; when all have decided, the mission moves on.

    Agents decide in the mission's order (`rules.order`), so `action_mask` also leaves out what
    those before this one took: a node that both can get to, so they are within the sum of their
    moves, where hulls see each other whatever the link. The fleet's reward comes with the last
    agent's decision of a round and is 0 before; so over an ideal link it is one sequential decision
    process, and values of following observations are values of the same fleet.

    **Action** `Discrete(9)`: 0-7 compass from north clockwise, 8 stay; an illegal one becomes
    staying put where that is legal, else the first legal compass move.
    **Observation** one agent's arrays of `Foraging-v0` without the agent axis; `info["agent"]` is
    whose. `action_masks()` gives the mask for libraries that ask for it.
    **Reward, end, episode** as in `Foraging-v0`.
    """

    metadata: ClassVar[dict[str, Any]] = METADATA  # type: ignore[misc]

    def __init__(self, **arguments: Unpack[EnvironmentArguments]) -> None:
        SingleEnvironment.__init__(self, arguments, by_turns=True)
        self._claimed = np.zeros(len(self._core.setup.graph), np.int64)
        self._round = 0
        self.observation_space = arrays_space(self._core.shapes, (), self._dtype)
        self.action_space = gymnasium.spaces.Discrete(9)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Arrays, dict[str, Any]]:
        """Start the next episode; with a seed, the first one of that seed."""
        checked_options(options)
        super().reset(seed=seed)
        self._start(seed, self.np_random)
        self._begin_round()
        return self._observed(), self._info()

    def step(self, action: np.int64) -> tuple[Arrays, float, bool, bool, dict[str, Any]]:
        """One agent's decision; the fleet moves, and a reward other than 0 comes, after the last.

        Returns: observation of the next agent, reward summed over all, terminated, truncated,
        `info`. Raises `UserError` if the action is not of its space, or there was no reset.

        Parameters
        ----------
        action : move 0-8 of the agent whose turn it is
        """
        checked_started(self._core.started, "step")
        self._choose(int(checked_moves(action, ())))
        if self._waiting:
            self._turn = self._waiting.pop()
            return self._observed(), 0.0, False, False, self._info()
        reward, ended, late, info = summed(self._play(self._actions))
        self._begin_round()
        return self._observed(), reward, ended, late, self._info() | info

    def action_masks(self) -> NDArray[np.bool_]:
        """(9,) legal moves of the agent whose turn it is."""
        checked_started(self._core.started, "action_masks")
        seen, agent = self._core.mission.observation, self._turn
        return legal_of_agent(
            self._core.setup.task.arrays,
            self._claimed,
            self._round,
            agent,
            seen.agent_node[0, agent],
            seen.energy_left[0, agent],
        )

    def _begin_round(self) -> None:
        self._round += 1
        self._waiting = self._core.setup.fleet.order[::-1].tolist()
        self._turn = self._waiting.pop()
        self._actions = np.full(self._core.agents, STAY, np.int64)
        self._levels = self._seen()

    def _choose(self, action: int) -> None:
        """Take note of a decision and of the node that it claims."""
        self._actions[self._turn] = action
        wanted = preferences_of(self._actions[None])
        target = self._core.mission.decide(wanted).target[0, self._turn]
        self._claimed[target] = self._round

    def _info(self) -> dict[str, Any]:
        return {"agent": self._turn, **self._core.fact()}

    def _observed(self) -> Arrays:
        turn, dtype = self._turn, self._dtype
        seen: Arrays = {name: shown(level[turn], dtype) for name, level in self._levels.items()}
        return {**seen, MASK: self.action_masks().astype(np.int8)}
