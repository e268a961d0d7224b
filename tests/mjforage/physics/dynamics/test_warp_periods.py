"""Missions whose ticks are all on a device."""

import os
import subprocess
import sys
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from mjforage.base.errors import UserError
from mjforage.base.randomness import episode_keys
from mjforage.graph_planner.policies import create_policy
from mjforage.mission.setup import Setup
from mjforage.physics.worlds import create_mission
from mjforage.scenario.scenario_file import load_scenario

SCENARIOS = (
    ("comb-port-weather", "physics.spread.mass=0.2", "physics.spread.thrust=0.1"),
    ("comb-port-weather", "sensors.camera_noise_m=0", "sensors.position_noise_m=0.2"),
    ("comb-port-gnss", "faults.rate_per_h=20", "sensors.position_wander_m=2"),
    ("comb-port-weather", "physics.step_s=0.05"),
    ("comb-port-wind-8", "physics.capture=node", "physics.item_contacts=false"),
    (
        "comb-port-weather",
        "physics.items=graph",
        "physics.capture=node",
        "sensors.camera_noise_m=0",
    ),
)


def played(changes: tuple[str, ...], looped: bool) -> list[bytes]:
    """States of a mission that ends for one episode and starts anew for another."""
    scenario, *others = changes
    about = ["horizon=5", "period_s=4", "physics.device=warp-cpu", *others]
    mission: Any = create_mission(Setup.of(load_scenario(scenario, about)), "physics")
    mission.reset(3, np.arange(3))
    dynamics, policy, states = mission._dynamics, create_policy("greedy"), []
    if looped:
        dynamics._choice = replace(dynamics._choice, device="cpu")
    mission.prepare(policy)
    dynamics._tracks.ashore[:] = 0.3  # seldom more than nothing
    for step in range(4):
        if step == 2:
            mission.active = mission.active & np.array([True, False, True])
        if step == 3:
            mission.restart(np.array([2]), episode_keys(11, np.array([4])))
        mission.advance(mission.ask(policy))
        fleets, simulation = dynamics._pilot.arrays, dynamics._simulation
        kept = *mission.state, *fleets, simulation.item_xy, simulation.vessel_pose
        kept = *kept, simulation.item_class, dynamics._tick, dynamics._tracks.ashore
        states += [np.array(part).tobytes() for part in kept]
    assert type(dynamics._playing).__name__ == ("HostPeriod" if looped else "DevicePeriod")
    return states


@pytest.mark.parametrize("changes", SCENARIOS)
def test_ticks_on_a_device_are_those_of_the_loop(changes: tuple[str, ...]) -> None:
    """Bit for bit: the same kernels in the same order."""
    assert played(changes, looped=False) == played(changes, looped=True)


def test_a_mission_on_the_device_is_one_of_the_processor() -> None:
    """Bit for bit in numba's simulator, with Warp on the processor."""
    pytest.importorskip("numba_cuda")
    pytest.importorskip("mujoco_warp")
    command = [sys.executable, "-m", "tests.mjforage.physics.dynamics.simulated_mission"]
    simulated = {**os.environ, "NUMBA_ENABLE_CUDASIM": "1"}
    found = subprocess.run(command, env=simulated, capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stderr[-2000:]


def test_without_a_gpu_the_bench_of_fleets_is_refused_in_one_line() -> None:
    pytest.importorskip("numba_cuda")
    from mjforage.cli.speeds import bench

    with pytest.raises(UserError, match=r"^bench --device cuda: there is no GPU"):
        bench(device="cuda")
    with pytest.raises(UserError, match=r"^--device warp-cpu: has no --decisions"):
        bench(device="warp-cpu", decisions=True)
