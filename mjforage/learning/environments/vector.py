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

from mjforage.core.errors import UserError
from mjforage.learning.environments.checks import checked_moves, checked_seed, checked_started
from mjforage.learning.environments.game import Episodes, Game, Outcome
from mjforage.learning.environments.options import EnvironmentArguments, EnvironmentOptions
from mjforage.learning.environments.pictures import Picture
from mjforage.learning.environments.screen import check_mode
from mjforage.learning.environments.single import METADATA
from mjforage.learning.environments.spaces import MASK, Pictures, picture_space, values

MODES = ["rgb_array"]


class ForagingVectorEnv(VectorEnv[Pictures, NDArray[np.int64], NDArray[Any]]):
    """A batch of `ForagingEnv`: number i is to the bit the environment seeded with `seed + i`.

    In the graph world one batched mission plays all sub-environments; elsewhere each has its own.

    Parameters
    ----------
    num_envs : sub-environments
    autoreset_mode : `NEXT_STEP` (Gymnasium's default: the step after the end ignores its action
        and returns the new episode's first observation, with reward 0), `SAME_STEP` (the new first
        observation comes at once; the last of the old episode is `info["final_obs"]`), or
        `DISABLED` (nothing starts again but by `reset(options={"reset_mask": chosen})`)
    """

    metadata: ClassVar[dict[str, Any]] = METADATA | {"render_modes": MODES}  # type: ignore[misc]

    def __init__(
        self,
        num_envs: int = 1,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        **arguments: Unpack[EnvironmentArguments],
    ) -> None:
        if num_envs < 1:
            raise UserError(f"num_envs = {num_envs}: give 1 or more")
        options = EnvironmentOptions(**arguments)
        check_mode(options.render_mode, MODES)
        self.num_envs, self.render_mode = num_envs, options.render_mode
        self.autoreset_mode = _checked_mode(autoreset_mode)
        self.metadata = {**type(self).metadata, "autoreset_mode": self.autoreset_mode}  # type: ignore[misc]
        batched = options.world == "graph"
        sizes = [num_envs] if batched else [1] * num_envs
        self._games = [Game(options, size) for size in sizes]
        self._where = [(0, i) if batched else (i, 0) for i in range(num_envs)]
        self._episodes = [Episodes() for _ in range(num_envs)]
        self._ended = np.zeros(num_envs, np.bool_)
        self._pictures = [Picture(env) for _, env in self._where] if self.render_mode else []
        agents = self._games[0].agents
        self.single_observation_space = picture_space(self._games[0].shapes, (agents,))
        self.single_action_space = spaces.MultiDiscrete([9] * agents)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Pictures, dict[str, Any]]:
        """Start the next episode of all sub-environments, or of some.

        Parameters
        ----------
        seed : of the first, the others take the integers after it; or one for each
        options : `reset_mask`, (env,) booleans: which to start; absent: all

        Raises
        ------
        UserError
            If a seed or the mask is not one, or the first reset leaves some out.
        """
        seeds, envs = self._seeds(seed), self._chosen((options or {}).get("reset_mask"))
        super().reset(seed=seeds[0] if isinstance(seed, Integral) else None)
        self._start(envs, seeds)
        return self._observed(), self._facts()

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
            checked_started(self._games[0].started, "reset of some sub-environments")
        return np.flatnonzero(chosen)

    def step(
        self, actions: NDArray[np.int64]
    ) -> tuple[Pictures, NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """One decision of every fleet; raises `UserError` where an action is not of its space."""
        moves = checked_moves(actions, (self.num_envs, self._games[0].agents), "actions")
        again = self._ended.copy() if self.autoreset_mode is AutoresetMode.NEXT_STEP else None
        parts = self._play(moves)
        rewards = np.concatenate([part.rewards.sum(axis=1) for part in parts])
        terminated = np.concatenate([part.terminated for part in parts])
        truncated = np.concatenate([part.truncated for part in parts])
        info: dict[str, Any] = {"illegal": np.concatenate([part.illegal for part in parts])}
        for name in parts[0].terms:
            info[f"reward/{name}"] = np.concatenate([p.terms[name].sum(axis=1) for p in parts])
        self._ended |= terminated | truncated
        if again is not None and again.any():
            self._start(np.flatnonzero(again), [None] * self.num_envs)
        for picture, (game, _) in zip(self._pictures, self._where, strict=False):
            picture.see(self._games[game].mission)
        info |= self._facts()
        over = terminated | truncated
        if self.autoreset_mode is AutoresetMode.SAME_STEP and over.any():
            info |= {"final_obs": self._observed(), "_final_obs": over.copy()}
            info |= {"final_info": self._facts(), "_final_info": over.copy()}
            self._start(np.flatnonzero(over), [None] * self.num_envs)
        return self._observed(), rewards, terminated, truncated, info

    def render(self) -> tuple[Any, ...] | None:
        """A picture (height, width, 3) uint8 of each, or None without a render mode."""
        if not self.render_mode:
            return None
        checked_started(self._games[0].started, "render")
        each = zip(self._pictures, self._where, self._episodes, strict=True)
        return tuple(
            picture.draw(self._games[game], episodes) for picture, (game, _), episodes in each
        )

    def _play(self, actions: NDArray[np.int64]) -> list[Outcome]:
        if len(self._games) == 1:
            return [self._games[0].step(actions)]
        return [game.step(actions[i : i + 1]) for i, game in enumerate(self._games)]

    def _start(self, envs: NDArray[np.intp], seeds: list[int | None]) -> None:
        keys = [self._episodes[i].following(seeds[i], self.np_random) for i in envs]
        if len(self._games) == 1 and envs.size:
            self._games[0].start(envs.astype(np.int64), np.concatenate(keys))
        elif envs.size:
            for i, key in zip(envs, keys, strict=True):
                self._games[i].start(np.zeros(1, np.int64), key)
        self._ended[envs] = False
        for i in envs:
            if self._pictures:
                self._pictures[i].see(self._games[self._where[i][0]].mission)

    def _observed(self) -> Pictures:
        parts = [game.see(np.arange(game.num_envs)) for game in self._games]
        seen: Pictures = {
            name: values(np.concatenate([part[name] for part in parts])) for name in parts[0]
        }
        return {**seen, MASK: np.concatenate([game.masks for game in self._games])}

    def _facts(self) -> dict[str, Any]:
        facts = [self._games[game].facts(env) for game, env in self._where]
        return {name: np.array([fact[name] for fact in facts]) for name in facts[0]}


def _checked_mode(mode: object) -> AutoresetMode:
    try:
        return AutoresetMode(mode)
    except ValueError as error:
        names = ", ".join(each.value for each in AutoresetMode)
        raise UserError(f"autoreset_mode = {mode!r}: unknown; choose {names}") from error
