"""Commands in an unfriendly environment: warnings are errors, and few files may be open."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

RUN = ("evaluate", "comb-port", "--policy", "greedy", "--episodes", "1", "--set", "horizon=3")
EVALUATE = (*RUN, "--replay", "none", "-o", "run")


def command(folder: Path, *words: str, **variables: str) -> "subprocess.CompletedProcess[str]":
    """Run the command in a folder, as a process with these variables."""
    drawn = ("MUJOCO_GL", "PYOPENGL_PLATFORM")  # are set here once a test has drawn
    own = {name: value for name, value in os.environ.items() if name not in drawn}
    return subprocess.run(
        [sys.executable, "-m", "mjforage", *words],
        cwd=folder,
        env=own | {"PYTHONPATH": str(Path(__file__).parents[3])} | variables,
        capture_output=True,
        text=True,
        check=False,
    )


def faults(done: "subprocess.CompletedProcess[str]") -> list[str]:
    """Return what was said on stderr, without how far it has come, which a slow machine says."""
    return [line for line in done.stderr.splitlines() if not line.endswith(("so far", "left"))]


def test_a_run_raises_no_warning(finished: Path, tmp_path: Path) -> None:
    assert finished.is_dir()
    done = command(tmp_path, *EVALUATE, PYTHONWARNINGS="error")
    assert (done.returncode, faults(done)) == (0, [])


@pytest.mark.skipif(os.name != "posix", reason="needs a POSIX shell")
@pytest.mark.parametrize("files", [14, 16])  # joblib fails in two ways of its own
def test_too_few_files_for_workers_are_one_line(files: int, finished: Path, tmp_path: Path) -> None:
    assert finished.is_dir()
    words = " ".join((*EVALUATE, "--policy", "levy", "--jobs", "2"))
    done = subprocess.run(
        ["bash", "-c", f"ulimit -n {files}; {sys.executable} -m mjforage {words}"],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(Path(__file__).parents[3])},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    (line,) = faults(done)
    assert "Too many open files; give fewer jobs" in line
