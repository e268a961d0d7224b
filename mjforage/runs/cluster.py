"""dask clusters: reaching one, what its workers must agree with, and noticing that it is lost.

Nothing here distributes work: joblib does, on its dask backend.
"""

import _thread
import asyncio
import importlib.util
import logging
import signal
import socket
import threading
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import CancelledError
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import joblib

from mjforage.core.errors import UserError
from mjforage.core.mission import Setup
from mjforage.runs.identity import run_info
from mjforage.runs.interrupts import interrupts_held
from mjforage.runs.run_info import read_json

PROTOCOLS = ("tcp", "tls")
PATIENCE_S = 20.0  # for a scheduler to answer, and for its first worker
WATCH_S = 0.5
NEVER_DONE = ("error", "cancelled", "lost")  # states of a task
REMEDY = "run the same command again: finished chunks are kept"


def check_address(scheduler: str) -> None:
    """Refuse what is no address of a scheduler, for which dask would wait, and then fail unclearly.

    Raises
    ------
    UserError
        Naming what is wrong with it.
    """
    fault = _fault(scheduler)
    if fault:
        raise UserError(
            f"--scheduler {scheduler}: {fault}; give the address that `dask scheduler` prints, "
            "such as tcp://host:8786"
        )


def _fault(scheduler: str) -> str:
    protocol, found, rest = scheduler.partition("://")
    if not found or protocol not in PROTOCOLS:
        return f"does not begin with {', '.join(f'{name}://' for name in PROTOCOLS)}"
    try:
        parts = urlsplit(f"//{rest}")
        host, port = parts.hostname, parts.port
    except ValueError as error:
        return str(error)
    if not host or any(sign.isspace() for sign in rest):
        return "has no host"
    if not port:
        return "has no port"
    return "has more than host and port" if parts.netloc != rest.rstrip("/") else ""


@contextmanager
def connected(scheduler: str, local_cluster: int) -> Iterator[Any]:
    """Give a dask client of a scheduler, or of a cluster of worker processes started here.

    Parameters
    ----------
    scheduler : address, such as tcp://host:8786; empty for a cluster of this machine's
    local_cluster : worker processes of that cluster

    Raises
    ------
    UserError
        If dask is missing, or the scheduler or its workers cannot be reached or are lost.
    """
    check_dask()
    with ExitStack() as open_things:
        with interrupts_held():
            client = _client(scheduler, local_cluster, open_things)
        with watched(client):
            yield client


def _client(scheduler: str, local_cluster: int, open_things: ExitStack) -> Any:
    import distributed as untyped

    distributed: Any = untyped  # its constructors have no types

    for name in [name for name in logging.root.manager.loggerDict if name[:11] == "distributed"]:
        logging.getLogger(name).setLevel(logging.CRITICAL)  # lost workers are no news here
    address: Any = scheduler
    if not scheduler:
        cluster = distributed.LocalCluster(
            n_workers=local_cluster,
            threads_per_worker=1,
            dashboard_address="127.0.0.1:0",  # any free port: other clusters may be running here
            silence_logs=logging.CRITICAL,
        )
        address = open_things.enter_context(cluster)
    try:
        if scheduler:
            asyncio.run(_answer(scheduler))
        client = distributed.Client(address, timeout=PATIENCE_S, set_as_default=False)
        open_things.callback(_close, client)
        client.wait_for_workers(1, timeout=PATIENCE_S)
    except (OSError, TypeError, ValueError, ImportError) as error:  # time-outs included
        reason = " ".join(str(error).split()) or type(error).__name__
        raise UserError(
            f"scheduler {scheduler}: no answer or no worker within {PATIENCE_S:g} s ({reason}); "
            "start `dask scheduler` there and `dask worker ADDRESS --nthreads 1` on every machine"
        ) from error
    return client


def check_dask() -> None:
    """Raise UserError where dask is not installed."""
    if importlib.util.find_spec("distributed") is None:
        raise UserError("dask is not installed; pip install 'mjforage[cluster]'")


async def _answer(scheduler: str) -> None:
    """Raise TimeoutError unless dask answers: a client would wait for ever for another program."""
    import distributed as untyped

    distributed: Any = untyped  # as in `_client`
    options = distributed.Security().get_connection_args("client")
    asked = distributed.comm.connect(scheduler, timeout=PATIENCE_S, **options)
    (await asyncio.wait_for(asked, PATIENCE_S)).abort()


def _close(client: Any) -> None:
    with suppress(OSError, RuntimeError):
        client.close(timeout=2)


_STOP = getattr(signal, "SIGUSR1", signal.SIGINT)


@contextmanager
def watched(client: Any) -> Iterator[None]:
    """End the block with a clear error once a task can never be done; joblib would wait for it.

    The block ends as by Ctrl-C, through a signal of its own: background jobs ignore that of Ctrl-C.
    """
    over, found = threading.Event(), []

    def watch() -> None:
        while not over.wait(WATCH_S):
            trouble = _trouble(client)
            if trouble is not None:
                found.append(trouble)
                _thread.interrupt_main(_STOP)
                return

    def stop(number: int, frame: object) -> None:
        raise KeyboardInterrupt

    watcher = threading.Thread(target=watch, daemon=True, name="cluster watch")
    before = signal.signal(_STOP, stop)
    watcher.start()
    try:
        yield
    except KeyboardInterrupt:
        if found:
            raise UserError(found[0]) from None
        raise
    except (CancelledError, RuntimeError, OSError) as error:  # joblib may notice before the watch
        trouble = found[0] if found else _trouble(client)
        if trouble is None:
            raise
        raise UserError(trouble) from error
    finally:
        over.set()
        watcher.join()
        signal.signal(_STOP, before)


def _trouble(client: Any) -> str | None:
    if client.status != "running":
        return f"scheduler {client.scheduler.address}: connection lost; {REMEDY}"
    for state in list(client.futures.values()):
        if state.status in NEVER_DONE:
            error = getattr(state, "exception", None)
            reason = state.status if error is None else type(error).__name__
            if reason == "KilledWorker":
                reason = "it killed several workers, perhaps for want of memory"
            return f"a chunk was given up by the cluster ({reason}); {REMEDY}"
    return None


def parallel(client: Any) -> joblib.Parallel:
    """Give joblib with the dask backend: a task is a chunk, and later workers find tasks left."""
    from joblib._dask import DaskDistributedBackend  # it loads dask

    class Backend(DaskDistributedBackend):  # type: ignore[misc]
        """Also for a cluster of one worker, in whose stead joblib would compute here."""

        def effective_n_jobs(self, n_jobs: int) -> int:
            return max(2, int(super().effective_n_jobs(n_jobs)))

    return joblib.Parallel(
        backend=Backend(client=client, wait_for_workers_timeout=PATIENCE_S),
        return_as="generator",
        batch_size=1,
        pre_dispatch="all",
    )


def cores(client: Any) -> int:
    """Worker threads of the cluster now; mjforage asks for one per worker."""
    return int(sum(client.ncores().values()))


def check_code(asked: Iterable[tuple[str, str]], here: Mapping[str, str]) -> None:
    """Check in a worker that it runs what the asking process runs.

    Parameters
    ----------
    asked, here : file or library -> hash or version

    Raises
    ------
    UserError
        Naming the machine and the difference.
    """
    for name, there in asked:
        if here.get(name) != there:
            raise UserError(
                f"worker on {socket.gethostname()}: {name} is {here.get(name)}, but {there} where "
                "the command was given; install the same on all machines"
            )


def check_threads() -> None:
    """Check in a worker of a cluster that it computes one chunk at a time.

    Raises
    ------
    UserError
        Naming the machine and its threads.
    """
    from distributed import get_worker

    with suppress(ValueError):  # not in a worker
        threads = get_worker().state.nthreads
        if threads != 1:
            raise UserError(
                f"worker on {socket.gethostname()}: has {threads} threads; start it with "
                "--nthreads 1, and several workers for several cores"
            )


def check_run(folder: Path, run_hash: str, setup: Setup) -> None:
    """Check in a worker that it shares the run folder, and reads the same scenario and hulls.

    Raises
    ------
    UserError
        Naming the machine, and the folder or the scenario.
    """
    here, file = socket.gethostname(), folder / "run.json"
    if not file.is_file():
        raise UserError(
            f"worker on {here}: {file} is not there; --out must lie on a disk that all machines "
            "share, under the same path"
        )
    info = read_json(file)
    own = run_info(setup, info["policies"], info["worlds"], 0, 0)["hash"]
    if not run_hash == own == info["hash"]:
        raise UserError(
            f"worker on {here}: scenario and hulls have the hash {own} there, {run_hash} where the "
            f"command was given and {info['hash']} in {file}; give all machines the same files"
        )
