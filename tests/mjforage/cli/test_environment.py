"""Commands among variables of other people's libraries: they work, or one line says which it is."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

RUN = ("evaluate", "comb-port", "--policy", "greedy", "--episodes", "1", "--set", "horizon=3")
EVALUATE = (*RUN, "--replay", "none", "-o", "run")
NO_FOLDER = str(Path(os.sep, "proc", "none"))
HARMLESS = {
    "MKL_NUM_THREADS": "nonsense",
    "MPLBACKEND": "nonsense",
    "MPLCONFIGDIR": NO_FOLDER,
    "MUJOCO_EGL_DEVICE_ID": "nonsense",
    "MUJOCO_GL": "nonsense",
    "NUMBA_DEVELOPER_MODE": "nonsense",
    "NUMBA_NUM_THREADS": "0",
    "NUMBA_OPT": "nonsense",
    "NUMBA_THREADING_LAYER": "nonsense",
    "OMP_NUM_THREADS": "nonsense",
    "OPENBLAS_NUM_THREADS": "nonsense",
    "POLARS_ENGINE_AFFINITY": "nonsense",
    "POLARS_MAX_THREADS": "0",
    "POLARS_VERBOSE": "nonsense",
    "PYOPENGL_PLATFORM": "nonsense",
    "QT_QPA_PLATFORM": "nonsense",
    "TERM": "nonsense",
    "TMPDIR": NO_FOLDER,
}
WARNED = ("NUMBA_DEVELOPER_MODE", "NUMBA_OPT", "POLARS_ENGINE_AFFINITY", "POLARS_VERBOSE")


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


@pytest.fixture(scope="module")
def run(finished: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a run that was made among all harmless variables; `finished` compiles its kernels."""
    assert finished.is_dir()
    folder = tmp_path_factory.mktemp("among")
    done = command(folder, *EVALUATE, **HARMLESS)
    assert done.returncode == 0, done.stderr
    (folder / "said").write_text("\n".join(faults(done)))
    return folder / "run"


def test_a_run_among_them_has_a_warning_of_one_line_at_most(run: Path) -> None:
    assert (run / "report.html").is_file()
    said = (run.parent / "said").read_text().splitlines()
    assert len(said) == len(WARNED)
    for name in WARNED:
        assert sum(name in line for line in said) == 1


def test_a_run_raises_no_warning(finished: Path, tmp_path: Path) -> None:
    assert finished.is_dir()
    done = command(tmp_path, *EVALUATE, PYTHONWARNINGS="error")
    assert (done.returncode, faults(done)) == (0, [])


@pytest.mark.parametrize(
    ("variables", "line"),
    [
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


def test_a_picture_from_above_needs_none_of_them(run: Path, tmp_path: Path) -> None:
    done = command(tmp_path, "render", str(run), "-o", "x.png", **HARMLESS)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "x.png").is_file()


@pytest.mark.usefixtures("opengl")
@pytest.mark.parametrize(
    "variable", ["MUJOCO_GL=osmesa", "MUJOCO_GL=nonsense", "PYOPENGL_PLATFORM=nonsense"]
)
def test_a_picture_of_hulls_is_drawn_or_names_the_variable(
    variable: str, run: Path, tmp_path: Path
) -> None:
    size = ("--width", "64", "--height", "64")
    words = ("render", str(run), "--camera", "chase", *size, "-o", "x.png")
    done = command(tmp_path, *words, **dict([variable.split("=")]))
    if (tmp_path / "x.png").exists():
        assert done.returncode == 0
    else:
        assert done.returncode == 2
        (line,) = faults(done)
        assert line.startswith(f"mjforage: {variable}: ")
        assert "; unset it, or " in line


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
