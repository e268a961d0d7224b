"""`mjforage compile`: what it compiles is not compiled again, neither here nor in workers."""

import os
import subprocess
import sys
from pathlib import Path

SPAWNED = """
from functools import partial
import gymnasium
from gymnasium.vector import AsyncVectorEnv
import mjforage

ABOUT = {"scenario": "open-bay", "set": {"horizon": 4}}

def main():
    make = partial(gymnasium.make, "mjforage/Foraging-v0", **ABOUT)
    batch = gymnasium.make_vec("mjforage/Foraging-v0", num_envs=3, **ABOUT)
    for env in (AsyncVectorEnv([make] * 2, context="spawn"), batch):
        env.reset(seed=1)
        for _ in range(6):
            env.step(env.action_space.sample())
        env.close()

if __name__ == "__main__":
    main()
"""


def ran(cache: Path, *arguments: str) -> str:
    """Standard output of a Python process with a cache of its own, which says nothing else."""
    environment = {"NUMBA_CACHE_DIR": str(cache), "MJFORAGE_COMPILING_SAID": ""}
    done = subprocess.run(
        [sys.executable, *arguments],
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=True,
    )
    assert "UserWarning" not in done.stderr, "the command line says it by its progress"
    return done.stdout


def kept(cache: Path) -> dict[str, int]:
    """Kernels on the disk, and when they were written."""
    return {path.name: path.stat().st_mtime_ns for path in cache.rglob("*.nbc")}


def test_spawned_workers_and_batches_find_all_compiled(tmp_path: Path) -> None:
    command = "-m", "mjforage", "compile", "open-bay", "--policy", "greedy", "--world", "graph"
    said = ran(tmp_path, *command)
    before = kept(tmp_path)
    assert said == f"{tmp_path / 'mjforage'}: {len(before)} kernels\n"
    assert len(before) > 50
    (tmp_path / "spawned.py").write_text(SPAWNED)
    ran(tmp_path, str(tmp_path / "spawned.py"))
    assert kept(tmp_path) == before
