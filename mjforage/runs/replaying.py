"""An episode of a finished run, simulated again and checked against its logs."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import polars as pl

from mjforage.base.errors import UserError
from mjforage.base.registry import ImportSpec
from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.graph_planner.policies.registry import (
    add_policy,
    check_policies,
    check_policy_trusted,
    has_policy,
    policy_label,
)
from mjforage.mission.mission import Observer
from mjforage.mission.setup import Setup
from mjforage.runs.episode_recording import Recording
from mjforage.runs.identity import hull_facts
from mjforage.runs.recording import record
from mjforage.runs.resuming import differences
from mjforage.runs.run_info import again, load_run, read_json
from mjforage.runs.storage import RunFolder
from mjforage.scenario.maps import GridMap, check_starts
from mjforage.scenario.scenario_file import scenario_from_tree


def replay_of_run(
    folder: Path,
    world: str | None,
    policy: str | None,
    episode: int,
    observers: tuple[Observer, ...] = (),
) -> Recording:
    """Simulate one logged episode again.

    The folder may be anybody's: of the policies that it names only those are played that ship,
    that an installed package brings, or whose code the user has named (`extensions.trust`).

    Parameters
    ----------
    folder : complete run folder
    world, policy : names; None for the run's first
    episode : number
    observers : who sees every step of it besides

    Raises
    ------
    UserError
        If the run does not hold that episode, its policy is of code that is not trusted, or the
        episode does not come out as it was logged.
    """
    run = load_run(folder / "run.json")
    policy, world = policy or run.policies[0], world or run.worlds[0]
    policy = policy if policy in run.policies else policy_label(policy)
    if policy not in run.policies or world not in run.worlds or not 0 <= episode < run.episodes:
        raise UserError(
            f"{folder}: no episode {episode} of {policy} in world {world}; it holds episodes 0 to "
            f"{run.episodes - 1} of {', '.join(run.policies)} in {', '.join(run.worlds)}"
        )
    where = str(folder / "run.json")
    _known(policy, run.classes.get(policy, ""), where)
    check_policies([policy])
    setup = Setup(
        scenario_from_tree(dict(run.scenario), where), GridMap(run.map.name, run.map.cells)
    )
    check_starts(setup.start_cells, run.map.cells, where, run.map.name)
    replay = record(setup, world, policy, run.seed, episode, observers)
    if not as_logged(replay, RunFolder(folder)):
        raise UserError(
            f"{folder}: episode {replay.episode} of {replay.policy} does not come out as logged: "
            f"{_cause(folder, setup, run.worlds)}"
        )
    names = tuple(agent.name for agent in run.agents)
    if len(names) != len(setup.fleet) or len(set(names)) != len(names):
        raise UserError(
            f"{where}: agents {', '.join(names)}: its fleet is {len(setup.fleet)} vessels of "
            f"different names; {again(folder)}"
        )
    return replace(replay, names=names)


def _known(policy: str, place: str, where: str) -> None:
    """Let a policy of a run be known here, if its code is trusted.

    Parameters
    ----------
    place : package.module:Class, as the run says: its name may be one that only that registers
    """
    check_policy_trusted(policy, where, place)
    if place and not has_policy(policy):
        add_policy(policy, ImportSpec(place, ""))


def _cause(folder: Path, setup: Setup, worlds: Sequence[str]) -> str:
    """What is no longer as it was when a run was made, and the remedy."""
    here = {"hulls": hull_facts(setup, worlds)}
    found = differences(read_json(folder / "run.json"), here, here)
    if found:
        words = "; ".join(one.words for one in found)
        return f"{words}; give the file its numbers back, or {again(folder)} with --fresh"
    return f"it was made with other versions or code (see run.json); {again(folder)}"


def as_logged(replay: Recording, run: RunFolder) -> bool:
    """Whether the agents' positions are those of the log, to the bit.

    Raises
    ------
    UserError
        If the log is missing, truncated or foreign.
    """
    logged = (
        run.table("agents")
        .filter(
            (pl.col("world") == replay.world)
            & (pl.col("policy") == replay.policy)
            & (pl.col("episode") == replay.episode)
        )
        .sort("step", "agent")
        .select("x_m", "y_m")
        .to_numpy()
    )
    graph = navigation_graph(replay.navigable, replay.pitch_m, corner_cutting=True)
    anew = graph.metres(replay.agent_rc).astype(np.float32).reshape(-1, 2)
    return bool(logged.shape == anew.shape and (logged == anew).all())
