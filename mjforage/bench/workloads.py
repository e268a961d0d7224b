"""Workloads of `mjforage bench`, and the amount of work of one call of each."""

import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple, cast

import gymnasium
import numba
import numpy as np
from numpy.typing import NDArray

import mjforage  # noqa: F401  registers the environments
from mjforage.base.randomness import episode_keys
from mjforage.graph_planner.policies import create_policy
from mjforage.mission.mission import Mission
from mjforage.mission.moves import preferences_of
from mjforage.mission.setup import Setup
from mjforage.physics.port_drive import drive, port_scene, port_simulation
from mjforage.physics.simulation.integrators import Integrator
from mjforage.physics.worlds import create_mission
from mjforage.runs.evaluate import evaluate
from mjforage.scenario.maps import GridMap
from mjforage.scenario.scenario_file import load_scenario

BATCH = 400  # episodes side by side
BELIEF_BATCH = 20
DECISIONS, HULLS = 10, 4  # of an episode of hulls
STEPS = "environment steps"
LARGE = (
    *("team.scouts.count=32", "team.foragers.count=32", "items.mean=5000", "items.std=0"),
    *("items.covariance_node2=1e5", "map.starts=[]", "horizon=20"),
)
SMALL = {"num_envs": 8, "warmup": 500, "explore_updates": 100}  # of training

Work = Callable[[], float]
"""Does a slice of work, always the same, and returns how much that was."""


class Workload(NamedTuple):
    """Benchmark workload."""

    unit: str  # of the work
    make: Callable[[], Work]
    threads: int = 1  # beyond one, rates are per second instead of CPU second


def _hash(count: int) -> np.uint64:
    value = np.uint64(1)
    for _ in range(count):
        value ^= value >> np.uint64(30)
        value *= np.uint64(0xBF58476D1CE4E5B9)
        value ^= value >> np.uint64(27)
    return value


def _hashing(count: int = 1_000_000) -> Work:
    """Integer hashing, the yardstick: it depends on the core alone, not on our code."""
    compiled = cast(Any, numba).njit(_hash)

    def work() -> float:
        compiled(count)
        return float(count)

    return work


def _graph(policy_name: str, episodes: int, *overrides: str, grid: GridMap | None = None) -> Work:
    scenario = load_scenario("comb-port", overrides)
    mission = Mission(Setup.of(scenario) if grid is None else Setup(scenario, grid))
    policy = create_policy(policy_name)

    def work() -> float:
        mission.reset(0, np.arange(episodes))
        mission.run(policy)
        return float(mission.step.sum())

    return work


def _large() -> Work:
    """64 agents and 5,000 items in a large harbour of basins behind long moles."""
    navigable = np.ones((1000, 1000), np.bool_)
    navigable[::40, :-30] = False
    navigable[20::40, 30:] = False
    return _graph("greedy", 1, *LARGE, grid=GridMap("large", navigable))


def _evaluation(episodes: int = BATCH) -> Work:
    """An evaluation of Greedy, logs and summary included."""
    setup = Setup.of(load_scenario("comb-port"))

    def work() -> float:
        with tempfile.TemporaryDirectory() as folder:
            summary = evaluate(setup, ["greedy"], Path(folder) / "run", episodes=episodes)
        return float(summary["graph"]["greedy"]["length"]["mean"]) * episodes

    return work


def _physics_mission(episodes: int = 4, horizon: int = 20) -> Work:
    setup = Setup.of(load_scenario("comb-port", [f"horizon={horizon}"]))

    def work() -> float:
        mission = create_mission(setup, "physics")
        mission.reset(0, np.arange(episodes))
        mission.run(create_policy("greedy"))
        return float(mission.step.sum()) * setup.scenario.period_s

    return work


def _simulation(integrator: Integrator, seconds: float = 60.0) -> Work:
    """Vessels driven at random through the default port, from where contacts have come up."""
    simulation = port_simulation(port_scene(), integrator, 1)
    drive(simulation, seconds)
    saved = simulation.snapshot()

    def work() -> float:
        simulation.restore(saved)
        drive(simulation, seconds, seed=1)
        return seconds

    return work


def _environment(num_envs: int, steps: int = 50, **options: Any) -> Work:
    """The vector environment with random actions."""
    env: Any = gymnasium.make_vec(
        "mjforage/Foraging-v0", num_envs=num_envs, scenario="comb-port", **options
    )
    actions = np.random.default_rng(0).integers(0, 9, (steps, *env.action_space.shape))

    def work() -> float:
        env.reset(seed=0)
        for action in actions:
            env.step(action)
        return float(num_envs * steps)

    return work


def _hulls(episodes: int) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Moves (step, episode, agent), and which of the episodes start again halfway."""
    moves = np.random.default_rng(0).integers(0, 9, (DECISIONS, episodes, HULLS))
    return moves, np.arange(episodes) % 2 == 0


def _hulls_batch(episodes: int) -> Work:
    """A mission of hulls by itself, which does what `_hulls_environment` asks of its own."""
    setup = Setup.of(load_scenario("comb-port", [f"horizon={DECISIONS}"]))
    mission, (moves, half) = create_mission(setup, "physics"), _hulls(episodes)
    first, second = (
        np.concatenate([episode_keys(seed, np.array([number])) for seed in range(episodes)])
        for number in (0, 1)
    )

    def work() -> float:
        mission.start(first)
        for step, chosen in enumerate(moves):
            if step == DECISIONS // 2:
                mission.restart(np.flatnonzero(half), second[half])
            mission.advance(preferences_of(chosen))
        mission.restart(np.flatnonzero(~half), second[~half])
        return float(episodes * DECISIONS)

    return work


def _hulls_environment(num_envs: int, threads: int = 1) -> Work:
    """The vector environment of hulls: half of its episodes start again between the others, which
    start again at their end.
    """
    env: Any = gymnasium.make_vec(
        "mjforage/Foraging-v0",
        num_envs=num_envs,
        autoreset_mode="SameStep",
        scenario="comb-port",
        world="physics",
        set={"horizon": DECISIONS},
        threads=threads,
    )
    moves, half = _hulls(num_envs)

    def work() -> float:
        env.reset(seed=0)
        for step, chosen in enumerate(moves):
            if step == DECISIONS // 2:
                env.reset(options={"reset_mask": half})
            env.step(chosen)
        return float(num_envs * DECISIONS)

    return work


def _updates(count: int = 20) -> Work:
    """Updates of one team's network, draw and priorities included."""
    from mjforage.learning.training.hyperparameters import Hyperparameters, changed
    from mjforage.learning.training.trainer import Trainer

    trainer = Trainer([load_scenario("published")], changed(Hyperparameters(), SMALL))
    trainer.play_round()  # fills the replay buffer
    learner = next(iter(trainer.learners.values()))

    def work() -> float:
        for _ in range(count):
            trainer.update(learner, 1.0)
        return float(count)

    return work


RADIOS = ("link.model=disk", "link.range_m=64")
MISSES = ("sensors.detection=0.9", "prior.detection=0.9")
REUSED: dict[str, Any] = {"dtype": "uint8", "copy": False}
SIMULATED = "simulated seconds (4 vessels, 75 items)"
WORKLOADS = {
    "hashing": Workload("integer hashes, a yardstick of the core", _hashing),
    **{
        f"graph_{name}": Workload(STEPS, partial(_graph, name, BATCH))
        for name in ("random", "greedy", "levy", "lawnmower", "wanderer", "pso")
    },
    "graph_greedy_single": Workload(STEPS, partial(_graph, "greedy", 1)),
    "graph_greedy_link": Workload(STEPS, partial(_graph, "greedy", BATCH, *RADIOS)),
    "graph_greedy_large": Workload(STEPS, _large),
    "graph_belief": Workload(STEPS, partial(_graph, "belief", BELIEF_BATCH)),
    "graph_belief_link": Workload(STEPS, partial(_graph, "belief", BELIEF_BATCH, *RADIOS)),
    "graph_belief_misses": Workload(STEPS, partial(_graph, "belief", BELIEF_BATCH, *MISSES)),
    "evaluate_greedy": Workload(f"{STEPS}, logs included", _evaluation),
    "physics": Workload(SIMULATED, partial(_simulation, Integrator.FAST)),
    "physics_reference": Workload(SIMULATED, partial(_simulation, Integrator.REFERENCE)),
    "physics_greedy": Workload("simulated seconds of a logged mission", _physics_mission),
    **{f"physics_batch_{n}": Workload(STEPS, partial(_hulls_batch, n)) for n in (16, 64)},
    **{
        f"environment_physics_{n}": Workload(STEPS, partial(_hulls_environment, n))
        for n in (1, 16, 64)
    },
    **{
        f"environment_physics_{n}_threads_2": Workload(STEPS, partial(_hulls_environment, n, 2), 2)
        for n in (16, 64)
    },
    "environment": Workload(f"{STEPS}, observations included", partial(_environment, 64)),
    "environment_uint8": Workload(
        f"{STEPS}, observations included", partial(_environment, 256, **REUSED)
    ),
    "ddqn_updates": Workload("updates of one team's network", _updates),
}
"""Key -> what is measured. Keys with `link` have radios with a range of 64 m, those with `misses`
sensors that miss a tenth of the items. `environment_physics_N` plays N episodes of hulls side by
side, `physics_batch_N` the same ones without an environment."""
