"""Commands among variables that other people's libraries refuse: one line says which it is."""

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


@pytest.mark.parametrize(
    ("variables", "line"),
    [
        (
            {"MUJOCO_GL": "nonsense"},
            "mjforage: MUJOCO_GL=nonsense: mujoco fails (invalid value for environment variable "
            "MUJOCO_GL: nonsense); unset it or give a value that it takes",
        ),
        (
            {"SOURCE_DATE_EPOCH": "nonsense"},
            "mjforage: SOURCE_DATE_EPOCH=nonsense: numpy fails (invalid literal for int() with "
            "base 10: 'nonsense'); unset it or give a value that it takes",
        ),
        (
            {"NUMBA_OPT": "nonsense", "PYTHONWARNINGS": "error"},
            "mjforage: NUMBA_OPT=nonsense, PYTHONWARNINGS=error: numba fails (Environment variable "
            "'NUMBA_OPT' is defined but its associated value 'nonsense' could not be parsed.); "
            "unset what is wrong of these",
        ),
    ],
)
def test_what_a_library_refuses_is_one_line(
    variables: dict[str, str], line: str, tmp_path: Path
) -> None:
    done = command(tmp_path, *EVALUATE, **variables)
    assert (done.returncode, faults(done)) == (2, [line])
    assert list(tmp_path.iterdir()) == []


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
    assert "Too many open files; give fewer --jobs" in line
