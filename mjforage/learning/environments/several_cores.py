"""Sub-environments of several cores, such as one for each map, in the place of a core."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import UInt64Array
from mjforage.learning.environments.checks import checked_started
from mjforage.learning.environments.core import EnvironmentCore, Outcome
from mjforage.learning.environments.tensors import on_host
from mjforage.mission.moves import preferences_of


class SeveralCores:
    """Sub-environments (env,) that cores share among them; see `EnvironmentCore`.

    On a device what agents see is tensors, if all cores are there.

    Attributes
    ----------
    cores : that play them; fleets and pictures are alike
    envs : (core,) of the sub-environments (env,) that each plays
    num_envs, agents : of all cores; of each
    """

    def __init__(self, cores: Sequence[EnvironmentCore], envs: Sequence[NDArray[np.int64]]) -> None:
        self.cores, self.envs = cores, envs
        self.num_envs = sum(each.size for each in envs)
        self.agents, self.shapes = cores[0].agents, cores[0].shapes
        self._levels: dict[str, Any] = {}

    @property
    def started(self) -> bool:
        """True once there are episodes."""
        return all(core.started for core in self.cores)

    def of(self, env: int) -> tuple[EnvironmentCore, int]:
        """The core that plays a sub-environment, and its number there."""
        for core, own in zip(self.cores, self.envs, strict=True):
            if found := np.flatnonzero(own == env).tolist():
                return core, found[0]
        raise IndexError(f"sub-environment {env} of {self.num_envs}")

    def start(self, envs: NDArray[np.int64], keys: UInt64Array) -> None:
        """Start episodes of the given keys in sub-environments (env,); the first time in all."""
        place = np.zeros(self.num_envs, np.int64)
        place[envs] = np.arange(envs.size)
        for core, own, rows in self._among(envs):
            core.start(rows, keys[place[own]])

    def _among(
        self, envs: NDArray[np.int64]
    ) -> Iterator[tuple[EnvironmentCore, NDArray[np.int64], NDArray[np.int64]]]:
        """Cores that play some of `envs`, with these, and their numbers there."""
        for core, own in zip(self.cores, self.envs, strict=True):
            rows = np.flatnonzero(np.isin(own, envs))
            if rows.size:
                yield core, own[rows], rows

    def step(self, actions: NDArray[np.int64]) -> Outcome:
        """Play one decision by moves (env, agent); raises as `EnvironmentCore.step`."""
        checked_started(self.started, "step")
        return self.play(preferences_of(actions), actions)

    def play(
        self, preferences: NDArray[np.float64], wanted: NDArray[np.int64] | None = None
    ) -> Outcome:
        """Play one decision by preferences (env, agent, 9), see `EnvironmentCore.play`."""
        each = [
            core.play(preferences[own], None if wanted is None else wanted[own])
            for core, own in zip(self.cores, self.envs, strict=True)
        ]
        return Outcome(*(self._all([getattr(one, part.name) for one in each]) for part in PARTS))

    def _all(self, parts: Sequence[Any]) -> Any:
        """`joined`, of mappings too."""
        if isinstance(parts[0], dict):
            return {name: self.joined(part[name] for part in parts) for name in parts[0]}
        return self.joined(parts)

    def joined(self, parts: Iterable[Any]) -> Any:
        """(env, ...) of what each core has for its own; that of a single core as it is."""
        arrays = list(parts)
        if len(arrays) == 1:
            return arrays[0]
        joined, arrays = self._room(arrays[0]), self._alike(arrays)
        for array, own in zip(arrays, self.envs, strict=True):
            joined[own] = array
        return joined

    @property
    def _on_device(self) -> bool:
        return all(core.on_device for core in self.cores)

    def _alike(self, parts: list[Any]) -> list[Any]:
        """Tensors if all cores have them, arrays otherwise."""
        return parts if self._on_device else [on_host(part) for part in parts]

    def _room(self, like: Any) -> Any:
        """An array (env, ...) or tensor for what is like that of one core."""
        shape = self.num_envs, *like.shape[1:]
        if self._on_device and hasattr(like, "new_zeros"):
            return like.new_zeros(shape)
        return np.zeros(shape, on_host(like).dtype)

    @property
    def active(self) -> NDArray[np.bool_]:
        """(env,) whether an episode goes on, as the mission has it."""
        found: NDArray[np.bool_] = self.joined(core.mission.active for core in self.cores)
        return found

    @property
    def masks(self) -> Any:
        """(env, agent, 9) int8, 1 where a move is legal whatever the others choose."""
        return self.joined(core.masks for core in self.cores)

    def see(self, envs: NDArray[np.int64]) -> dict[str, Any]:
        """Levels (env, agent, ...) of the observation; live, only `envs` are of this moment."""
        if len(self.cores) == 1:
            return self.cores[0].see(envs)
        for core, own, rows in self._among(envs):
            for name, level in core.see(rows).items():
                if name not in self._levels:
                    self._levels[name] = self._room(level)
                (part,) = self._alike([level[rows]])
                self._levels[name][own] = part
        return self._levels

    def facts(self) -> dict[str, NDArray[Any]]:
        """Steps made, and shares of items discovered and removed so far [%], each (env,)."""
        found: dict[str, NDArray[Any]] = self._all([core.facts() for core in self.cores])
        return found

    def come_back(self, maps: bool = True) -> None:
        """Have all missions know all, see `EnvironmentCore.come_back`."""
        for core in self.cores:
            core.come_back(maps)


PARTS = fields(Outcome)
