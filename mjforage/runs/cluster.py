"""dask clusters: connection, distribution of work, and checks of the workers."""

import asyncio
import logging
import re
import socket
import time
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from mjforage.base.errors import UserError
from mjforage.base.extras import require
from mjforage.base.registry import ImportSpec
from mjforage.graph_planner.policies.registry import check_policy_trusted
from mjforage.mission.setup import Setup
from mjforage.runs.identity import run_info
from mjforage.runs.interrupts import interrupts_held
from mjforage.runs.run_info import load_run

_ADDRESS = re.compile(r"(tcp|tls)://[^\s:/@]+:\d+|(tcp|tls)://\[[\da-f:]+\]:\d+")
PATIENCE_S = 20.0  # for a scheduler to answer, and for its first worker
POLL_S = 0.02
REMEDY = "run the same again: finished chunks are kept"


def check_address(scheduler: str) -> None:
    """Refuse a malformed address, for which dask would wait and fail unclearly; `UserError`."""
    if not _ADDRESS.fullmatch(scheduler):
        raise UserError(
            f"scheduler {scheduler}: is no address; give the one that `dask scheduler` prints, "
            "such as tcp://host:8786"
        )


@contextmanager
def connected(scheduler: str) -> Iterator[Any]:
    """Give a dask client of a scheduler.

    Raises `UserError` if dask is missing, or the scheduler or its workers cannot be reached or are
    lost.

    `scheduler`: address, such as tcp://host:8786.
    """
    check_dask()
    with interrupts_held():
        client = _client(scheduler)
    try:
        yield client
    finally:
        with suppress(OSError, RuntimeError):
            client.close(timeout=2)


def _client(scheduler: str) -> Any:
    import distributed as untyped

    distributed: Any = untyped  # its constructors have no types

    for name in [name for name in logging.root.manager.loggerDict if name[:11] == "distributed"]:
        logging.getLogger(name).setLevel(logging.CRITICAL)  # lost workers are no news here
    logging.getLogger("tornado.application").setLevel(logging.CRITICAL)  # nor lost connections
    try:
        asyncio.run(_answer(scheduler))
        client = distributed.Client(scheduler, timeout=PATIENCE_S, set_as_default=False)
    except (OSError, TypeError, ValueError, ImportError) as error:  # time-outs included
        reason = " ".join(str(error).split()) or type(error).__name__
        raise UserError(
            f"scheduler {scheduler}: no answer within {PATIENCE_S:g} s ({reason}); start "
            "`dask scheduler` there and `dask worker ADDRESS --nthreads 1` on every machine"
        ) from error
    try:
        client.wait_for_workers(1, timeout=PATIENCE_S)
    except OSError as error:  # a time-out
        client.close(timeout=2)
        raise UserError(
            f"scheduler {scheduler}: answers, but has no worker within {PATIENCE_S:g} s; start "
            f"`dask worker {scheduler} --nthreads 1` on every machine"
        ) from error
    return client


def check_dask() -> None:
    """Raise UserError where dask is not installed."""
    require("dask", "distributed")


async def _answer(scheduler: str) -> None:
    """Raise TimeoutError unless dask answers: a client would wait for ever for another program."""
    import distributed as untyped

    distributed: Any = untyped  # as in `_client`
    options = distributed.Security().get_connection_args("client")
    asked = distributed.comm.connect(scheduler, timeout=PATIENCE_S, **options)
    (await asyncio.wait_for(asked, PATIENCE_S)).abort()


def finished(
    client: Any, function: Callable[..., str | None], work: Sequence[tuple[Any, ...]]
) -> Generator[tuple[int, str | None]]:
    """Have the cluster carry out tasks, and give the place and result of each as it is done.

    Results that were given are no longer kept, or the cluster would carry a task out once more when
    the worker that had it dies. Raises `UserError` if the cluster is lost, or cannot carry out a
    task.

    Parameters
    ----------
    client : of `connected`
    function : called with the words of a task; workers that come later find tasks left
    work : tasks
    """
    import distributed as untyped

    distributed: Any = untyped  # as in `_client`
    futures = client.map(function, *zip(*work, strict=True), pure=False)
    places = {future.key: place for place, future in enumerate(futures)}
    done = distributed.as_completed(
        futures, loop=client.loop, with_results=True, raise_errors=False
    )
    del futures
    for _ in places:
        while not done.has_ready():  # on a lost scheduler it would wait for ever
            _check_connection(client)
            time.sleep(POLL_S)
        future, result = next(done)
        if future.status != "finished":
            _check_connection(client)
            raise UserError(
                f"a chunk was given up by the cluster ({_reason(future.status, result)}); {REMEDY}"
            )
        place = places[future.key]
        del future
        yield place, result


def _check_connection(client: Any) -> None:
    if client.status != "running":
        raise UserError(
            f"scheduler {client.scheduler.address}: connection lost; start it again, its workers, "
            f"too, and {REMEDY}"
        )


def _reason(status: str, result: Any) -> str:
    """Reason why a task failed: the result is its exception, with type and traceback, if any."""
    name = result[0].__name__ if status == "error" else status
    if name == "KilledWorker":
        return "it killed several workers, perhaps for want of memory"
    return f"{name}: {str(result[1]).partition(chr(10))[0]}" if status == "error" else name


def cores(client: Any) -> int:
    """Number of worker threads of the cluster now; mjforage expects one per worker."""
    return int(sum(client.ncores().values()))


def check_code(asked: Iterable[tuple[str, str]], here: Mapping[str, str]) -> None:
    """Check in a worker that it runs the same code as the asking process.

    Raises `UserError`, naming the machine and the difference.

    `asked`, `here`: file or library -> hash or version.
    """
    for name, there in asked:
        if here.get(name) != there:
            raise UserError(
                f"worker on {socket.gethostname()}: {name} is {here.get(name)}, but {there} where "
                "the run was started; install the same on all machines"
            )


def check_threads() -> None:
    """Check in a worker of a cluster that it computes one chunk at a time.

    Raises `UserError`, naming the machine and its threads.
    """
    from distributed import get_worker

    with suppress(ValueError):  # not in a worker
        threads = get_worker().state.nthreads
        if threads != 1:
            raise UserError(
                f"worker on {socket.gethostname()}: has {threads} threads; start it with "
                "--nthreads 1, and several workers for several cores"
            )


def check_run(
    folder: Path, run_hash: str, setup: Setup, metrics: Sequence[str | ImportSpec] = ()
) -> None:
    """Check in a worker that it shares the run folder, and reads the same scenario and hulls.

    Raises `UserError`, naming the machine, and the folder or the scenario.
    """
    here, file = socket.gethostname(), folder / "run.json"
    if not file.is_file():
        raise UserError(
            f"worker on {here}: {file} is not there; the run folder must lie on a disk that all "
            "machines share, under the same path"
        )
    run = load_run(file)
    for policy in run.policies:
        check_policy_trusted(policy, str(file))
    own = run_info(setup, run.policies, run.worlds, 0, 0, metrics)["hash"]
    if not run_hash == own == run.hash:
        raise UserError(
            f"worker on {here}: scenario and hulls have the hash {own} there, {run_hash} where the "
            f"run was started and {run.hash} in {file}; give all machines the same files"
        )
