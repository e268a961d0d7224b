"""Speeds on a device: fleets steered among drifting items, their environments, and waypoints."""

import time
from collections.abc import Iterator
from typing import Any

import numpy as np

from mjforage.base.errors import UserError
from mjforage.bench.running import Progress, Rate
from mjforage.learning.environments.device_core import DeviceCore
from mjforage.learning.environments.vector import ForagingVectorEnv
from mjforage.learning.environments.waypoint_vector import WaypointVectorEnv
from mjforage.mission.mission import Mission
from mjforage.mission.setup import Setup
from mjforage.physics.dynamics.mujoco_dynamics import MujocoDynamics
from mjforage.physics.dynamics.ticks import CONTROL_S
from mjforage.scenario.scenario_file import load_scenario

BATCHES = {"cuda": (4096, 16384), "warp-cpu": (16,)}
SCENARIO = "comb-port-weather"  # two scouts, two foragers, some 75 items
NEW_OF = 150  # decisions of an episode
DECISIONS, SLICES, STEPS_OF_A_SLICE = 3, 4, 20
FLEETS = "fleet steps of 0.1 s per second (4 vessels steered, 75 items drifting and collected)"
DECIDED = (
    "fleet decisions of 10 s per second, with sensing, observations and new episodes for 1 in 150"
)
STEPS = "environment steps of 0.5 s per second (one vessel, observed and steered by thrusts)"


def speeds(device: str, progress: Progress = lambda key: None) -> Iterator[tuple[str, Rate]]:
    """Measure batches on "cuda" or "warp-cpu", and give each figure once it is known.

    First decisions, which compile, do not count. Raises `UserError` if there is no such device.
    """
    if device not in BATCHES:
        raise UserError(f"bench --device {device}: unknown; choose {', '.join(BATCHES)}")
    measures = {"fleets": _fleets, "decisions": _decisions, "waypoints": _waypoints}
    for episodes in BATCHES[device]:
        for name, measure in measures.items():
            progress(key := f"device_{name}_{episodes}")
            yield key, measure(device, episodes)


class _Timed:
    """Dynamics of a world, and the time that the last decision took in it [s]."""

    def __init__(self, dynamics: MujocoDynamics) -> None:
        self._dynamics, self.took_s = dynamics, 0.0

    def __getattr__(self, name: str) -> Any:
        return getattr(self._dynamics, name)

    def advance(self, *given: Any) -> Any:
        started = time.perf_counter()
        state = self._dynamics.advance(*given)
        self.took_s = time.perf_counter() - started
        return state


def _fleets(device: str, episodes: int) -> Rate:
    """Fleets that go at random, without what the mission makes of it."""
    setup, rng, rates = (
        Setup.of(load_scenario(SCENARIO, [f"physics.device={device}"])),
        np.random.default_rng(0),
        [],
    )
    about = setup.graph, setup.fleet, setup.scenario, None, setup.grid.place
    dynamics = MujocoDynamics(*about)
    timed: Any = _Timed(dynamics)
    mission, ticks = Mission(setup, timed), setup.scenario.period_s / CONTROL_S
    mission.reset(0, np.arange(episodes))
    for _ in range(1 + DECISIONS):
        mission.advance(rng.random((episodes, len(setup.fleet), 9)))
        rates.append(episodes * ticks / timed.took_s)
    return _rate(rates[1:], FLEETS, dynamics.memory_bytes)


def _decisions(device: str, envs: int) -> Rate:
    about: Any = {"scenario": SCENARIO, "world": "physics", "autoreset_mode": "Disabled"}
    env, rates = ForagingVectorEnv(envs, device=device, **about), []
    env.reset(seed=0)
    for number in range(1 + DECISIONS):
        actions, started = env.action_space.sample(), time.perf_counter()
        env.reset(options={"reset_mask": np.arange(envs) % NEW_OF == number})
        env.step(actions)
        rates.append(envs / (time.perf_counter() - started))
    core = env._core
    return _rate(rates[1:], DECIDED, core.memory_bytes if isinstance(core, DeviceCore) else 0)


def _waypoints(device: str, envs: int) -> Rate:
    env = WaypointVectorEnv(envs, device=device)
    seen, _ = env.reset(seed=0)
    rates = []
    for _ in range(1 + SLICES):
        started = time.perf_counter()
        for _ in range(STEPS_OF_A_SLICE):
            seen, *_ = env.step(seen[:, :2])
        env.wait()
        rates.append(envs * STEPS_OF_A_SLICE / (time.perf_counter() - started))
    return _rate(rates[1:], STEPS, env.hulls.memory_bytes)


def _rate(rates: list[float], unit: str, memory_bytes: float = 0) -> Rate:
    """The median and the best, and what an episode takes on the device if that is known."""
    told = f", {memory_bytes / 1e3:.3g} kB of memory each" if memory_bytes else ""
    return Rate(float(np.median(rates)), max(rates), unit + told)
