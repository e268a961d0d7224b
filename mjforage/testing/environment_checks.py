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
    """What one step gave, by agent; the agent of Gymnasium is "", a central critic `CRITIC`."""

    seen: dict[str, Any]
    rewards: dict[str, float]
    over: bool
    infos: dict[str, dict[str, Any]]


@dataclass(frozen=True)
class EnvironmentTrial:
    """An environment, and what it is tried on.

    Attributes
    ----------
    env : id for `gymnasium.make`, or a function that makes an environment of Gymnasium or a
        `ParallelEnv` of PettingZoo
    options : of `gymnasium.make`, or of the function
    steps : as long as an episode is followed
    seed : of the first episode
    """

    env: str | Callable[..., Any]
    options: Mapping[str, Any] = field(default_factory=dict)
    steps: int = 40
    seed: int = 0

    @property
    def name(self) -> str:
        """What it is called in messages."""
        return self.env if isinstance(self.env, str) else getattr(self.env, "__name__", "env")

    def make(self) -> Any:
        """A fresh environment, without wrappers."""
        if isinstance(self.env, str):
            return gymnasium.make(self.env, **self.options).unwrapped
        made = self.env(**self.options)
        return made if hasattr(made, "possible_agents") else made.unwrapped

    def error(self, check: str, words: str) -> ConformanceError:
        """That the environment fails a check."""
        return ConformanceError(check, f"environment {self.name} {words}")


def is_parallel(env: Any) -> bool:
    """Whether it is one of PettingZoo."""
    return hasattr(env, "possible_agents")


def _space(env: Any, agent: str, kind: str) -> Any:
    if agent == CRITIC:
        return env.state_space
    return (
        getattr(env, f"{kind}_space")(agent) if is_parallel(env) else getattr(env, f"{kind}_space")
    )


def begin(env: Any, seed: int | None) -> dict[str, Any]:
    """Reset, and what is seen by each agent."""
    seen = env.reset(seed=seed)[0]
    return _all_seen(env, seen) if is_parallel(env) else {ONLY: seen}


def _all_seen(env: Any, seen: Mapping[str, Any]) -> dict[str, Any]:
    """What is seen in a `ParallelEnv`, by a central critic too."""
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
    """What Gymnasium's `check_env`, or PettingZoo's `parallel_api_test`, asks for."""
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
    """One seed and the same actions give the same episode, to the bit."""
    one, two = rollout(trial, trial.make(), trial.seed), rollout(trial, trial.make(), trial.seed)
    _compare(trial, "seed", one, two, "for one seed; draw all chance from the seed of reset")


def check_fresh(trial: EnvironmentTrial) -> None:
    """A seeded episode does not depend on those played before it."""
    env = trial.make()
    rollout(trial, env, trial.seed + 1)
    one, two = rollout(trial, trial.make(), trial.seed), rollout(trial, env, trial.seed)
    words = "in a fresh environment and after another episode; let reset forget everything"
    _compare(trial, "fresh", one, two, words)


def _compare(
    trial: EnvironmentTrial, check: str, one: list[Frame], two: list[Frame], why: str
) -> None:
    for step, (a, b) in enumerate(zip(one, two, strict=False)):
        for what, here, there in (
            ("observation", leaves(a.seen), leaves(b.seen)),
            ("reward", leaves(a.rewards), leaves(b.rewards)),
            ("end", leaves({"": a.over}), leaves({"": b.over})),
        ):
            for path in {**here, **there}:
                missing = np.zeros(0)
                found = first_difference(here.get(path, missing), there.get(path, missing))
                if found:
                    name = f"{what} {path}".strip()
                    raise trial.error(check, f"gave {name} {found} at step {step} {why}")


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
                    f"({_stray(space, seen)}); mend the observation or the space",
                )


def _of(agent: str) -> str:
    return f" of {agent}" if agent else ""


def _stray(space: Any, seen: Any) -> str:
    """The part of an observation that its space does not hold."""
    if isinstance(space, spaces.Dict) and isinstance(seen, Mapping):
        if set(space.keys()) != set(seen):
            return f"keys {sorted(seen)} for {sorted(space.keys())}"
        for key, part in space.items():
            if not part.contains(seen[key]):
                return f"{key}: {_stray(part, seen[key])}"
    found = np.asarray(seen)
    shown = f", {found.min()} to {found.max()}" if found.size and found.dtype.kind in "iuf" else ""
    return f"{found.dtype} {found.shape}{shown} for {space}"


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
    """`action_mask` leaves a legal action, and tells those that `info["illegal"]` counts.

    What it calls legal must not be counted; what it calls illegal must be counted or refused.
    Whether it is true is known only for `Discrete` actions of an environment that counts.
    """
    env, random = trial.make(), np.random.default_rng(trial.seed)
    seen, over, step, counted = begin(env, trial.seed), False, 0, 0
    while not over and step < trial.steps:
        for agent, one in seen.items():
            mask = _mask(one)
            if mask is not None and not mask.any(axis=-1).all():
                raise trial.error(
                    "mask",
                    f"gave a mask{_of(agent)} without a legal action at step {step}; allow one",
                )
        frame = play(env, chosen(env, seen, random))
        seen, over, step = frame.seen, frame.over, step + 1
        counted = int(frame.infos.get(ONLY, {}).get("illegal", 0))
        if counted and isinstance(env.action_space, spaces.Discrete):
            raise trial.error(
                "mask",
                f"counted {counted} illegal actions at step {step}, which its mask had "
                "called legal; let the mask say what is legal",
            )
    _check_masked(trial)


def _check_masked(trial: EnvironmentTrial) -> None:
    """The first action that a mask calls illegal must be counted, or refused."""
    env, random = trial.make(), np.random.default_rng(trial.seed)
    if is_parallel(env) or not isinstance(env.action_space, spaces.Discrete):
        return
    seen, over, tried = begin(env, trial.seed), False, False
    for _ in range(trial.steps):
        mask = _mask(seen[ONLY])
        if over or mask is None:
            return
        action = chosen(env, seen, random)
        if not tried and not mask.all():
            action, tried = {ONLY: np.int64(np.flatnonzero(~mask)[0])}, True
        try:
            frame = play(env, action)
        except Exception:  # noqa: BLE001 - refused, as it may be
            return
        info = frame.infos[ONLY]
        if tried and "illegal" in info:
            if not info["illegal"]:
                raise trial.error(
                    "mask",
                    f"did not count action {action[ONLY]} as illegal, which its mask had "
                    "called so; let the mask say what is legal",
                )
            return
        seen, over = frame.seen, frame.over


def check_actions(trial: EnvironmentTrial) -> None:
    """What is no action is refused with an error that has words, and nothing is played."""
    env, other = trial.make(), trial.make()
    seen, _ = begin(env, trial.seed), begin(other, trial.seed)
    action = chosen(env, seen, np.random.default_rng(trial.seed))
    agent = next(iter(action))
    wrong = _outside(_space(env, agent, "action"), action[agent])
    try:
        play(env, action | {agent: wrong})
    except Exception as error:
        if not str(error).strip():
            raise trial.error(
                "actions",
                f"refused action {wrong} with {type(error).__name__} and no word; say "
                "what is wrong and what to give",
            ) from error
    else:
        raise trial.error(
            "actions",
            f"took action {wrong}{_of(agent)}, which is not in its space; refuse it with "
            "an error that says what to give",
        )
    one, two = play(env, action), play(other, action)
    words = "after an action that it had refused and without it; play nothing that is refused"
    _compare(trial, "actions", [one], [two], words)


def _outside(space: Any, action: Any) -> Any:
    """An action of the right shape that is not in a space."""
    if isinstance(space, spaces.Box):
        return np.full(space.shape, np.nan, space.dtype)
    if isinstance(space, spaces.MultiDiscrete):
        return np.asarray(space.nvec, np.int64)
    if isinstance(space, spaces.Discrete):
        return np.int64(space.start + space.n)
    return None


ENVIRONMENT_CHECKS = (
    check_api,
    check_seed,
    check_fresh,
    check_space,
    check_memory,
    check_rewards,
    check_mask,
    check_actions,
)


def check_environment(
    env: str | Callable[..., Any], *, steps: int = 40, seed: int = 0, **options: Any
) -> None:
    """All checks of an environment.

    Parameters
    ----------
    env : id for `gymnasium.make`, or a function that makes an environment of Gymnasium or a
        `ParallelEnv` of PettingZoo
    steps : as long as an episode is followed
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
