"""Recording one episode as a `Recording`, by playing it again from its seed."""

import itertools
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.forcing.record import begins_of
from mjforage.graph_planner.policies import create_policy
from mjforage.mission.item_classes import draw_classes
from mjforage.mission.mission import Mission, Observer
from mjforage.mission.setup import Setup
from mjforage.mission.trajectory import TrajectoryRecorder
from mjforage.physics.worlds import create_mission
from mjforage.runs.episode_recording import Recording
from mjforage.runs.knowledge_record import KnowledgeRecorder
from mjforage.scenario.debris import item_choices
from mjforage.scenario.vessel_files import hull_names


class _Recorder(Observer):
    """Recorder of the visible state of the first episode of a batch.

    Attributes
    ----------
    steps : of every step, by the names of `Recording`
    """

    def __init__(self) -> None:
        self.steps: list[dict[str, NDArray[Any]]] = []

    def see(self, mission: Mission) -> None:
        state, fleet, first = mission.state, mission.setup.fleet, np.zeros(1, np.int64)
        grid = mission.setup.graph.grid
        told = mission.moves.target if mission.moves else state.agent_node
        teams = fleet.discoverers, fleet.collectors
        by_scouts, by_foragers = (mission.times_seen(team, first)[0] > 0 for team in teams)
        now = {
            "agent_rc": state.agent_rc[0].astype(np.float32),
            "agent_target": told[0].astype(np.int32),
            "item_rc": state.item_rc[0].astype(np.float32),
            "item_present": state.item_node[0] >= 0,
            "belief": grid(mission.knowledge.belief[0]).astype(np.int16),
            "idleness": grid(mission.idleness(first)[0]).astype(np.float16),
            "in_view": grid(by_scouts + np.uint8(2) * by_foragers).astype(np.uint8),
        }
        self.steps.append(now)


def record(
    setup: Setup,
    world: str,
    policy: str | None,
    seed: int,
    episode: int,
) -> Recording:
    """Play one episode and keep all of it.

    Raises `UserError` if there is no such policy.

    Parameters
    ----------
    setup : scenario and map
    world, policy : names; without a policy nothing is played, and the start alone is kept
    seed, episode : seed of the run, number of the episode
    """
    trajectory, recorder = TrajectoryRecorder(), _Recorder()
    mission = create_mission(setup, world, trajectory)
    mission.reset(seed, np.array([episode], np.int64))
    by_agent = KnowledgeRecorder() if mission.exchange.link_log is not None else None
    observers = (recorder, *((by_agent,) if by_agent else ()))
    if policy is None:
        for observer in observers:
            observer.see(mission)
    else:
        mission.run(create_policy(policy), observers)
    choice, frames = setup.scenario.physics, trajectory.frames
    begins = begins_of(setup.scenario, mission.keys)
    rings = setup.grid.place.quays if setup.grid.place else ()
    edges = [(*a, *b) for ring in rings for a, b in itertools.pairwise(ring)]
    classes = draw_classes(mission.keys, mission.initial.item_node, item_choices(choice))
    seen: dict[str, Any] = {
        name: np.stack([step[name] for step in recorder.steps]) for name in recorder.steps[0]
    }
    if world == "graph":
        seen["agent_target"] = None
    return Recording(
        navigable=setup.grid.navigable,
        pitch_m=setup.scenario.map.pitch_m,
        horizon=setup.scenario.horizon,
        period_s=setup.scenario.period_s,
        team_names=setup.fleet.team_names,
        agent_team=setup.fleet.team,
        agent_collects=setup.fleet.collects,
        **seen,
        vessels=hull_names(setup.fleet, choice),
        item_class=classes[0].astype(np.int16),
        frame_s=trajectory.interval_s,
        track_pose=frames.pose,
        track_items=frames.items,
        track_present=frames.present,
        track_wind=frames.wind,
        world=world,
        policy=policy or "",
        seed=seed,
        episode=episode,
        t_discovered=mission.ledger.t_discovered[0],
        knowledge=by_agent.record(mission) if by_agent else None,
        begins_s=None if begins is None else begins[0].item(),
        quays=np.array(edges, np.float32) if edges else None,
    )
