"""`gymnasium.make_vec("mjforage/Foraging-v0")`: episodes side by side in one batched mission."""

import reprlib
from collections.abc import Sequence
from numbers import Integral
from typing import Any, ClassVar, Unpack

import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.learning.environments.checks import (
    checked_moves,
    checked_options,
    checked_seed,
    checked_started,
)
from mjforage.learning.environments.copies import Copied
from mjforage.learning.environments.core import EnvironmentCore, Episodes, Outcome
from mjforage.learning.environments.episode_figure import EpisodeFigure
from mjforage.learning.environments.options import EnvironmentArguments, EnvironmentOptions
from mjforage.learning.environments.screen import check_mode
from mjforage.learning.environments.single import METADATA
from mjforage.learning.environments.spaces import (
    MASK,
    Arrays,
    arrays_space,
    shown,
    values,
)

MODES = ["rgb_array"]


class ForagingVectorEnv(Copied, VectorEnv[Arrays, NDArray[np.int64], NDArray[Any]]):
    """A batch of `ForagingEnv`: number i is to the bit the environment seeded with `seed + i`.

    In the graph world one batched mission plays all sub-environments; elsewhere each has its own.
    `info` is laid out as Gymnasium does: beside each key a mask `_key` (env,) of valid entries.

    Parameters
    ----------
    num_envs : sub-environments
    autoreset_mode : `NEXT_STEP` (Gymnasium's default: the step after the end ignores its action
        and returns the new episode's first observation, with reward 0), `SAME_STEP` (the new first
        observation comes at once; the last of the old episode is `info["final_obs"][i]`), or
        `DISABLED` (nothing starts again but by `reset(options={"reset_mask": chosen})`)
    copy : True if every observation is in memory of its own; otherwise the next `step` or `reset`
        may overwrite it, which is quicker
    """

    metadata: ClassVar[dict[str, Any]] = METADATA | {"render_modes": MODES}  # type: ignore[misc]

    def __init__(
        self,
        num_envs: int = 1,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        copy: bool = True,
        **arguments: Unpack[EnvironmentArguments],
    ) -> None:
        if num_envs < 1:
            raise UserError(f"num_envs = {num_envs}: give 1 or more")
        options = EnvironmentOptions.of(arguments)
        check_mode(options.render_mode, MODES)
        self.num_envs, self.render_mode = num_envs, options.render_mode
        self.autoreset_mode = _checked_mode(autoreset_mode)
        self.metadata = {**type(self).metadata, "autoreset_mode": self.autoreset_mode}  # type: ignore[misc]
        batched = options.world == "graph"
        sizes = [num_envs] if batched else [1] * num_envs
        self._cores = [EnvironmentCore(options, size) for size in sizes]
        self._where = [(0, i) if batched else (i, 0) for i in range(num_envs)]
        self._episodes = [Episodes() for _ in range(num_envs)]
        self._ended, self._everybody = np.zeros(num_envs, np.bool_), np.ones(num_envs, np.bool_)
        self._rows = [np.arange(core.num_envs) for core in self._cores]
        shown = self._where if self.render_mode else []
        self._figures = [EpisodeFigure(env, options.camera) for _, env in shown]
        agents, shapes = self._cores[0].agents, self._cores[0].shapes
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
        told = checked_options(options, ("reset_mask",))
        seeds, envs = self._seeds(seed), self._chosen(told.get("reset_mask"))
        super().reset(seed=seeds[0] if isinstance(seed, Integral) else None)
        self._start(envs, seeds)
        started = np.zeros(self.num_envs, np.bool_)
        started[envs] = True
        return self._observed(), self._laid_out(self._facts(), started)

    def _seeds(self, seed: object) -> list[int | None]:
        """A seed for each sub-environment."""
        if seed is None:
            return [None] * self.num_envs
        if isinstance(seed, Integral):
            return [checked_seed(int(seed) + i) for i in range(self.num_envs)]
        if not isinstance(seed, Sequence | np.ndarray) or len(seed) != self.num_envs:
            words = f"give one whole number, or {self.num_envs} of them"
            raise UserError(f"seed = {reprlib.repr(seed)}: {words}")
        return [checked_seed(each, f"seed[{i}]") for i, each in enumerate(seed)]

    def _chosen(self, mask: object) -> NDArray[np.intp]:
        """Numbers of the sub-environments that a mask names."""
        if mask is None:
            return np.arange(self.num_envs)
        chosen = np.asarray(mask)
        if chosen.shape != (self.num_envs,) or chosen.dtype != np.bool_ or not chosen.any():
            words = f"give {self.num_envs} booleans, at least one of them True"
            raise UserError(f"reset_mask = {reprlib.repr(mask)}: {words}")
        if not chosen.all():
            checked_started(self._cores[0].started, "reset of some sub-environments")
        return np.flatnonzero(chosen)

    def step(
        self, actions: NDArray[np.int64]
    ) -> tuple[Arrays, NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """One decision of every fleet.

        Returns: observations, their leading axes env and agent; rewards (env,), summed over agents;
        terminated and truncated (env,); what `info` has, each (env,) beside its mask. Raises
        `UserError` if an action is not of its space, or there was no reset.

        Parameters
        ----------
        actions : (env, agent) moves 0-8
        """
        moves = checked_moves(actions, (self.num_envs, self._cores[0].agents), "actions")
        again = self._ended.copy() if self.autoreset_mode is AutoresetMode.NEXT_STEP else None
        parts = self._play(moves)
        rewards = _joined([np.add.reduce(part.rewards, axis=1) for part in parts])
        terminated = _joined([part.terminated for part in parts])
        truncated = _joined([part.truncated for part in parts])
        played = {"illegal": _joined([part.illegal for part in parts])}
        for name in parts[0].terms:
            term = [np.add.reduce(part.terms[name], axis=1) for part in parts]
            played[f"reward/{name}"] = _joined(term)
        over = terminated | truncated
        self._ended |= over
        if again is not None and again.any():
            self._start(np.flatnonzero(again), [None] * self.num_envs)
        else:
            again = None
        for picture, (core, _) in zip(self._figures, self._where, strict=False):
            picture.see(self._cores[core].mission)
        info: dict[str, Any] = {}
        if self.autoreset_mode is AutoresetMode.SAME_STEP and over.any():
            info = {"final_obs": self._last_seen(over), "_final_obs": over.copy()}
            info["final_info"] = self._laid_out(self._facts() | played, over)
            info["_final_info"] = over.copy()
            self._start(np.flatnonzero(over), [None] * self.num_envs)
            again = over
        if again is None:
            info |= self._laid_out(self._facts() | played)
        else:
            info |= self._laid_out(self._facts()) | self._laid_out(played, ~again)
        return self._observed(), rewards, terminated, truncated, info

    def render(self) -> tuple[Any, ...] | None:
        """A picture (height, width, 3) uint8 of each, or None without a render mode."""
        if not self.render_mode:
            return None
        checked_started(self._cores[0].started, "render")
        each = zip(self._figures, self._where, self._episodes, strict=True)
        return tuple(
            picture.draw(self._cores[core], episodes) for picture, (core, _), episodes in each
        )

    def close_extras(self, **_: Any) -> None:
        """Give OpenGL back."""
        for picture in self._figures:
            picture.close()

    def _play(self, actions: NDArray[np.int64]) -> list[Outcome]:
        if len(self._cores) == 1:
            return [self._cores[0].step(actions)]
        return [core.step(actions[i : i + 1]) for i, core in enumerate(self._cores)]

    def _start(self, envs: NDArray[np.intp], seeds: list[int | None]) -> None:
        keys = [self._episodes[i].following(seeds[i], self.np_random) for i in envs]
        if len(self._cores) == 1 and envs.size:
            self._cores[0].start(envs.astype(np.int64), np.concatenate(keys))
        elif envs.size:
            for i, key in zip(envs, keys, strict=True):
                self._cores[i].start(np.zeros(1, np.int64), key)
        self._ended[envs] = False
        for i in envs:
            if self._figures:
                self._figures[i].see(self._cores[self._where[i][0]].mission)

    def _observed(self) -> Arrays:
        """Observations of all sub-environments; in new memory if the user wants it."""
        seen = {name: self._shown(name, levels) for name, levels in self._levels().items()}
        return {**seen, MASK: _joined([core.masks for core in self._cores])}

    def _last_seen(self, over: NDArray[np.bool_]) -> NDArray[np.object_]:
        """(env,) observations of those that are over, each for itself; None of others."""
        levels, masks = self._levels(), _joined([core.masks for core in self._cores])
        last = np.full(self.num_envs, None, np.object_)
        for i in np.flatnonzero(over):
            seen = {name: shown(level[i], self._dtype) for name, level in levels.items()}
            last[i] = {**seen, MASK: masks[i].copy()}
        return last

    def _levels(self) -> dict[str, NDArray[np.uint8]]:
        """Levels (env, agent, ...) that all see."""
        parts = [core.see(rows) for core, rows in zip(self._cores, self._rows, strict=True)]
        return {name: _joined([part[name] for part in parts]) for name in parts[0]}

    def _shown(self, name: str, levels: NDArray[np.uint8]) -> NDArray[Any]:
        if self._copy:
            return shown(levels, self._dtype)
        if self._dtype == "uint8":
            return levels
        if name not in self._values:
            self._values[name] = np.empty(levels.shape, np.float32)
        return values(levels, self._values[name])

    def _facts(self) -> dict[str, Any]:
        facts = [core.facts() for core in self._cores]
        if len(facts) == 1:
            return facts[0]
        return {name: _joined([fact[name] for fact in facts]) for name in facts[0]}

    def _laid_out(
        self, facts: dict[str, NDArray[Any]], told: NDArray[np.bool_] | None = None
    ) -> dict[str, Any]:
        """Facts (env,) beside their masks, by default all True; 0 where False."""
        if told is None:
            told = self._everybody
        elif told.any():
            facts = {name: fact * told for name, fact in facts.items()}
        else:
            return {}
        info: dict[str, Any] = {}
        for name, fact in facts.items():
            info[name], info["_" + name] = fact, told.copy()
        return info


def _joined(parts: list[NDArray[Any]]) -> NDArray[Any]:
    """Arrays of all cores, one after the other; that of a single core as it is."""
    return parts[0] if len(parts) == 1 else np.concatenate(parts)


def _checked_mode(mode: object) -> AutoresetMode:
    try:
        return AutoresetMode(mode)
    except ValueError as error:
        names = ", ".join(each.value for each in AutoresetMode)
        raise UserError(f"autoreset_mode = {mode!r}: unknown; choose {names}") from error
