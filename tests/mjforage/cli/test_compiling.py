"""`mjforage compile`: what it compiles is not compiled again, neither here nor in workers."""

import os
import subprocess
import sys
import time
from pathlib import Path

from mjforage.base.kernel_cache import kernel_folder

LEFT_OUT = "mjforage.base."  # compiled by the command, whatever this machine has
USED_H = 48.0  # reading notes a use on a file that is a day old

PROGRAM = """
import tempfile
from functools import partial
import gymnasium
from gymnasium.vector import AsyncVectorEnv
import mjforage as mf

ABOUT = {"scenario": "open-bay", "set": {"horizon": 4}}
TINY = {"num_envs": 2, "capacity": 1000, "batch": 4, "warmup": 4, "evaluate_episodes": 1}

def main():
    folder = tempfile.mkdtemp()
    worlds = ["graph", "physics"]
    policies, about = list(mf.names("policies")), {"episodes": 2, "progress": False}
    mf.evaluate("open-bay", policies, **about)
    run = mf.evaluate("open-bay", policies, world=worlds, horizon=7, **about)
    run.report(folder + "/report.html")
    for world in worlds:
        run.film(f"{folder}/{world}.mp4", "greedy", world=world, duration_s=1.0, progress=False)
    for world in worlds:
        for reward in ("mission", "published", "ddqn"):
            more = ABOUT | {"reward": reward, "world": world, "render_mode": "rgb_array"}
            play(gymnasium.make_vec("mjforage/Foraging-v0", num_envs=3, **more))
            play(gymnasium.make("mjforage/SharedPolicy-v0", **more))
    play(gymnasium.make("mjforage/Waypoint-v0"))
    make = partial(gymnasium.make, "mjforage/Foraging-v0", **ABOUT)
    play(AsyncVectorEnv([make] * 2, context="spawn"))
    for algorithm, settings in (("ddqn", TINY), ("mappo", {"num_envs": 2})):
        more = {"folder": f"{folder}/{algorithm}", "settings": settings, "progress": False}
        mf.train(algorithm, "open-bay", horizon=4, updates=1, **more)

def play(env):
    env.action_space.seed(1)
    env.reset(seed=1)
    for _ in range(6):
        env.step(env.action_space.sample())
    if env.render_mode:
        env.render()
    env.close()

if __name__ == "__main__":
    main()
"""


def ran(cache: Path, *arguments: str) -> tuple[str, str]:
    """Standard output and errors of a Python process with a cache of its own."""
    environment = {"NUMBA_CACHE_DIR": str(cache), "MJFORAGE_COMPILING_SAID": ""}
    done = subprocess.run(
        [sys.executable, *arguments],
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout, done.stderr


def written(cache: Path) -> dict[str, int]:
    """Kernels on the disk, and when they were written or last used."""
    return {path.name: path.stat().st_mtime_ns for path in cache.glob("*.nbc")}


def copy_kernels(cache: Path) -> None:
    """Have this machine's kernels, as if nobody had used them for days."""
    cache.mkdir()
    long_ago = time.time() - USED_H * 3600.0
    for path in (kernel_folder() or cache).glob("*.nbc"):
        if not path.name.startswith(LEFT_OUT):
            (cache / path.name).write_bytes(path.read_bytes())
            os.utime(cache / path.name, (long_ago, long_ago))


def delete_unused(cache: Path, begun: float) -> None:
    """Leave of the kernels those that were read or compiled since."""
    for path in cache.glob("*.nbc"):
        if path.stat().st_mtime < begun:
            path.unlink()


def test_after_it_nothing_is_compiled_in_either_world(tmp_path: Path) -> None:
    """By runs of all policies, reports, films, environments, workers and training.

    What this machine has compiled is no more compiled here; what the command does not ask for is
    taken away.
    """
    cache, begun = tmp_path / "mjforage", time.time() - 3600.0
    copy_kernels(cache)
    said, shown = ran(tmp_path, "-m", "mjforage", "compile", "open-bay")
    assert "UserWarning: mjforage compiles" not in shown, "the command line shows it itself"
    assert said == f"{cache}: {len(written(cache))} kernels\n"
    delete_unused(cache, begun)
    before = written(cache)
    assert len(before) > 100
    assert any(name.startswith(LEFT_OUT) for name in before)
    (tmp_path / "program.py").write_text(PROGRAM)
    _, shown = ran(tmp_path, str(tmp_path / "program.py"))
    after = written(cache)
    assert ", ".join(name for name in after if after[name] != before.get(name)) == ""
    assert not before.keys() - after.keys()
    assert "UserWarning: mjforage compiles" not in shown
