"""Variables of other people's libraries matter only where something is drawn."""

import os
import subprocess
import sys
from importlib.metadata import version

import numpy as np
import pytest

from mjforage.base.environment import drop_thread_counts, refusal
from mjforage.base.errors import UserError
from mjforage.base.registry import trust

IMPORTS = """
import os
names = ("MUJOCO_GL", "MPLBACKEND", "PYOPENGL_PLATFORM")
before = [os.environ.get(name) for name in names]
import mjforage.runs.evaluate, mjforage.view.report
import matplotlib, mujoco
mujoco.MjModel.from_xml_string("<mujoco/>")
assert [os.environ.get(name) for name in names] == before, "what is set stays for whoever asks"
"""


@pytest.mark.parametrize(
    "variable",
    [
        "MUJOCO_GL=osmesa",
        "MUJOCO_GL=nonsense",
        "MPLBACKEND=module://matplotlib_inline.backend_inline",
        "MPLBACKEND=nonsense",
        "PYOPENGL_PLATFORM=nonsense",
    ],
)
def test_libraries_are_imported_whatever_they_are_told(variable: str) -> None:
    name, _, value = variable.partition("=")
    program = f"import os\nos.environ[{name!r}] = {value!r}\n{IMPORTS}"
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")


def test_a_backend_that_is_there_is_chosen() -> None:
    program = (
        "import os\nos.environ['MPLBACKEND'] = 'svg'\n"
        "import mjforage.view.report, matplotlib; print(matplotlib.get_backend())"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, check=True)
    assert done.stdout.strip() == b"svg"


REFUSED = """
import sys
from mjforage.base.environment import refusal
try:
    {}
except BaseException as error:
    sys.stdout.write(refusal(error))
"""
PANIC = "import polars; polars.DataFrame({'a': [1]}).with_columns(polars.col('a') + 1)"
OLD_POLARS = version("polars").startswith("1.")  # takes 0 threads for as many as it likes


@pytest.mark.parametrize(
    ("program", "told", "other"),
    [
        ("import numba", b"NUMBA_NUM_THREADS=0: numba fails (Number of threads", b"POLARS"),
        pytest.param(
            *(PANIC, b"POLARS_MAX_THREADS=0: polars fails (Worker threads cannot be", b"NUMBA"),
            marks=pytest.mark.skipif(OLD_POLARS, reason="this polars does not mind"),
        ),
    ],
)
def test_a_library_that_gives_up_is_told_with_its_variables(
    program: str, told: bytes, other: bytes
) -> None:
    variables = {"POLARS_MAX_THREADS": "0", "NUMBA_NUM_THREADS": "0"}
    done = subprocess.run(
        [sys.executable, "-c", REFUSED.format(program)],
        env=os.environ | variables,
        capture_output=True,
        check=True,
    )
    assert done.stdout.startswith(told)
    assert other not in done.stdout


def test_errors_of_ours_and_without_variables_have_no_such_reason(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    monkeypatch.setenv("NUMPY_OF_SOMEBODY", "1")
    with pytest.raises(UserError, match="SOURCE_DATE_EPOCH") as ours:
        trust("SOURCE_DATE_EPOCH")
    assert refusal(ours.value) == ""
    with pytest.raises(np.linalg.LinAlgError) as theirs:
        np.linalg.inv(np.zeros((2, 2)))
    assert refusal(theirs.value) == ""


def test_counts_of_threads_that_are_none_are_dropped(monkeypatch: pytest.MonkeyPatch) -> None:
    bad = {"NUMBA_NUM_THREADS": "0", "POLARS_MAX_THREADS": "-1", "MKL_NUM_THREADS": "many"}
    good = {"OMP_NUM_THREADS": "4,2", "OPENBLAS_NUM_THREADS": "1", "USE_THREADS": "no"}
    for name, value in (bad | good).items():
        monkeypatch.setenv(name, value)
    drop_thread_counts()
    assert not bad.keys() & os.environ.keys()
    assert {name: os.environ[name] for name in good} == good
