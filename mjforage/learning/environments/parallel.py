"""The PettingZoo view: every agent for itself, all at once."""

from functools import cached_property
from typing import Any, ClassVar, Unpack

import gymnasium
import numpy as np
from numpy.typing import NDArray
from pettingzoo import ParallelEnv

from mjforage.base.errors import UserError
from mjforage.graph_planner.graph.navigation import STAY
from mjforage.learning.environments.checks import checked_moves, checked_options, checked_started
from mjforage.learning.environments.options import EnvironmentArguments
from mjforage.learning.environments.single import METADATA, SingleEnvironment
from mjforage.learning.environments.spaces import MASK, Arrays, arrays_space, shown
from mjforage.learning.environments.state import StateArray, state_of, state_space


class ForagingParallelEnv(SingleEnvironment, ParallelEnv[str, Arrays, int]):  # type: ignore[misc]
    """Agents `scouts_0`, `foragers_0`, ... decide at once; `rules.order` decides conflicts.

    **Action** `Discrete(9)`, **observation** and masks per agent as in `mjforage/SharedPolicy-v0`,
    except that a mask cannot know what others choose at the same time. Over a link an agent sees
    what it has seen and received itself: a decentralised partially observable decision process
    (Oliehoek and Amato, *A Concise Introduction to Decentralized POMDPs*, 2016). Infos have the
    same keys at every step; but for `step` they are of the true state of the whole fleet, and are
    not for agents. **State** `state()`, for central critics: the table of `state_of`.
    **Reward** each agent's own terms. **End** all are terminated when no item is left, one when it
    can never move again, see `Task.exhausted` (it then stays where it is, and still sees); all are
    truncated at the horizon.
    """

    metadata: ClassVar[dict[str, Any]] = {
        "name": "mjforage_v0",
        "is_parallelizable": True,
        **METADATA,
    }

    def __init__(self, **arguments: Unpack[EnvironmentArguments]) -> None:
        SingleEnvironment.__init__(self, arguments)
        self._entropy = np.random.default_rng()
        self.possible_agents = list(self._core.setup.fleet.names)
        self.agents: list[str] = []
        self.state_space = state_space(self._core.setup)

    @cached_property
    def _spaces(
        self,
    ) -> dict[str, tuple[gymnasium.spaces.Space[Arrays], gymnasium.spaces.Discrete]]:
        shapes = self._core.shapes
        return {
            agent: (arrays_space(shapes, (), self._dtype), gymnasium.spaces.Discrete(9))
            for agent in self.possible_agents
        }

    def observation_space(self, agent: str) -> gymnasium.spaces.Space[Arrays]:
        """Space of an agent's observations, always the same object."""
        return self._spaces[agent][0]

    def action_space(self, agent: str) -> gymnasium.spaces.Discrete:
        """Space of an agent's actions, always the same object."""
        return self._spaces[agent][1]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Arrays], dict[str, dict[str, Any]]]:
        """Start the next episode; with a seed, the first one of that seed."""
        checked_options(options)
        self._start(seed, self._entropy)
        self.agents = list(self.possible_agents)
        return self._observed(self.agents)

    def step(
        self, actions: dict[str, int]
    ) -> tuple[
        dict[str, Arrays],
        dict[str, float],
        dict[str, bool],
        dict[str, bool],
        dict[str, dict[str, Any]],
    ]:
        """One decision of all agents that are not over; actions of those that are do not count.

        Raises `UserError` if an agent has no action, is not known, or its action is not of its
        space.
        """
        outcome = self._play(self._chosen(actions))
        present = self.agents
        index = {agent: i for i, agent in enumerate(self.possible_agents)}
        ended, late = bool(outcome.terminated[0]), bool(outcome.truncated[0])
        observations, infos = self._observed(present)
        rewards = {a: float(outcome.rewards[0, index[a]]) for a in present}
        terminated = {a: ended or bool(outcome.exhausted[0, index[a]]) for a in present}
        truncated = dict.fromkeys(present, late)
        for a in present:
            for name, term in outcome.terms.items():
                infos[a][f"reward/{name}"] = float(term[0, index[a]])
                infos[a][f"episode_terms/{name}"] = float(outcome.sums[name][0, index[a]])
        self.agents = [a for a in present if not (terminated[a] or truncated[a])]
        return observations, rewards, terminated, truncated, infos

    def state(self) -> StateArray:
        """Pooled map of the fleet, and the truth: (channel, row, column), see `state_of`."""
        checked_started(self._core.started, "state")
        return state_of(self._core.mission)

    def _chosen(self, actions: dict[str, int]) -> NDArray[np.int64]:
        """(agent,) moves; agents that are over stay."""
        checked_started(self._core.started, "step")
        names = ", ".join(self.possible_agents)
        for agent in actions:
            if agent not in self.possible_agents:
                raise UserError(f"action of {agent}: there is no such agent; choose {names}")
        moves = np.full(len(self.possible_agents), STAY)
        for i, agent in enumerate(self.possible_agents):
            if agent in self.agents:
                if agent not in actions:
                    raise UserError(
                        f"action of {agent}: is missing; give one to each of env.agents"
                    )
                moves[i] = checked_moves(actions[agent], (), f"action of {agent}")
        return moves

    def _observed(self, agents: list[str]) -> tuple[dict[str, Arrays], dict[str, dict[str, Any]]]:
        levels, masks, facts = self._seen(), self._core.masks[0], self._core.fact()
        observations: dict[str, Arrays] = {}
        infos: dict[str, dict[str, Any]] = {}
        weights, kinds = self._core.options.weights, ("reward", "episode_terms")
        nothing = {f"{kind}/{name}": 0.0 for kind in kinds for name in weights}
        for i, agent in enumerate(self.possible_agents):
            if agent in agents:
                seen: Arrays = {n: shown(level[i], self._dtype) for n, level in levels.items()}
                observations[agent] = {**seen, MASK: masks[i].copy()}
                infos[agent] = {**nothing, **facts}
        return observations, infos
