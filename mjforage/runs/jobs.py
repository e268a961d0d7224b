"""Job of a worker: a chunk of episodes of a run, or an episode to be recorded.

A job is what all chunks of a run share. The map travels with it, so that every chunk is of the map
that `run.json` holds. Workers on other machines write into the same run folder, which all share.
"""

import json
import os
import socket
import threading
import time
import zipfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import cloudpickle
import numpy as np

from mjforage.base.atomic_files import write_bytes, write_errors
from mjforage.base.errors import UserError
from mjforage.base.registry import ImportSpec, blamed, trust, trusted
from mjforage.graph_planner.policies import create_policy
from mjforage.graph_planner.policies.registry import POLICIES, add_policy, policies_lent
from mjforage.mission.scoring import Scorer, chosen_metrics, import_specs_of
from mjforage.mission.setup import Setup
from mjforage.physics.worlds import create_mission
from mjforage.runs import cluster
from mjforage.runs.costs import Cost, Invocation
from mjforage.runs.decision_time import Timer, timed
from mjforage.runs.identity import outside_code_of, run_code, scenario_parts, versions
from mjforage.runs.recording import record
from mjforage.runs.replaying import as_logged
from mjforage.runs.selection import recording_file
from mjforage.runs.sources import users_modules
from mjforage.runs.storage import Chunk, RunFolder
from mjforage.runs.tables import frames
from mjforage.runs.workers import Workers, policy_import_specs
from mjforage.scenario.maps import GridMap
from mjforage.scenario.place import Place
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.scenario_file import canonical_json, scenario_from_tree, scenario_to_tree

PARENT_CHECK_S = 1.0


@dataclass(frozen=True)
class Job:
    """Common part of all chunks of a run, in a form that hashes and travels."""

    scenario_json: str
    map_name: str
    shape: tuple[int, int]  # of the map
    cells: bytes  # np.packbits of the map's cells
    place: Place | None
    seed: int
    folder: Path
    hash: str  # of the run
    invocation: Invocation
    parent: int | None  # process that asked for it and must outlive its workers; None: a cluster
    policies: tuple[str, ...] = ()
    worlds: tuple[str, ...] = ()
    metrics: tuple[str | ImportSpec, ...] = ()  # references, or import specs
    specs: tuple[tuple[str, ImportSpec], ...] = ()  # of policies, for other processes
    code: tuple[tuple[str, str], ...] = ()  # package or library -> hash or version, to agree with
    trusted: tuple[str, ...] = ()  # code that the user named, which weights may name
    objects: bytes = b""  # name -> class of policies that are objects, as cloudpickle has them

    @classmethod
    def of(
        cls,
        setup: Setup,
        folder: Path,
        info: Mapping[str, Any],
        metrics: Sequence[str],
        invocation: Invocation,
        workers: Workers,
    ) -> "Job":
        """Pack a setup; `info` is the content of `run.json`."""
        rows, columns = setup.grid.navigable.shape
        policies = tuple(info["policies"])
        worlds = info["worlds"] if workers.remote else None
        metric_classes = chosen_metrics(metrics)
        return cls(
            canonical_json(scenario_to_tree(setup.scenario)),
            setup.grid.name,
            (rows, columns),
            np.packbits(setup.grid.navigable).tobytes(),
            setup.grid.place,
            info["seed"],
            folder.resolve() if workers.elsewhere else folder,
            info["hash"],
            invocation,
            None if workers.remote else os.getpid(),
            policies,
            tuple(info["worlds"]),
            import_specs_of(metric_classes) if workers.elsewhere else tuple(metrics),
            policy_import_specs(policies) if workers.elsewhere else (),
            _code(policies, worlds, metric_classes, setup.scenario),
            trusted() if workers.elsewhere else (),
            _packed(policies) if workers.elsewhere else b"",
        )


def _code(
    policies: Sequence[str],
    worlds: Sequence[str] | None,
    metrics: Sequence[Callable[..., Any]],
    scenario: Scenario,
) -> tuple[tuple[str, str], ...]:
    """Code and versions that decide a run's numbers; only of what is not ours without worlds.

    Processes of one machine share all the rest.
    """
    classes = [*metrics, *scenario_parts(scenario)]
    if worlds is None:
        return tuple(outside_code_of(policies, classes).hashes.items())
    code = run_code(policies, worlds, classes, scenario.physics.device)
    return tuple({**versions(code), **code.hashes}.items())


def _packed(policies: Sequence[str]) -> bytes:
    """Policies that are objects, by value: worker processes could not import them.

    They go from this process to its workers and are in no file.
    """
    put = policies_lent(policies)
    try:
        return _by_value(put) if put else b""
    except Exception as error:
        raise UserError(
            f"policy {', '.join(put)}: cannot be sent to worker processes ({error}); compute with "
            "jobs=1, or let it hold no files, locks or generators"
        ) from error


def _by_value(put: object) -> bytes:
    """Bytes of objects, with code of a user's modules, which workers may have in another state."""
    modules = users_modules()
    for module in modules:
        cloudpickle.register_pickle_by_value(module)
    try:
        return bytes(cloudpickle.dumps(put))
    finally:
        for module in modules:
            cloudpickle.unregister_pickle_by_value(module)


class Episode(NamedTuple):
    """One episode of a run."""

    world: str
    policy: str
    number: int


Work = TypeVar("Work", Chunk, Episode)
Task = tuple[Job, Work]


@lru_cache(maxsize=4)
def _setup(job: Job) -> Setup:
    """The setup of a job, built (and in another process checked) once per process.

    Raises `UserError` if this is a worker that does not agree with the process that asked.
    """
    if job.parent is None:
        cluster.check_threads()
    trust(*job.trusted)
    for policy, spec in job.specs:
        add_policy(policy, spec)
    scenario = scenario_from_tree(json.loads(job.scenario_json), "scenario")
    if job.parent != os.getpid() and job.code:
        worlds = job.worlds if job.parent is None else None
        here = dict(_code(job.policies, worlds, chosen_metrics(job.metrics), scenario))
        cluster.check_code(job.code, here)
    packed = np.frombuffer(job.cells, np.uint8)
    navigable = np.unpackbits(packed, count=job.shape[0] * job.shape[1]).reshape(job.shape)
    setup = Setup(scenario, GridMap(job.map_name, navigable.astype(np.bool_), job.place))
    if job.parent is None:
        cluster.check_run(job.folder, job.hash, setup, job.metrics)
    return setup


@lru_cache(maxsize=1)
def _die_with(parent: int) -> None:
    """Let this worker end when its parent has gone, even by kill -9."""

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(PARENT_CHECK_S)
        os._exit(1)

    threading.Thread(target=watch, daemon=True, name="parent watch").start()


def is_recorded(folder: Path, one: Episode) -> bool:
    """True if a run folder holds a complete recording of an episode.

    Raises `UserError` if the folder cannot be read.
    """
    path = recording_file(folder, *one)
    with write_errors(path):
        return zipfile.is_zipfile(path)  # not if missing or truncated


@lru_cache(maxsize=1)
def _received(objects: bytes) -> dict[str, Any]:
    """Policies that the process which asked has packed."""
    found: dict[str, Any] = cloudpickle.loads(objects) if objects else {}
    return found


def _done(job: Job, do: Callable[[Setup], None]) -> str | None:
    """Do a part of a job.

    Returns: None, or the message of the error that a user can mend (exceptions with a cause do not
    survive the way between processes unharmed).
    """
    try:
        if job.parent is not None and os.getpid() != job.parent:
            _die_with(job.parent)
        with POLICIES.lent({} if job.parent == os.getpid() else _received(job.objects)):
            do(_setup(job))
    except UserError as error:
        return str(error)
    except (Exception, SystemExit) as error:
        if words := blamed(error):
            return words
        raise
    return None


def record_episode(job: Job, one: Episode) -> str | None:
    """Play an episode of a run whose tables are merged again, and record it; see `_done`.

    One that does not come out as it was logged, by other code perhaps, is not kept.
    """

    def do(setup: Setup) -> None:
        recording = record(setup, one.world, one.policy, job.seed, one.number)
        if as_logged(recording, RunFolder(job.folder)):
            write_bytes(recording_file(job.folder, *one), recording.content())

    return _done(job, do)


def run_chunk(job: Job, chunk: Chunk) -> str | None:
    """Play, score and store one chunk; see `_done`."""
    began = time.process_time(), time.perf_counter(), time.time()

    def do(setup: Setup) -> None:
        if job.parent is not None or not RunFolder(job.folder).has(chunk):
            _play(job, chunk, setup, began)  # else a lost worker made it

    return _done(job, do)


def _play(job: Job, chunk: Chunk, setup: Setup, began: tuple[float, float, float]) -> None:
    """Play, score and store a chunk. `began`: CPU time, a clock and the epoch's."""
    cpu_s, wall_s, began_s = began
    episodes = np.arange(chunk.first, chunk.first + chunk.count)
    mission = create_mission(setup, chunk.world)
    mission.reset(job.seed, episodes)
    scorer = Scorer(mission, chosen_metrics(job.metrics))
    timer = Timer()
    mission.run(timed(create_policy(chunk.policy), timer, chunk.count), (scorer,))
    log, scores = scorer.log, scorer.scores()
    tables = frames(setup, chunk.world, chunk.policy, episodes, log, scores)
    cost = Cost(
        chunk.world,
        chunk.policy,
        chunk.count,
        int(log.length.sum()),
        time.process_time() - cpu_s,
        time.perf_counter() - wall_s,
        began_s,
        f"{socket.gethostname()}-{os.getpid()}",
        **asdict(job.invocation),
        decide_s=timer.cpu_s,
        decisions=timer.decisions,
    )
    RunFolder(job.folder).write(chunk, tables, cost)
