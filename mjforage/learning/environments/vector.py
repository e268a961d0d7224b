"""`gymnasium.make_vec("mjforage/Foraging-v0")`: episodes side by side in one batched mission."""

from collections.abc import Iterable, Sequence
from numbers import Integral
from typing import Any, ClassVar, TypeVar, Unpack, cast

import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from mjforage.learning.environments.checks import (
    check_count,
    checked_mode,
    checked_moves,
    checked_options,
    checked_started,
    chosen_envs,
    env_seeds,
)
from mjforage.learning.environments.core import EnvironmentCore, Episodes
from mjforage.learning.environments.cores import create_core, create_cores
from mjforage.learning.environments.episode_figure import EpisodeFigure
from mjforage.learning.environments.options import EnvironmentArguments, EnvironmentOptions
from mjforage.learning.environments.single import METADATA
from mjforage.learning.environments.spaces import MASK, Arrays, arrays_space, shown, values
from mjforage.learning.environments.tensors import Tensors, on_host, with_device

T = TypeVar("T")


class ForagingVectorEnv(VectorEnv[Arrays, NDArray[np.int64], NDArray[Any]]):
    """A batch of `ForagingEnv`: number i is to the bit the environment seeded with `seed + i`.

    One batched mission plays all sub-environments, in every world; of several maps, one for each.
    Then number i is on map i modulo their number.
    `info` is laid out as Gymnasium does: beside each key a mask `_key` (env,) of valid entries.

    Parameters
    ----------
    num_envs : sub-environments
    autoreset_mode : `NEXT_STEP` (Gymnasium's default: the step after the end ignores its action
        and returns the new episode's first observation, with reward 0), `SAME_STEP` (the new first
        observation comes at once; the last of the old episode is `info["final_obs"][i]`), or
        `DISABLED` (nothing starts again but by `reset(options={"reset_mask": chosen})`)
    copy : True if every observation is in memory of its own; otherwise the next `step` or `reset`
        may overwrite it, which is quicker; on a device it always is
    threads : on which hulls move, at most one for each sub-environment; results do not depend on
        it, and the graph world has one
    device : engine of the hulls, `physics.device` ("cuda", "warp-cpu"); all that is given is then
        tensors of torch there, actions may be, and `final_obs` and `final_info` have rows for all
    """

    metadata: ClassVar[dict[str, Any]] = METADATA  # type: ignore[misc]

    def __init__(
        self,
        num_envs: int = 1,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        copy: bool = True,
        threads: int = 1,
        device: str | None = None,
        **arguments: Unpack[EnvironmentArguments],
    ) -> None:
        check_count(num_envs, "num_envs")
        check_count(threads, "threads")
        self._tensors = None
        if device is not None:
            self._tensors = Tensors(device, arguments.get("world", EnvironmentOptions.world))
            arguments["set"] = with_device(arguments.get("set", ()), device)
        maps = EnvironmentOptions.of_maps(arguments, num_envs)
        options = maps[0]
        self.num_envs, self.render_mode = num_envs, options.render_mode
        self.autoreset_mode = checked_mode(autoreset_mode)
        self.metadata = {**type(self).metadata, "autoreset_mode": self.autoreset_mode}  # type: ignore[misc]
        create = EnvironmentCore if device is None else create_core
        self._core = create_cores(create, maps, num_envs, threads)
        self._episodes = [Episodes() for _ in range(num_envs)]
        self._ended = np.zeros(num_envs, np.bool_)
        self._rows = np.arange(num_envs)
        places = [self._core.of(env)[1] for env in range(num_envs) if self.render_mode]
        self._figures = [EpisodeFigure(env) for env in places]
        agents, shapes = self._core.agents, self._core.shapes
        self._dtype, self._copy = options.dtype, copy
        self._values: dict[str, NDArray[np.float32]] = {}  # of the last observation, to be reused
        self.single_observation_space = arrays_space(shapes, (agents,), options.dtype)
        self.single_action_space = spaces.MultiDiscrete([9] * agents)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Arrays, dict[str, Any]]:
        """Start the next episode of all sub-environments, or of some.

        Raises `UserError` if a seed or the mask is not one, or the first reset leaves some out.

        Parameters
        ----------
        seed : of the first, the others take the integers after it; or one for each
        options : `reset_mask`, (env,) booleans: which to start; absent: all
        """
        given = checked_options(options, ("reset_mask",))
        seeds = env_seeds(seed, self.num_envs)
        envs = chosen_envs(on_host(given.get("reset_mask")), self.num_envs, self._core.started)
        super().reset(seed=seeds[0] if isinstance(seed, Integral) else None)
        self._start(envs, seeds)
        started = np.zeros(self.num_envs, np.bool_)
        started[envs] = True
        return self._given((self._observed(), self._laid_out(self._core.facts(), started)))

    def _given(self, result: T) -> T:
        """The same for the user, on a device as tensors."""
        return result if self._tensors is None else cast(T, self._tensors.of(result))

    def step(
        self, actions: NDArray[np.int64]
    ) -> tuple[Arrays, NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """One decision of every fleet.

        Returns: observations, their leading axes env and agent; rewards (env,), summed over agents;
        terminated and truncated (env,); what `info` has, each (env,) beside its mask,
        `agent_rewards` (env, agent). Raises
        `UserError` if an action is not of its space, or there was no reset.

        Parameters
        ----------
        actions : (env, agent) moves 0-8
        """
        moves = checked_moves(on_host(actions), (self.num_envs, self._core.agents), "actions")
        again = self._ended.copy() if self.autoreset_mode is AutoresetMode.NEXT_STEP else None
        outcome = self._core.step(moves)
        rewards = np.add.reduce(outcome.rewards, axis=1)
        terminated, truncated = outcome.terminated, outcome.truncated
        played: dict[str, NDArray[Any]] = {
            "illegal": outcome.illegal,
            "agent_rewards": outcome.rewards,
        }
        for name, term in outcome.terms.items():
            played[f"reward/{name}"] = np.add.reduce(term, axis=1)
            played[f"episode_terms/{name}"] = np.add.reduce(outcome.sums[name], axis=1)
        over = terminated | truncated
        self._ended |= over
        if again is not None and again.any():
            self._start(np.flatnonzero(again), [None] * self.num_envs)
        else:
            again = None
        self._picture(range(self.num_envs))
        info: dict[str, Any] = {}
        if self.autoreset_mode is AutoresetMode.SAME_STEP and over.any():
            info = {"final_obs": self._last_seen(over), "_final_obs": over.copy()}
            info["final_info"] = self._laid_out(self._core.facts() | played, over)
            info["_final_info"] = over.copy()
            self._start(np.flatnonzero(over), [None] * self.num_envs)
            again = over
        if again is None:
            info |= self._laid_out(self._core.facts() | played)
        else:
            info |= self._laid_out(self._core.facts()) | self._laid_out(played, ~again)
        return self._given((self._observed(), rewards, terminated, truncated, info))

    def render(self) -> tuple[Any, ...] | None:
        """A picture (height, width, 3) uint8 of each, or None without a render mode."""
        if not self.render_mode:
            return None
        checked_started(self._core.started, "render")
        each = enumerate(zip(self._figures, self._episodes, strict=True))
        return tuple(figure.draw(self._core.of(i)[0], episodes) for i, (figure, episodes) in each)

    def _start(self, envs: NDArray[np.intp], seeds: list[int | None]) -> None:
        keys = [self._episodes[i].following(seeds[i], self.np_random) for i in envs]
        if envs.size:
            self._core.start(envs.astype(np.int64), np.concatenate(keys))
        self._ended[envs] = False
        self._picture(envs.tolist())

    def _picture(self, envs: Iterable[int]) -> None:
        """Take note of the state of some, if they are drawn."""
        for env in envs if self._figures else ():
            self._figures[env].see(self._core.of(env)[0].mission)

    def _observed(self) -> Arrays:
        """Observations of all sub-environments; in new memory if the user wants it."""
        levels = self._core.see(self._rows)
        if self._tensors is not None:
            return self._tensors.shown(levels, self._core.masks, self._dtype)
        seen = {name: self._shown(name, level) for name, level in levels.items()}
        return {**seen, MASK: self._core.masks}

    def _last_seen(self, over: NDArray[np.bool_]) -> NDArray[np.object_] | Arrays:
        """(env,) observations of those that are over, each for itself; None of others.

        On a device those of all, as `_observed`.
        """
        if self._tensors is not None:
            return self._observed()
        levels, masks = self._core.see(self._rows), self._core.masks
        last = np.full(self.num_envs, None, np.object_)
        for i in np.flatnonzero(over):
            seen = {name: shown(level[i], self._dtype) for name, level in levels.items()}
            last[i] = {**seen, MASK: masks[i].copy()}
        return last

    def _shown(self, name: str, levels: NDArray[np.uint8]) -> NDArray[Any]:
        if self._copy:
            return shown(levels, self._dtype)
        if self._dtype == "uint8":
            return levels
        if name not in self._values:
            self._values[name] = np.empty(levels.shape, np.float32)
        return values(levels, self._values[name])

    def _laid_out(
        self, facts: dict[str, NDArray[Any]], valid: NDArray[np.bool_] | None = None
    ) -> dict[str, Any]:
        """Facts (env,) beside their masks, by default all True; 0 where False."""
        if valid is None:
            valid = np.ones(self.num_envs, np.bool_)
        elif valid.any():
            facts = {name: (fact.T * valid).T for name, fact in facts.items()}
        else:
            return {}
        info: dict[str, Any] = {}
        for name, fact in facts.items():
            info[name], info["_" + name] = fact, valid.copy()
        return info
