"""Speeds of vector environments of multi-agent libraries on one core, with random actions.

    XLA_FLAGS="--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1" \
        OMP_NUM_THREADS=1 taskset -c 0 python examples/peer_speeds.py

Measures what is installed: mjforage, Jumanji (https://github.com/instadeepai/jumanji), JaxMARL
(https://github.com/FLAIROX/JaxMARL), VMAS (https://github.com/proroklab/VectorizedMultiAgentSimulator).
They need not be in one Python environment: run it once in each. Environment steps (one decision of
all agents of one environment) per CPU second of the process, observations, rewards and ends
included, by the size of the batch; jax environments are compiled, batched by vmap and played by a
scan of 100 steps.
The tasks differ: the table tells what a learner has to wait for, not which library is better.
"""

import statistics
import sys
import time
from collections.abc import Callable, Iterator
from typing import Any

BATCHES, STEPS, REPEATS = (64, 256), 100, 5
Work = Callable[[], object]


def rate(work: Work, batch: int) -> float:
    """Environment steps per CPU second, median; a first call compiles."""
    work()
    rates = []
    for _ in range(REPEATS):
        started = time.process_time()
        work()
        rates.append(batch * STEPS / (time.process_time() - started))
    return statistics.median(rates)


def ours(batch: int) -> Iterator[tuple[str, int, Work]]:
    """Our vector environment, with every way to hand out observations."""
    import gymnasium
    import numpy as np

    import mjforage  # noqa: F401  registers the ids

    variants: dict[str, dict[str, Any]] = {
        "float32": {},
        "float32, copy=False": {"copy": False},
        "uint8": {"dtype": "uint8"},
        "uint8, copy=False": {"dtype": "uint8", "copy": False},
    }
    for name, options in variants.items():
        env = gymnasium.make_vec("mjforage/Foraging-v0", num_envs=batch, **options)
        env.reset(seed=0)
        shape = env.action_space.shape or ()
        actions = np.random.default_rng(0).integers(0, 9, (STEPS, *shape))

        def work(env: Any = env, actions: Any = actions) -> None:
            for action in actions:
                env.step(action)

        yield f"mjforage Foraging-v0, {name}", shape[-1], work


def jumanji(batch: int) -> Iterator[tuple[str, int, Work]]:
    """Jumanji: its own step, which gives observation, reward and end in a time step."""
    import jumanji as library  # type: ignore[import-not-found,unused-ignore]

    for name in ("SearchAndRescue-v0", "RobotWarehouse-v0"):
        env = library.make(name)
        agents = int(env.action_spec.shape[0])

        def step(state: Any, key: Any, env: Any = env) -> tuple[Any, Any]:
            state, given = env.step(state, _drawn(env.action_spec, key))
            return state, given

        yield f"jumanji {name}", agents, _scanned(env.reset, step, batch)


def _drawn(spec: Any, key: Any) -> Any:
    import jax  # type: ignore[import-not-found,unused-ignore]

    if hasattr(spec, "num_values"):
        return jax.random.randint(key, spec.shape, 0, spec.num_values)
    return jax.random.uniform(key, spec.shape, spec.dtype, spec.minimum, spec.maximum)


def jaxmarl(batch: int) -> Iterator[tuple[str, int, Work]]:
    """JaxMARL: `step_env`, without its automatic reset."""
    import jax
    from jaxmarl import make  # type: ignore[import-not-found,unused-ignore]

    for name in ("MPE_simple_spread_v3", "overcooked"):
        env = make(name)

        def step(state: Any, key: Any, env: Any = env) -> tuple[Any, Any]:
            keys = jax.random.split(key, env.num_agents + 1)
            chosen = {
                a: env.action_space(a).sample(k) for a, k in zip(env.agents, keys[1:], strict=True)
            }
            seen, state, *rest = env.step_env(keys[0], state, chosen)
            return state, (seen, rest)

        def reset(key: Any, env: Any = env) -> tuple[Any, Any]:
            seen, state = env.reset(key)
            return state, seen

        yield f"jaxmarl {name}", env.num_agents, _scanned(reset, step, batch)


def _scanned(reset: Callable[[Any], Any], step: Callable[[Any, Any], Any], batch: int) -> Work:
    """A scan of steps of a batch, jitted; every observation of the batch is kept."""
    import jax

    def play(state: Any, key: Any) -> tuple[Any, Any]:
        def one(state: Any, key: Any) -> tuple[Any, Any]:
            state, given = jax.vmap(step)(state, jax.random.split(key, batch))
            return state, given

        state, given = jax.lax.scan(one, state, jax.random.split(key, STEPS))
        return state, given

    keys = jax.random.split(jax.random.PRNGKey(0), batch)
    state, _ = jax.vmap(reset)(keys)
    compiled = jax.jit(play)
    return lambda: jax.block_until_ready(compiled(state, keys[0]))


def vmas(batch: int) -> Iterator[tuple[str, int, Work]]:
    """VMAS: batched tensors on one thread."""
    import torch
    from vmas import make_env  # type: ignore[import-not-found,import-untyped,unused-ignore]

    torch.set_num_threads(1)
    for name in ("discovery", "navigation"):
        env = make_env(scenario=name, num_envs=batch, device="cpu", continuous_actions=True, seed=0)

        def work(env: Any = env) -> None:
            for _ in range(STEPS):
                env.step([env.get_random_action(agent) for agent in env.agents])

        yield f"vmas {name}", len(env.agents), work


def _say(line: str) -> None:
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


def main() -> None:
    """Print a table; a column for each size of the batch."""
    sizes = " | ".join(f"environment steps per CPU s, {batch} at once" for batch in BATCHES)
    _say(f"| environment | agents | {sizes} | agent observations, the quicker |")
    _say("|---|---|" + "---|" * (len(BATCHES) + 1))
    for library in (ours, jumanji, jaxmarl, vmas):
        try:
            for sizes_of_one in zip(*map(library, BATCHES), strict=True):
                found = [
                    rate(work, batch)
                    for batch, (*_, work) in zip(BATCHES, sizes_of_one, strict=True)
                ]
                name, agents, _ = sizes_of_one[0]
                steps = " | ".join(f"{each:,.0f}" for each in found)
                _say(f"| {name} | {agents} | {steps} | {agents * max(found):,.0f} |")
        except ImportError as error:
            nothing = " | ".join([""] * len(BATCHES))
            _say(f"| {library.__name__} | | {nothing} | is not installed ({error}) |")


if __name__ == "__main__":
    main()
