"""An episode of a finished run: its recording, or the episode played again, checked by its logs."""

import zipfile
from pathlib import Path

import numpy as np

from mjforage.base.errors import UserError
from mjforage.base.registry import ImportSpec
from mjforage.forcing.record_files import read_record
from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.graph_planner.policies.registry import (
    add_policy,
    check_policies,
    check_policy_trusted,
    has_policy,
    policy_label,
)
from mjforage.mission.setup import Setup
from mjforage.runs.episode_recording import Recording
from mjforage.runs.recording import record
from mjforage.runs.run_info import AGAIN, RunInfo, load_run
from mjforage.runs.selection import recording_file
from mjforage.runs.storage import RunFolder
from mjforage.scenario.maps import check_starts
from mjforage.scenario.scenario_file import scenario_from_tree


def recording_of_run(
    folder: Path,
    world: str | None,
    policy: str | None,
    episode: int,
) -> Recording:
    """A logged episode: as it was recorded, or played again if it was not.

    The folder may be anybody's: of the policies that it names only those are played that ship, that
    an installed package brings, or whose code the user has named (`registry.trust`). Raises
    `UserError` if the run does not hold that episode, its policy is of code that is not trusted, or
    the episode does not come out as it was logged.

    Parameters
    ----------
    folder : complete run folder
    world, policy : names; None for the run's first
    episode : number
    """
    run = load_run(folder / "run.json")
    policy, world = policy or run.policies[0], world or run.worlds[0]
    policy = policy if policy in run.policies else policy_label(policy)
    if policy not in run.policies or world not in run.worlds or not 0 <= episode < run.episodes:
        raise UserError(
            f"{folder}: no episode {episode} of {policy} in world {world}; it holds episodes 0 to "
            f"{run.episodes - 1} of {', '.join(run.policies)} in {', '.join(run.worlds)}"
        )
    file = recording_file(folder, world, policy, episode)
    if zipfile.is_zipfile(file):
        recording = Recording.load(file)
    else:
        setup = _setup(run, policy, str(folder / "run.json"))
        recording = record(setup, world, policy, run.seed, episode)
    if not as_logged(recording, RunFolder(folder)):
        raise UserError(
            f"{folder}: episode {episode} of {policy} does not come out as logged: it was made "
            "with other versions, code or vessels (see run.json), or the policy draws numbers that "
            f'hang on no seed; {AGAIN} with resume="fresh" (--fresh)'
        )
    return recording


def _setup(run: RunInfo, policy: str, where: str) -> Setup:
    """Scenario and map of a run, one policy of which is to be played, if its code is trusted."""
    place = run.classes.get(policy, "")  # its name may be one that only its module registers
    check_policy_trusted(policy, where, place)
    if place and not has_policy(policy):
        add_policy(policy, ImportSpec(place, ""))
    check_policies([policy])
    scenario = scenario_from_tree(dict(run.scenario), where)
    setup = Setup(scenario, run.map.grid)
    check_starts(setup.start_cells, run.map.cells, where, run.map.name)
    if (file := scenario.weather.file) is not None:
        _check_record(file, run.map.record)
    return setup


def _check_record(file: str, sha256: str) -> None:
    """Refuse a record that is not where it was, or is another; raises `UserError`."""
    if not Path(file).is_file():
        raise UserError(
            f"record {file}: is not there; put back the file that the run played, of SHA-256 "
            f"{sha256}"
        )
    if (found := read_record(file).sha256) != sha256:
        raise UserError(
            f"record {file}: has changed; put back the file that the run played, of SHA-256 "
            f"{sha256}, not {found}"
        )


def as_logged(recording: Recording, run: RunFolder) -> bool:
    """True if the agents' positions are those of the log, to the bit.

    Raises `UserError` if the log is missing, truncated or foreign.
    """
    logged = (
        run.table("agents")
        .filter(world=recording.world, policy=recording.policy, episode=recording.episode)
        .sort("step", "agent")
        .select("x_m", "y_m")
        .to_numpy()
    )
    graph = navigation_graph(recording.navigable, recording.pitch_m, corner_cutting=True)
    anew = graph.metres(recording.agent_rc).astype(np.float32).reshape(-1, 2)
    return bool(logged.shape == anew.shape and (logged == anew).all())
