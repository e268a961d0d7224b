"""Fleets whose hulls, controllers and items are all on a GPU."""

import os
import subprocess
import sys

import pytest

from mjforage.base.errors import UserError


def test_a_tick_on_the_device_is_a_tick_of_the_host() -> None:
    """Bit for bit in numba's simulator, with Warp on the processor."""
    pytest.importorskip("numba_cuda")
    pytest.importorskip("mujoco_warp")
    command = [sys.executable, "-m", "tests.mjforage.physics.simulated_fleet"]
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
