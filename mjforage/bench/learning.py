"""Speeds of environments and training for `mjforage bench`, per CPU second of one core."""

from typing import Any

import gymnasium
import numpy as np

from mjforage.bench.rates import Rate, rate
from mjforage.learning.training.hyperparameters import Hyperparameters, changed
from mjforage.learning.training.trainer import Trainer
from mjforage.scenario.scenario_file import load_scenario

ENVS = 32
STEPS = 150 + 1
"""Of a slice: an episode of the published scenario, and the step that begins the next."""
ROUNDS = 2
UPDATES = 20
FRAMES = 20
OBSERVATIONS = ("paper", "egocentric")
MORE_ENVS, MANY_ENVS = 64, 256
HANDED_OUT: dict[str, dict[str, Any]] = {
    "float32": {},
    "float32_reused": {"copy": False},
    "uint8": {"dtype": "uint8"},
    "uint8_reused": {"dtype": "uint8", "copy": False},
}
SMALL = {"num_envs": 8, "warmup": 500, "explore_updates": 100}


def _env_steps(num_envs: int, **options: Any) -> tuple[Rate, int]:
    """Environment steps of the vector environment with random actions, and its agents."""
    env = gymnasium.make_vec(
        "mjforage/Foraging-v0", num_envs=num_envs, scenario="published", **options
    )
    shape = env.action_space.shape or ()
    actions = np.random.default_rng(0).integers(0, 9, (STEPS, *shape))

    def work() -> float:
        for action in actions:
            env.step(action)
        return float(STEPS * num_envs)

    steps = rate(work, lambda: env.reset(seed=0))
    env.close()
    return steps, shape[-1]


def _environment_speeds() -> dict[str, Rate]:
    figures = {}
    for kind in OBSERVATIONS:
        steps, agents = _env_steps(ENVS, observation=kind)
        figures[f"env_obs_steps_per_core_s_{kind}"] = steps.times(agents)
    for name, options in HANDED_OUT.items():
        figures[f"env_steps_per_core_s_{name}"], _ = _env_steps(MORE_ENVS, **options)
    many, _ = _env_steps(MANY_ENVS, **HANDED_OUT["uint8_reused"])
    figures["env_steps_per_core_s_uint8_reused_many"] = many
    return figures


def _frames() -> Rate:
    """Pictures of the default mission from above, each after a step whose time does not count."""
    env = gymnasium.make("mjforage/Foraging-v0", render_mode="rgb_array").unwrapped
    env.reset(seed=0)

    def work() -> float:
        for _ in range(FRAMES):
            env.render()
        return float(FRAMES)

    frames = rate(work, lambda: env.step(env.action_space.sample()))
    env.close()
    return frames


def learning_speeds() -> dict[str, float | Rate]:
    """Key -> number.

    `env_obs_steps_per_core_s_<kind>`: agent observations; `env_steps_per_core_s_<how>`: environment
    steps of 64 sub-environments with egocentric observations, by how these are handed out;
    `env_steps_per_core_s_uint8_reused_many`: of 256;
    `env_frames_per_core_s`: pictures that `render` draws;
    `ddqn_updates_per_s`: updates of one team's network, draw and priorities included;
    `ddqn_share_<part>`: of the time of training on the published scenario.
    """
    figures: dict[str, float | Rate] = dict(_environment_speeds())
    figures["env_frames_per_core_s"] = _frames()
    trainer = Trainer([load_scenario("published")], changed(Hyperparameters(), SMALL))
    trainer.play_round()  # compiles, and fills the replay
    for part in trainer.clock.seconds:
        trainer.clock.seconds[part] = 0.0
    for _ in range(ROUNDS):
        trainer.play_round()
    shares = dict(trainer.clock.seconds)
    learner = next(iter(trainer.learners.values()))

    def update() -> float:
        for _ in range(UPDATES):
            trainer.update(learner, 1.0)
        return float(UPDATES)

    figures["ddqn_updates_per_s"] = rate(update)
    parts = {part: s for part, s in shares.items() if part != "teacher"}
    total = sum(parts.values())
    return figures | {f"ddqn_share_{part}": s / total for part, s in parts.items()}
