"""Handing work out: to worker processes by joblib, or to a dask cluster."""

import warnings
from collections.abc import Callable, Generator, Sequence
from contextlib import closing

import joblib
from joblib.externals.loky.process_executor import TerminatedWorkerError

from mjforage.base.errors import UserError
from mjforage.runs import cluster
from mjforage.runs.interrupts import (
    interrupts_held,
    start_quiet_tracker,
    suppress_replaced_workers,
    suppress_stopping_errors,
)
from mjforage.runs.jobs import Job, Task, Work
from mjforage.runs.workers import Workers

Results = Generator[tuple[int, str | None]]
"""The place of a finished task in the work, and what was said of it."""


def carried_out(
    call: Callable[[Job, Work], str | None], work: Sequence[Task[Work]], workers: Workers
) -> Generator[int]:
    """Have `run_chunk` or `record_episode` called, yielding the place of each task that is done.

    Raises `UserError` if a task fails for a reason that a user can mend, a worker was killed, or
    the cluster cannot be used. Finished chunks stay.
    """
    if not work:
        return
    done = _remote if workers.remote else _local
    with closing(done(call, work, workers)) as results:
        for place, error in results:
            if error is not None:
                raise UserError(error)
            yield place


def _remote(
    call: Callable[[Job, Work], str | None], work: Sequence[Task[Work]], workers: Workers
) -> Results:
    with cluster.connected(workers.scheduler) as client:
        yield from cluster.finished(client, call, work)


def _local(
    call: Callable[[Job, Work], str | None], work: Sequence[Task[Work]], workers: Workers
) -> Results:
    jobs = min(workers.jobs, len(work))
    # no arrays travel: nothing to map into memory, so no folder for that, which could stay behind
    parallel = joblib.Parallel(jobs, return_as="generator", max_nbytes=None, temp_folder=".")
    results = None
    if workers.jobs > 1:
        start_quiet_tracker()
        suppress_replaced_workers()
    try:
        with interrupts_held():
            results = parallel(joblib.delayed(call)(*task) for task in work)
        yield from enumerate(results)
    except TerminatedWorkerError as error:
        raise UserError(
            "a worker process was killed, perhaps for want of memory; run the same again with "
            "fewer jobs: finished chunks are kept"
        ) from error
    finally:
        if results is not None:
            # what is left is cancelled without a word
            with warnings.catch_warnings(), suppress_stopping_errors():
                warnings.simplefilter("ignore", UserWarning)
                results.close()
