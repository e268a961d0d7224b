"""What a worker is given and does: a chunk of episodes of a run, or an episode to be kept.

An assignment is (scenario, map, policies, worlds, folder), which all chunks of a run share. The map
travels with it, so that every chunk is of the map that `run.json` holds. Workers on other machines
write into the same run folder, which all must share.
"""

import json
import os
import socket
import threading
import time
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np

from mjforage.base.atomic_files import write_bytes, write_errors
from mjforage.base.errors import UserError
from mjforage.base.registry import ImportSpec, blamed, fault, is_ours, trust, trusted
from mjforage.graph_planner.policies import create_policy
from mjforage.graph_planner.policies.registry import add_policy, outside_class
from mjforage.mission.mission_metrics import Metric, Scorer, chosen_metrics, import_specs_of
from mjforage.mission.setup import Setup
from mjforage.physics.worlds import create_mission
from mjforage.runs import cluster
from mjforage.runs.costs import Cost, Invocation
from mjforage.runs.decision_time import Watch, watched
from mjforage.runs.episode_recording import Recording
from mjforage.runs.identity import code_of, policy_code, run_code, versions
from mjforage.runs.kept import replay_file
from mjforage.runs.recording import record
from mjforage.runs.replaying import as_logged
from mjforage.runs.storage import Chunk, RunFolder
from mjforage.runs.tables import frames
from mjforage.runs.under_way import Teller, telling
from mjforage.runs.workers import Workers, policy_import_specs
from mjforage.scenario.maps import GridMap
from mjforage.scenario.scenario_file import canonical_json, scenario_from_tree, scenario_to_tree

PARENT_CHECK_S = 1.0


@dataclass(frozen=True)
class Assignment:
    """What all chunks of a run have in common, in a form that hashes and travels."""

    scenario_json: str
    map_name: str
    shape: tuple[int, int]  # of the map
    cells: bytes  # np.packbits of the map's cells
    seed: int
    folder: Path
    hash: str  # of the run
    invocation: Invocation
    parent: int | None  # process that asked for it and must outlive its workers; None: a cluster
    policies: tuple[str, ...] = ()
    worlds: tuple[str, ...] = ()
    metrics: tuple[str | ImportSpec, ...] = ()  # references, or import specs
    places: tuple[tuple[str, ImportSpec], ...] = ()  # of policies, for other processes
    code: tuple[tuple[str, str], ...] = ()  # file or library -> hash or version, which must agree
    kept: tuple[int, ...] = ()  # episodes whose replays are kept along with their chunks
    trusted: tuple[str, ...] = ()  # code that the user named, which weights may name

    @classmethod
    def of(
        cls,
        setup: Setup,
        seed: int,
        folder: Path,
        info: Mapping[str, Any],
        metrics: Sequence[str],
        invocation: Invocation,
        workers: Workers,
        kept: tuple[int, ...] = (),
    ) -> "Assignment":
        """Pack a setup; `info` is the content of `run.json`."""
        rows, columns = setup.grid.navigable.shape
        policies = tuple(info["policies"])
        worlds = info["worlds"] if workers.remote else None
        taken = chosen_metrics(metrics)
        return cls(
            canonical_json(scenario_to_tree(setup.scenario)),
            setup.grid.name,
            (rows, columns),
            np.packbits(setup.grid.navigable).tobytes(),
            seed,
            folder.resolve() if workers.elsewhere else folder,
            info["hash"],
            invocation,
            None if workers.remote else os.getpid(),
            policies,
            tuple(info["worlds"]),
            import_specs_of(taken) if workers.elsewhere else tuple(metrics),
            policy_import_specs(policies) if workers.elsewhere else (),
            _facts(policies, worlds, taken),
            kept,
            trusted() if workers.elsewhere else (),
        )


def _facts(
    policies: Sequence[str], worlds: Sequence[str] | None, metrics: Sequence[type[Metric]]
) -> tuple[tuple[str, str], ...]:
    """Code and versions that decide a run's numbers; only of what is not ours without worlds.

    Processes of one machine share all the rest.
    """
    if worlds is None:
        code = policy_code(policies, outside=True).joined(code_of(metrics, outside=True))
        return tuple({**code.versions, **code.files}.items())
    code = run_code(policies, worlds, metrics)
    return tuple({**versions(code), **code.files}.items())


class Episode(NamedTuple):
    """One episode of a run."""

    world: str
    policy: str
    number: int


Work = TypeVar("Work", Chunk, Episode)
Task = tuple[Assignment, Work]


@lru_cache(maxsize=4)
def _setup(assignment: Assignment) -> Setup:
    """The setup of an assignment, built (and in another process checked) once per process.

    Raises
    ------
    UserError
        If this is a worker that does not agree with the process that asked.
    """
    if assignment.parent is None:
        cluster.check_threads()  # first: two threads that look for code disturb each other
    trust(*assignment.trusted)
    for policy, place in assignment.places:
        add_policy(policy, place)
    if assignment.parent != os.getpid() and assignment.code:
        worlds = assignment.worlds if assignment.parent is None else None
        here = dict(_facts(assignment.policies, worlds, chosen_metrics(assignment.metrics)))
        cluster.check_code(assignment.code, here)
    packed = np.frombuffer(assignment.cells, np.uint8)
    rows, columns = assignment.shape
    navigable = (
        np.unpackbits(packed, count=rows * columns).reshape(assignment.shape).astype(np.bool_)
    )
    scenario = scenario_from_tree(json.loads(assignment.scenario_json), "scenario")
    setup = Setup(scenario, GridMap(assignment.map_name, navigable))
    if assignment.parent is None:
        cluster.check_run(assignment.folder, assignment.hash, setup, assignment.metrics)
    return setup


@lru_cache(maxsize=1)
def _die_with(parent: int) -> None:
    """Let this worker end when its parent has gone, even by kill -9."""

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(PARENT_CHECK_S)
        os._exit(1)

    threading.Thread(target=watch, daemon=True, name="parent watch").start()


def replay_is_kept(folder: Path, one: Episode) -> bool:
    """Whether a run folder holds an episode's replay, whole.

    Raises
    ------
    UserError
        If the folder cannot be read.
    """
    path = replay_file(folder, *one)
    with write_errors(path):
        return zipfile.is_zipfile(path)  # not if missing or truncated


def _keep(folder: Path, replay: Recording) -> None:
    path = replay_file(folder, replay.world, replay.policy, replay.episode)
    with write_errors(path):
        path.parent.mkdir(exist_ok=True)
    write_bytes(path, replay.content())


def _joined_in(assignment: Assignment) -> Setup:
    """The setup, in a process that ends with the one that asked."""
    if assignment.parent is not None and os.getpid() != assignment.parent:
        _die_with(assignment.parent)
    return _setup(assignment)


def keep_replay(assignment: Assignment, one: Episode) -> str | None:
    """Play an episode of a run whose tables are merged once more, and keep it step by step.

    One that does not come out as it was logged, by other code perhaps, is not kept.

    Returns
    -------
    As `run_chunk`
    """
    try:
        setup = _joined_in(assignment)
        replay = record(setup, one.world, one.policy, assignment.seed, one.number)
        if as_logged(replay, RunFolder(assignment.folder)):
            _keep(assignment.folder, replay)
    except UserError as error:
        return str(error)
    except (Exception, SystemExit) as error:
        if words := blamed(error):
            return words
        raise
    return None


def run_chunk(assignment: Assignment, chunk: Chunk) -> str | None:
    """Play, score and store one chunk, and keep the replays of it that are known to be wanted.

    Returns
    -------
    None, or the message of the error that a user can mend (exceptions with a cause do not survive
    the way between processes unharmed)
    """
    began = time.process_time(), time.perf_counter(), time.time()
    run = RunFolder(assignment.folder)
    try:
        setup = _joined_in(assignment)
        if assignment.parent is None and run.has(chunk):
            return None  # made by a worker that was lost before it could tell
        with telling(run.under_way / chunk.name, chunk.count, setup.scenario.horizon) as teller:
            return _played(assignment, chunk, setup, teller, began)
    except UserError as error:
        return str(error)
    except (Exception, SystemExit) as error:
        if words := _fault_of_a_part(assignment, chunk, error):
            return words
        raise


def _played(
    assignment: Assignment,
    chunk: Chunk,
    setup: Setup,
    teller: Teller,
    began: tuple[float, float, float],
) -> str | None:
    """Play, score and store a chunk; as `run_chunk`. `began`: CPU time, a clock and the epoch's."""
    cpu_s, wall_s, began_s = began
    episodes = np.arange(chunk.first, chunk.first + chunk.count)
    mission = create_mission(setup, chunk.world)
    mission.reset(assignment.seed, episodes)
    scorer = Scorer(mission, chosen_metrics(assignment.metrics))
    watch = Watch()
    mission.run(watched(create_policy(chunk.policy), watch, chunk.count), (scorer, teller))
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
        **asdict(assignment.invocation),
        decide_s=watch.cpu_s,
        decisions=watch.decisions,
    )
    RunFolder(assignment.folder).write(chunk, tables, cost)
    for number in set(assignment.kept) & set(episodes.tolist()):
        one = Episode(chunk.world, chunk.policy, number)
        if not replay_is_kept(assignment.folder, one):
            _keep(assignment.folder, record(setup, *one[:2], assignment.seed, number))
    return None


def _fault_of_a_part(assignment: Assignment, chunk: Chunk, error: BaseException) -> str:
    """What a user's own policy or metric raised while a chunk was played; "" if neither did."""
    metrics = [one for one in chosen_metrics(assignment.metrics) if not is_ours(one)]
    references = [f"{one.__module__}:{one.__qualname__}" for one in metrics]
    parts = {f"policy {chunk.policy}": outside_class(chunk.policy)}
    for name, reference in (parts | {f"metric {one}": one for one in references}).items():
        package = reference.partition(":")[0].partition(".")[0] if ":" in reference else ""
        if words := fault(error, package) if package else "":
            last = chunk.first + chunk.count - 1
            return (
                f"{name}: raised {words}, in episodes {chunk.first} to {last} of world "
                f"{chunk.world}; mend it (the checks of mjforage.testing show the whole traceback)"
            )
    return blamed(error)
