"""Conformance of environments: Gymnasium's and PettingZoo's own checks, then ours."""

import contextlib
import io
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from mjforage.learning.environments.spaces import MASK
from mjforage.testing.conformance import ConformanceError, first_difference, run_checks

TOLERANCE = 1e-6  # of a sum of terms, which may be added in another order
ONLY = ""  # the one agent of an environment of Gymnasium
CRITIC = "state()"  # who sees that of a `ParallelEnv`, if it has a `state_space`


class Frame(NamedTuple):
    """Result of one step, by agent; the agent of Gymnasium is "", a central critic `CRITIC`."""

    seen: dict[str, Any]
    rewards: dict[str, float]
    over: bool
    infos: dict[str, dict[str, Any]]


@dataclass(frozen=True)
class EnvironmentTrial:
    """An environment, and the conditions of its checks.

    Attributes
    ----------
    env : id for `gymnasium.make`, or a function that makes an environment of Gymnasium or a
        `ParallelEnv` of PettingZoo
    options : of `gymnasium.make`, or of the function
    steps : steps of an episode that are checked
    seed : of the first episode
    """

    env: str | Callable[..., Any]
    options: Mapping[str, Any] = field(default_factory=dict)
    steps: int = 40
    seed: int = 0

    @property
    def name(self) -> str:
        """Name in messages."""
        return self.env if isinstance(self.env, str) else getattr(self.env, "__name__", "env")

    def make(self) -> Any:
        """A fresh environment, without wrappers."""
        if isinstance(self.env, str):
            return gymnasium.make(self.env, **self.options).unwrapped
        made = self.env(**self.options)
        return made if hasattr(made, "possible_agents") else made.unwrapped

    def error(self, check: str, words: str) -> ConformanceError:
        """Error of an environment that fails a check."""
        return ConformanceError(check, f"environment {self.name} {words}")


def is_parallel(env: Any) -> bool:
    """True if it is an environment of PettingZoo."""
    return hasattr(env, "possible_agents")


def _space(env: Any, agent: str, kind: str) -> Any:
    if agent == CRITIC:
        return env.state_space
    return (
        getattr(env, f"{kind}_space")(agent) if is_parallel(env) else getattr(env, f"{kind}_space")
    )


def begin(env: Any, seed: int | None) -> dict[str, Any]:
    """Reset, and return the observation of each agent."""
    seen = env.reset(seed=seed)[0]
    return _all_seen(env, seen) if is_parallel(env) else {ONLY: seen}


def _all_seen(env: Any, seen: Mapping[str, Any]) -> dict[str, Any]:
    """Observations of a `ParallelEnv`, with those of a central critic."""
    return {**seen, CRITIC: env.state()} if hasattr(env, "state_space") else dict(seen)


def play(env: Any, actions: Mapping[str, Any]) -> Frame:
    """One step."""
    if is_parallel(env):
        seen, rewards, ended, late, infos = env.step(dict(actions))
        over = all(ended[a] or late[a] for a in ended) or not env.agents
        return Frame(_all_seen(env, seen), dict(rewards), over, dict(infos))
    seen, reward, one, two, info = env.step(actions[ONLY])
    return Frame({ONLY: seen}, {ONLY: reward}, bool(one or two), {ONLY: info})


def chosen(env: Any, seen: Mapping[str, Any], random: np.random.Generator) -> dict[str, Any]:
    """An action of its space for every agent, legal where there is a mask."""
    agents = env.agents if is_parallel(env) else [ONLY]
    return {a: _drawn(_space(env, a, "action"), _mask(seen[a]), random) for a in agents}


def _mask(seen: Any) -> NDArray[np.bool_] | None:
    if isinstance(seen, Mapping) and MASK in seen:
        return np.asarray(seen[MASK]).astype(np.bool_)
    return None


def _drawn(space: Any, mask: NDArray[np.bool_] | None, random: np.random.Generator) -> Any:
    if mask is None or not mask.any(axis=-1).all():
        space.seed(int(random.integers(1 << 31)))
        return space.sample()
    drawn = np.where(mask, random.random(mask.shape), -1.0).argmax(axis=-1)
    return np.int64(drawn) if drawn.ndim == 0 else drawn


def leaves(value: Any, path: str = "") -> dict[str, NDArray[Any]]:
    """Arrays in nested dicts, by their path."""
    if isinstance(value, Mapping):
        found: dict[str, NDArray[Any]] = {}
        for key, part in value.items():
            found |= leaves(part, f"{path}.{key}" if path else str(key))
        return found
    return {path: np.asarray(value)}


def rollout(trial: EnvironmentTrial, env: Any, seed: int | None) -> list[Frame]:
    """An episode by chosen actions, to its end or as long as the trial says."""
    random = np.random.default_rng(trial.seed)
    frames = [Frame(_copied(begin(env, seed)), {}, False, {})]
    while len(frames) <= trial.steps and not frames[-1].over:
        frame = play(env, chosen(env, frames[-1].seen, random))
        frames.append(frame._replace(seen=_copied(frame.seen)))
    return frames


def _copied(seen: Any) -> Any:
    if isinstance(seen, Mapping):
        return {key: _copied(part) for key, part in seen.items()}
    return np.array(seen, copy=True) if isinstance(seen, np.ndarray) else seen


def check_api(trial: EnvironmentTrial) -> None:
    """Demands of Gymnasium's `check_env`, or of PettingZoo's `parallel_api_test`."""
    env = trial.make()
    try:
        with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()):
            warnings.simplefilter("ignore")
            if is_parallel(env):
                from pettingzoo.test import parallel_api_test

                parallel_api_test(env, num_cycles=trial.steps)
            else:
                from gymnasium.utils.env_checker import check_env

                check_env(env, skip_render_check=True)
    except Exception as error:
        whose = "parallel_api_test of PettingZoo" if is_parallel(env) else "check_env of Gymnasium"
        words = " ".join(str(error).split())
        raise trial.error("api", f"does not pass {whose}: {words}") from error


def check_seed(trial: EnvironmentTrial) -> None:
    """One seed and the same actions give the same episode, whatever was played before it."""
    env = trial.make()
    rollout(trial, env, trial.seed + 1)
    one, two = rollout(trial, trial.make(), trial.seed), rollout(trial, env, trial.seed)
    for step, (a, b) in enumerate(zip(one, two, strict=False)):
        found = _difference(a, b)
        if found:
            raise trial.error(
                "seed",
                f"gave {found} at step {step} for one seed, fresh and after another episode; draw "
                "all chance from the seed of reset, and let reset forget everything",
            )


def _difference(one: Frame, other: Frame) -> str:
    """First difference between two frames, as text; "" if there is none."""
    missing = np.zeros(0)
    for what, here, there in (
        ("observation", leaves(one.seen), leaves(other.seen)),
        ("reward", leaves(one.rewards), leaves(other.rewards)),
        ("end", leaves({"": one.over}), leaves({"": other.over})),
    ):
        for path in {**here, **there}:
            found = first_difference(here.get(path, missing), there.get(path, missing))
            if found:
                return f"{what} {path} {found}".replace("  ", " ")
    return ""


def check_space(trial: EnvironmentTrial) -> None:
    """Every observation is in its space, every state too."""
    env = trial.make()
    for step, frame in enumerate(rollout(trial, env, trial.seed)):
        for agent, seen in frame.seen.items():
            space = _space(env, agent, "observation")
            if not space.contains(seen):
                raise trial.error(
                    "space",
                    f"gave an observation{_of(agent)} at step {step} that is not in its space "
                    f"{space}; mend the observation or the space",
                )


def _of(agent: str) -> str:
    return f" of {agent}" if agent else ""


def check_memory(trial: EnvironmentTrial) -> None:
    """An observation or state that was given stays as it was while the episode goes on."""
    env, random = trial.make(), np.random.default_rng(trial.seed)
    given, over, step = begin(env, trial.seed), False, 0
    while not over and step < trial.steps:
        kept, step = _copied(given), step + 1
        frame = play(env, chosen(env, given, random))
        there = leaves(given)
        for path, before in leaves(kept).items():
            if first_difference(before, there[path]):
                raise trial.error(
                    "memory",
                    f"changed {path or 'the observation'} of step {step - 1} afterwards; give a "
                    "copy",
                )
        given, over = frame.seen, frame.over


def check_rewards(trial: EnvironmentTrial) -> None:
    """Rewards are finite, and the sum of `reward/NAME` in the infos where there are any."""
    for step, frame in enumerate(rollout(trial, trial.make(), trial.seed)):
        for agent, reward in frame.rewards.items():
            if not np.isfinite(reward):
                words = f"gave the reward{_of(agent)} {reward} at step {step}; give a finite number"
                raise trial.error("rewards", words)
            info = frame.infos.get(agent, {})
            terms = {name: v for name, v in info.items() if str(name).startswith("reward/")}
            total = sum(float(value) for value in terms.values())
            if terms and abs(total - reward) > TOLERANCE * max(1.0, abs(total)):
                raise trial.error(
                    "rewards",
                    f"gave the reward{_of(agent)} {reward} at step {step}, but its terms in info "
                    f"({', '.join(terms)}) add up to {total}; let them be the reward",
                )


def check_mask(trial: EnvironmentTrial) -> None:
    """`action_mask` leaves a legal action, and none that `info["illegal"]` counts."""
    for step, frame in enumerate(rollout(trial, trial.make(), trial.seed)):
        for agent, one in frame.seen.items():
            mask = _mask(one)
            if mask is not None and not mask.any(axis=-1).all():
                raise trial.error(
                    "mask",
                    f"gave a mask{_of(agent)} without a legal action at step {step}; allow one",
                )
        illegal = int(frame.infos.get(ONLY, {}).get("illegal", 0))
        if illegal and isinstance(trial.make().action_space, spaces.Discrete):
            raise trial.error(
                "mask",
                f"counted {illegal} illegal actions at step {step}, which its mask had called "
                "legal; let the mask say what is legal",
            )


ENVIRONMENT_CHECKS = (
    check_api,
    check_seed,
    check_space,
    check_memory,
    check_rewards,
    check_mask,
)


def check_environment(
    env: str | Callable[..., Any], *, steps: int = 40, seed: int = 0, **options: Any
) -> None:
    """All checks of an environment.

    Parameters
    ----------
    env : id for `gymnasium.make`, or a function that makes an environment of Gymnasium or a
        `ParallelEnv` of PettingZoo
    steps : steps of an episode that are checked
    seed : of the first episode
    options : of `gymnasium.make`, or of the function

    Raises
    ------
    ConformanceError
        Of the first check that fails.
    """
    trial = EnvironmentTrial(env, options, steps, seed)
    trial.make()  # what is not there says so itself
    run_checks(ENVIRONMENT_CHECKS, trial)
