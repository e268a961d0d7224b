"""The episodes of a round side by side, in one core or in several."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.policies import create_policy
from mjforage.learning.environments.core import EnvironmentCore
from mjforage.learning.environments.several_cores import SeveralCores
from mjforage.learning.environments.tensors import on_host
from mjforage.mission.policy import Policy
from mjforage.mission.resolver import check_preferences


class Played(NamedTuple):
    """Result of one step."""

    taken: NDArray[np.int8]  # (env, agent) moves that were made
    rewards: NDArray[np.float64]  # (env, agent)
    terminated: NDArray[np.bool_]  # (env,) no item is left, or nobody can move


class Round:
    """One episode in every sub-environment (env,), up to its end as an environment has it.

    A mission goes on to the horizon when no agent can move; such decisions are no part of a round.

    Attributes
    ----------
    cores : that play them; fleets and pictures are alike
    envs : (core,) of the sub-environments (env,) that each plays
    num_envs, agents : of all cores; of each
    earned : term of the reward -> what all agents had of it, weighted, since the round's start
    """

    def __init__(self, cores: Sequence[EnvironmentCore], envs: Sequence[NDArray[np.int64]]) -> None:
        self.cores, self.envs = cores, envs
        self._all = SeveralCores(cores, envs)
        self.num_envs, self.agents = self._all.num_envs, self._all.agents
        self._teachers: list[Policy] = []
        self._nothing_yet()

    def _nothing_yet(self) -> None:
        self.earned: dict[str, float] = {}
        self._over = np.zeros(self.num_envs, np.bool_)  # (env,) terminated
        self._steps = np.zeros(self.num_envs, np.int32)

    def start(self, keys: UInt64Array) -> None:
        """Start episodes of the given keys (env,)."""
        self._teachers = []
        self._nothing_yet()
        self._all.start(np.arange(self.num_envs), keys)

    @property
    def active(self) -> NDArray[np.bool_]:
        """(env,) whether an episode goes on."""
        return self._all.active & ~self._over

    @property
    def masks(self) -> NDArray[np.int8]:
        """(env, agent, 9) 1 where a move is legal whatever the others choose."""
        masks: NDArray[np.int8] = on_host(self._all.masks)
        return masks

    def see(self, envs: NDArray[np.int64]) -> dict[str, Any]:
        """Levels (env, agent, ...) of each agent's knowledge; only `envs` are of this moment.

        They are tensors where cores are on a device, and arrays otherwise.
        """
        return self._all.see(envs)

    def play(self, preferences: NDArray[np.float64]) -> Played:
        """Play one decision by preferences (env, agent, 9).

        Raises `UserError` if they are no such array, or one of them is NaN.
        """
        check_preferences(preferences, (self.num_envs, self.agents), "algorithm", "play was given")
        played = self.active
        outcome = self._all.play(preferences)
        for name, amounts in outcome.terms.items():
            amount = (amounts * played[:, None]).sum()
            self.earned[name] = self.earned.get(name, 0.0) + float(amount)
        terminated = outcome.terminated & played
        self._over |= terminated
        self._steps += played
        return Played(outcome.taken, outcome.rewards * played[:, None], terminated)

    def teach(self, name: str) -> None:
        """Have a policy ready that shows moves in the episodes that were started."""
        self._teachers = [create_policy(name) for _ in self.cores]
        for core, teacher in zip(self.cores, self._teachers, strict=True):
            core.mission.prepare(teacher)

    def demonstrated(self) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
        """The teacher's preferences (env, agent, 9), and the moves that it would make or likes as
        much.
        """
        self._all.come_back()
        theirs: NDArray[np.float64] = self._all.joined(
            core.mission.ask(teacher)
            for core, teacher in zip(self.cores, self._teachers, strict=True)
        )
        moves: NDArray[np.int8] = self._all.joined(
            core.mission.decide(theirs[envs]).direction
            for core, envs in zip(self.cores, self.envs, strict=True)
        )
        own = np.take_along_axis(theirs, moves[..., None].astype(np.int64), axis=-1)
        return theirs, theirs >= own

    @property
    def collected(self) -> float:
        """Share of all items that have been collected."""
        self._all.come_back(maps=False)
        total = sum(int(core.n_items.sum()) for core in self.cores)
        found = (core.mission.ledger.t_collected >= 0 for core in self.cores)
        return sum(int(each.sum()) for each in found) / total

    @property
    def steps(self) -> NDArray[np.int32]:
        """(env,) decisions made."""
        return self._steps
