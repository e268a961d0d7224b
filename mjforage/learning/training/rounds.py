"""The episodes of a round side by side, in one core or in several."""

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.policies import create_policy
from mjforage.learning.environments.core import EnvironmentCore
from mjforage.learning.environments.tensors import on_host
from mjforage.mission.policy import Policy
from mjforage.mission.resolver import check_preferences

_Kind = TypeVar("_Kind", bound=np.generic)


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
        self.num_envs, self.agents = sum(each.size for each in envs), cores[0].agents
        each = (self.num_envs, self.agents)
        self._levels = {n: np.zeros((*each, *s), np.uint8) for n, s in cores[0].shapes.items()}
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
        for core, envs in zip(self.cores, self.envs, strict=True):
            core.start(np.arange(envs.size), keys[envs])

    @property
    def active(self) -> NDArray[np.bool_]:
        """(env,) whether an episode goes on."""
        return self._joined(core.mission.active for core in self.cores) & ~self._over

    @property
    def masks(self) -> NDArray[np.int8]:
        """(env, agent, 9) 1 where a move is legal whatever the others choose."""
        return self._joined(on_host(core.masks) for core in self.cores)

    def see(self, envs: NDArray[np.int64]) -> dict[str, Any]:
        """Levels (env, agent, ...) of each agent's knowledge; only `envs` are of this moment.

        They are tensors where a single core has them on a device, and arrays otherwise.
        """
        if len(self.cores) == 1:
            return self.cores[0].see(envs)
        for core, own in zip(self.cores, self.envs, strict=True):
            present = np.flatnonzero(np.isin(own, envs))
            for name, level in core.see(present).items() if present.size else ():
                self._levels[name][own[present]] = on_host(level[present])
        return self._levels

    def play(self, preferences: NDArray[np.float64]) -> Played:
        """Play one decision by preferences (env, agent, 9).

        Raises `UserError` if they are no such array, or one of them is NaN.
        """
        check_preferences(preferences, (self.num_envs, self.agents), "algorithm", "play was given")
        played = self.active
        each = [
            core.play(preferences[envs]) for core, envs in zip(self.cores, self.envs, strict=True)
        ]
        for outcome, envs in zip(each, self.envs, strict=True):
            for name, amounts in outcome.terms.items():
                amount = (amounts * played[envs, None]).sum()
                self.earned[name] = self.earned.get(name, 0.0) + float(amount)
        terminated = self._joined(outcome.terminated for outcome in each) & played
        self._over |= terminated
        self._steps += played
        rewards = self._joined(outcome.rewards for outcome in each) * played[:, None]
        return Played(self._joined(outcome.taken for outcome in each), rewards, terminated)

    def teach(self, name: str) -> None:
        """Have a policy ready that shows moves in the episodes that were started."""
        self._teachers = [create_policy(name) for _ in self.cores]
        for core, teacher in zip(self.cores, self._teachers, strict=True):
            core.mission.prepare(teacher)

    def demonstrated(self) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
        """The teacher's preferences (env, agent, 9), and the moves that it would make or likes as
        much.
        """
        for core in self.cores:
            core.come_back()
        theirs = self._joined(
            core.mission.ask(teacher)
            for core, teacher in zip(self.cores, self._teachers, strict=True)
        )
        moves = self._joined(
            core.mission.decide(theirs[envs]).direction
            for core, envs in zip(self.cores, self.envs, strict=True)
        )
        own = np.take_along_axis(theirs, moves[..., None].astype(np.int64), axis=-1)
        return theirs, theirs >= own

    @property
    def collected(self) -> float:
        """Share of all items that have been collected."""
        total = sum(int(core.n_items.sum()) for core in self.cores)
        found = (core.mission.ledger.t_collected >= 0 for core in self.cores)
        return sum(int(each.sum()) for each in found) / total

    @property
    def steps(self) -> NDArray[np.int32]:
        """(env,) decisions made."""
        return self._steps

    def _joined(self, parts: Iterable[NDArray[_Kind]]) -> NDArray[_Kind]:
        """(env, ...) of what each core has for its own; that of a single core as it is."""
        arrays = list(parts)
        if len(arrays) == 1:
            return arrays[0]
        joined = np.empty((self.num_envs, *arrays[0].shape[1:]), arrays[0].dtype)
        for array, envs in zip(arrays, self.envs, strict=True):
            joined[envs] = array
        return joined
