"""Worker processes that are killed say nothing of their own."""

import subprocess
import sys
import warnings

import pytest

from mjforage.runs.interrupts import suppress_replaced_workers

KILL_WHILE_WORK_IS_QUEUED = """
import sys, threading, time
from contextlib import nullcontext
from joblib.externals.loky import get_reusable_executor
from mjforage.runs.interrupts import suppress_stopping_errors, start_quiet_tracker
start_quiet_tracker()
executor = get_reusable_executor(2)
running = [executor.submit(time.sleep, 100) for _ in range(20)]
while sum(future.running() for future in running) < 2 or executor._call_queue.full():
    time.sleep(0.01)
with suppress_stopping_errors() if sys.argv[1] == "held" else nullcontext():
    executor.shutdown(kill_workers=True)
def fail():
    raise KeyError(sys.argv[1])
with suppress_stopping_errors():
    other = threading.Thread(target=fail)
    other.start()
    other.join()
"""
"""Both workers have work and the queue towards them has room, but more waits to be handed out."""


@pytest.mark.parametrize(("held", "tracebacks"), [("held", 1), ("loose", 2)])
def test_killed_workers_leave_no_traceback_and_other_errors_are_told(
    held: str, tracebacks: int
) -> None:
    done = subprocess.run(
        [sys.executable, "-c", KILL_WHILE_WORK_IS_QUEUED, held],
        capture_output=True,
        text=True,
        timeout=120.0,
        check=False,
    )
    assert done.stderr.count("Traceback") == tracebacks
    assert done.stderr.endswith(f"KeyError: '{held}'\n")


def test_only_the_warning_of_a_replaced_worker_is_dropped() -> None:
    words = [
        "A worker stopped while some jobs were given to the executor. This can be caused by a too "
        "short worker timeout or by a memory leak.",
        "something else",
    ]
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        suppress_replaced_workers()
        for one in words:
            warnings.warn(one, UserWarning, stacklevel=1)
    assert [str(one.message) for one in said] == ["something else"]
