"""Carrying out chunks of episodes, here or in worker processes.

The unit of work is (scenario, policy, world, chunk of episodes) -> one folder; joblib distributes
it.
"""

import json
import logging
import os
import threading
import time
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

import joblib
import numpy as np

from graph_planner.policies import create_policy
from mjforage.episode_log import EpisodeLog
from mjforage.errors import UserError
from mjforage.mission import Mission, Setting
from mjforage.scenario_file import canonical_json, scenario_from_tree, scenario_to_tree
from mjforage.scoring import score
from mjforage.storage import Chunk, RunFolder
from mjforage.tables import frames

PARENT_CHECK_S = 1.0


@lru_cache(maxsize=4)
def _setting(scenario_json: str) -> Setting:
    return Setting.of(scenario_from_tree(json.loads(scenario_json), "scenario"))


@lru_cache(maxsize=1)
def _die_with(parent: int) -> None:
    """Let this worker end when its parent has gone, even by kill -9."""

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(PARENT_CHECK_S)
        os._exit(1)

    threading.Thread(target=watch, daemon=True, name="parent watch").start()


def run_chunk(scenario_json: str, seed: int, chunk: Chunk, folder: Path, parent: int) -> str | None:
    """Play, score and store one chunk.

    Parameters
    ----------
    scenario_json : canonical form of the scenario
    seed : the run's seed
    chunk : which episodes
    folder : the run folder
    parent : process that asked for it

    Returns
    -------
    None, or the message of the error that a user can mend (exceptions with a cause do not survive
    the way between processes unharmed)
    """
    if os.getpid() != parent:
        _die_with(parent)
        logging.getLogger("mjforage").setLevel(logging.ERROR)  # the parent has said it already
    started = time.process_time()
    try:
        setting = _setting(scenario_json)
        episodes = np.arange(chunk.first, chunk.first + chunk.count)
        mission = Mission(setting, chunk.world)
        mission.reset(seed, episodes)
        log = EpisodeLog(mission)
        mission.run(create_policy(chunk.policy), (log,))
        scores = score(log, setting.fleet, setting.scenario.horizon)
        tables = frames(setting, chunk.world, chunk.policy, episodes, log, scores)
        timings = {"cpu_s": time.process_time() - started, "steps": float(log.length.sum())}
        RunFolder(folder).write(chunk, tables, timings)
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
        If a chunk fails for a reason that a user can mend. Finished chunks stay.
    """
    scenario_json = canonical_json(scenario_to_tree(setting.scenario))
    parallel = joblib.Parallel(n_jobs=min(jobs, max(1, len(chunks))), return_as="generator")
    tasks = (
        joblib.delayed(run_chunk)(scenario_json, seed, chunk, folder, os.getpid())
        for chunk in chunks
    )
    for chunk, error in zip(chunks, parallel(tasks), strict=True):
        if error is not None:
            raise UserError(error)
        yield chunk.count
