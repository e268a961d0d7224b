"""Messages about variables that other people's libraries refuse."""

import os
import subprocess
import sys
from importlib.metadata import version

import numpy as np
import pytest

from mjforage.base.environment import refusal
from mjforage.base.errors import UserError
from mjforage.base.registry import trust

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
