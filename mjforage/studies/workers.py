"""Carrying out chunks of episodes, here or in worker processes.

The unit of work is (scenario, map, policy, world, chunk of episodes) -> one folder; joblib
distributes it. The map travels with the work, so that every chunk is of the map that `run.json`
holds.
"""

import json
import os
import signal
import threading
import time
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from multiprocessing import resource_tracker
from pathlib import Path

import joblib
import numpy as np
from joblib.externals.loky.process_executor import TerminatedWorkerError

from graph_planner.policies import create_policy
from mjforage.episode_log import EpisodeLog
from mjforage.errors import UserError
from mjforage.maps import GridMap
from mjforage.mission import Mission, Setting
from mjforage.scenario_file import canonical_json, scenario_from_tree, scenario_to_tree
from mjforage.scoring import score
from mjforage.storage import Chunk, RunFolder
from mjforage.tables import frames

PARENT_CHECK_S = 1.0


@dataclass(frozen=True)
class Order:
    """What all chunks of a run have in common, in a form that hashes and travels."""

    scenario_json: str
    map_name: str
    shape: tuple[int, int]  # of the map
    cells: bytes  # np.packbits of the map's cells
    seed: int
    folder: Path
    parent: int  # process that asked for it

    @classmethod
    def of(cls, setting: Setting, seed: int, folder: Path) -> "Order":
        """Pack a setting."""
        rows, columns = setting.grid.navigable.shape
        scenario_json = canonical_json(scenario_to_tree(setting.scenario))
        cells = np.packbits(setting.grid.navigable).tobytes()
        name = setting.grid.name
        return cls(scenario_json, name, (rows, columns), cells, seed, folder, os.getpid())


@lru_cache(maxsize=4)
def _setting(order: Order) -> Setting:
    """The setting of an order, built once per process."""
    packed = np.frombuffer(order.cells, np.uint8)
    rows, columns = order.shape
    navigable = np.unpackbits(packed, count=rows * columns).reshape(order.shape).astype(np.bool_)
    scenario = scenario_from_tree(json.loads(order.scenario_json), "scenario")
    return Setting(scenario, GridMap(order.map_name, navigable))


@lru_cache(maxsize=1)
def _die_with(parent: int) -> None:
    """Let this worker end when its parent has gone, even by kill -9."""

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(PARENT_CHECK_S)
        os._exit(1)

    threading.Thread(target=watch, daemon=True, name="parent watch").start()


@contextmanager
def _interrupts_held() -> Iterator[None]:
    """Hold Ctrl-C back; processes that start meanwhile never get it (the parent ends them).

    Without this, Ctrl-C in a terminal makes every worker print a traceback of its own.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    resource_tracker.ensure_running()  # to start it among the workers would undo the next line
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _started(parallel: joblib.Parallel, tasks: Iterable[object]) -> Iterator[Iterator[str | None]]:
    """Start tasks; at the end cancel those that are left without a word."""
    results = None
    try:
        with _interrupts_held():
            results = parallel(tasks)
        yield results
    finally:
        if results is not None:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", UserWarning)
                results.close()


def run_chunk(order: Order, chunk: Chunk) -> str | None:
    """Play, score and store one chunk.

    Returns
    -------
    None, or the message of the error that a user can mend (exceptions with a cause do not survive
    the way between processes unharmed)
    """
    if os.getpid() != order.parent:
        _die_with(order.parent)
    started = time.process_time()
    try:
        setting = _setting(order)
        episodes = np.arange(chunk.first, chunk.first + chunk.count)
        mission = Mission(setting, chunk.world)
        mission.reset(order.seed, episodes)
        log = EpisodeLog(mission)
        mission.run(create_policy(chunk.policy), (log,))
        scores = score(log, setting.fleet, setting.scenario.horizon)
        tables = frames(setting, chunk.world, chunk.policy, episodes, log, scores)
        timings = {"cpu_s": time.process_time() - started, "steps": float(log.length.sum())}
        RunFolder(order.folder).write(chunk, tables, timings)
    except UserError as error:
        return str(error)
    return None


def run_chunks(
    setting: Setting, seed: int, chunks: list[Chunk], folder: Path, jobs: int
) -> Iterator[int]:
    """Carry out chunks, yielding the number of episodes of each one that is finished.

    Parameters
    ----------
    jobs : worker processes; 1 stays in this process

    Raises
    ------
    UserError
        If a chunk fails for a reason that a user can mend, or a worker was killed. Finished chunks
        stay.
    """
    order = Order.of(setting, seed, folder)
    parallel = joblib.Parallel(n_jobs=min(jobs, max(1, len(chunks))), return_as="generator")
    tasks = (joblib.delayed(run_chunk)(order, chunk) for chunk in chunks)
    try:
        with _started(parallel, tasks) as results:
            for chunk, error in zip(chunks, results, strict=True):
                if error is not None:
                    raise UserError(error)
                yield chunk.count
    except TerminatedWorkerError as error:
        raise UserError(
            "a worker process was killed, perhaps for want of memory; run the same command again "
            "with fewer --jobs: finished chunks are kept"
        ) from error
