"""`mjforage/Waypoint-v0` in batches: on a device with tensors of torch, or one by one."""

import reprlib
from numbers import Integral
from typing import Any, ClassVar, Unpack

import gymnasium
from gymnasium.vector import AutoresetMode, SyncVectorEnv, VectorEnv
from gymnasium.vector.utils import batch_space

from mjforage.base.errors import UserError
from mjforage.base.extras import require
from mjforage.learning.environments.checks import (
    RENDER_MODES,
    check_count,
    checked_mode,
    checked_options,
    checked_started,
    chosen_envs,
    env_seeds,
)
from mjforage.learning.environments.tensors import on_host
from mjforage.learning.environments.waypoint import action_space, observation_space
from mjforage.learning.environments.waypoint_options import WaypointArguments, WaypointOptions

Tensor = Any  # of torch


def make_waypoint_batch(
    num_envs: int = 1,
    autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
    device: str | None = None,
    **arguments: Unpack[WaypointArguments],
) -> "VectorEnv[Any, Any, Any]":
    """A batch of `Waypoint-v0`: on a device, or in MuJoCo on this processor, one after the other.

    Raises `UserError` if an argument is not valid, or there is no such device.

    `device`: "cuda", "warp-cpu", or None for this processor's MuJoCo and arrays of NumPy.
    """
    check_count(num_envs, "num_envs")
    mode = checked_mode(autoreset_mode)
    if device is not None:
        return WaypointVectorEnv(num_envs, mode, device, **arguments)

    def one() -> Any:
        return gymnasium.make("mjforage/Waypoint-v0", **arguments)

    return SyncVectorEnv([one] * num_envs, autoreset_mode=mode)


class WaypointVectorEnv(VectorEnv[Tensor, Tensor, Tensor]):
    """A batch of `Waypoint-v0` whose vessels, rewards and observations are on a device.

    Actions, observations, rewards and ends are tensors of torch there, and so are all entries of
    `info`, each beside its mask; nothing of a step goes to the host but whether all is
    finite. Hulls move in MuJoCo Warp, in float32; episodes have the law of `WaypointEnv` and draws
    of their own. They are those of an environment's seed and the number of its episode, whatever
    the size of the batch.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": RENDER_MODES[:0], "render_fps": 2}  # type: ignore[misc]

    def __init__(
        self,
        num_envs: int = 1,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        device: str = "cuda",
        **arguments: Unpack[WaypointArguments],
    ) -> None:
        """Prepare.

        Raises `UserError` if an argument is not valid, or there is no such device.

        Parameters
        ----------
        autoreset_mode : as of `ForagingVectorEnv`; `info["final_obs"]` is a tensor (env, 16)
        device : "cuda", or "warp-cpu" for this processor, which is slow
        """
        require("a batch on a device", "mujoco_warp", "warp", "torch")
        from mjforage.learning.environments.waypoint_batch import TERMS, WaypointBatch

        options = WaypointOptions.of(arguments)
        if options.render_mode is not None:
            raise UserError(
                f"render_mode = {options.render_mode!r}: batches on a device draw nothing; leave "
                "it out, or leave out device"
            )
        check_count(num_envs, "num_envs")
        self.num_envs, self.render_mode = num_envs, None
        self.autoreset_mode = mode = checked_mode(autoreset_mode)
        self.metadata = {**type(self).metadata, "autoreset_mode": mode}  # type: ignore[misc]
        task = options.hull, options.weather, options.spread, options.weights
        self._batch = batch = WaypointBatch(*task, num_envs, device, mode)
        tensor = batch.hulls.arrays.tensor
        self._actions, self._last = tensor(batch.actions), tensor(batch.last)
        tracks, outcome = batch.tracks, batch.outcome
        self._observation, self._reward = tensor(outcome.observation), tensor(outcome.reward)
        self._ends = tensor(outcome.terminated), tensor(outcome.truncated)
        self._terms = [(f"reward/{name}", k) for k, name in enumerate(TERMS)]
        self._parts, self._over = tensor(outcome.terms), tensor(outcome.over)
        self._facts = {"reached": tensor(tracks.reached), "distance_m": tensor(tracks.distance)}
        self._final = {"reached": tensor(outcome.reached), "distance_m": tensor(outcome.distance)}
        self._started = False
        self.single_observation_space, self.single_action_space = (
            observation_space(),
            action_space(),
        )
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)

    def reset(
        self, *, seed: Any = None, options: dict[str, Any] | None = None
    ) -> tuple[Tensor, dict[str, Any]]:
        """Start the next episode of all environments, or of some; with a seed, its first one.

        Raises `UserError` if a seed or the mask is not one, or the first reset leaves some out.

        Parameters
        ----------
        seed : of the first, the others take the integers after it; or one for each
        options : `reset_mask`, (env,) booleans: which to start; absent: all
        """
        given = checked_options(options, ("reset_mask",))
        seeds = env_seeds(seed, self.num_envs)
        envs = chosen_envs(on_host(given.get("reset_mask")), self.num_envs, self._started)
        super().reset(seed=seeds[0] if isinstance(seed, Integral) else None)
        batch, arrays = self._batch, self._batch.hulls.arrays
        tracks = batch.tracks
        self.wait()  # copies are in CUDA's own stream, beside those that torch may have chosen
        arrays.fetch(tracks.episode)
        for i in envs:
            if seeds[i] is None and not self._started:
                seeds[i] = int(self.np_random.integers(1 << 63))
            if seeds[i] is not None:
                tracks.seed[i], tracks.episode[i] = seeds[i], 0
        batch.chosen[:] = False
        batch.chosen[envs] = True
        for array in (tracks.seed, tracks.episode, batch.chosen):
            arrays.send(array)
        self.wait()
        batch.begin()
        self._started, started = True, arrays.tensor(batch.chosen).clone()
        self._reward.masked_fill_(started, 0.0)
        return self._observation.clone(), self._told(self._facts, started)

    def step(self, actions: Any) -> tuple[Tensor, Tensor, Tensor, Tensor, dict[str, Any]]:
        """Half a second of constant commands in all environments.

        Returns: observations (env, 16), rewards (env,), terminated and truncated (env,), `info`.
        Raises `UserError` if an action is not finite, there was no reset, or the step before has
        left a vessel in unstable motion.

        Parameters
        ----------
        actions : (env, 2) float32 thrust of port and starboard, shares in [-1, 1]
        """
        checked_started(self._started, "step")
        self._actions.copy_(self._checked(actions))
        again = self._over.clone()
        self._batch.step()
        ends = tuple(each.clone() for each in self._ends)
        over, info = ends[0] | ends[1], {}
        terms = {name: self._parts[:, k] for name, k in self._terms}
        if self.autoreset_mode is AutoresetMode.SAME_STEP:
            info = {"final_obs": self._last.clone(), "_final_obs": over}
            info["final_info"], info["_final_info"] = self._told(self._final | terms, over), over
            again = over
        elif self.autoreset_mode is AutoresetMode.DISABLED:
            again = over & ~over
        info |= self._told(self._facts, over | ~over) | self._told(terms, ~again)
        return self._observation.clone(), self._reward.clone(), *ends, info

    def render(self) -> None:
        """Nothing: a batch on a device draws no pictures."""

    @property
    def hulls(self) -> Any:
        """The vessels on the device, see `physics.device_hulls.DeviceHulls`."""
        return self._batch.hulls

    def wait(self) -> None:
        """Wait until the device has done all steps."""
        self._batch.hulls.wait()

    def _checked(self, actions: Any) -> Tensor:
        import torch

        remedy = "give finite numbers, port and starboard, -1 full astern to 1 full ahead"
        try:
            given = torch.as_tensor(actions, dtype=torch.float32, device=self._actions.device)
        except (TypeError, ValueError, RuntimeError) as error:
            raise UserError(f"actions: are no array ({error}); {remedy}") from error
        if given.shape != self._actions.shape:
            shapes = f"{tuple(given.shape)}, expected {tuple(self._actions.shape)}"
            raise UserError(f"actions: have shape {shapes}; {remedy}")
        stable = torch.isfinite(self._reward)
        if bool(torch.isfinite(given).all() & stable.all()):
            return given
        if not stable.all():
            raise UserError(
                f"vessel of environment {int((~stable).nonzero()[0])}: its motion is unstable; "
                "take less wind or current, or check the vessel's parameters; reset begins anew"
            )
        env = int((~torch.isfinite(given)).any(dim=1).nonzero()[0])
        words = reprlib.repr(given[env].tolist())
        raise UserError(f"actions[{env}] = {words}: {remedy}")

    def _told(self, facts: dict[str, Tensor], valid: Tensor) -> dict[str, Tensor]:
        """Facts (env,) beside their masks, 0 where False."""
        info: dict[str, Tensor] = {}
        for name, fact in facts.items():
            info[name], info["_" + name] = fact * valid, valid
        return info
