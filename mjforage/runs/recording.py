"""Recording one episode as a `Recording`, by playing it again from its seed."""

import itertools

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
from mjforage.scenario.place import Ring
from mjforage.scenario.vessel_files import hull_names


class _Recorder(Observer):
    """Recorder of the visible state of the first episode of a batch."""

    def __init__(self) -> None:
        self.agents: list[NDArray[np.float32]] = []
        self.targets: list[NDArray[np.int32]] = []
        self.items: list[NDArray[np.float32]] = []
        self.present: list[NDArray[np.bool_]] = []
        self.belief: list[NDArray[np.int16]] = []
        self.idleness: list[NDArray[np.float16]] = []
        self.in_view: list[NDArray[np.uint8]] = []

    def see(self, mission: Mission) -> None:
        state, fleet, first = mission.state, mission.setup.fleet, np.zeros(1, np.int64)
        grid = mission.setup.graph.grid
        self.agents.append(state.agent_rc[0].astype(np.float32))
        told = mission.moves.target if mission.moves else state.agent_node
        self.targets.append(told[0].astype(np.int32))
        self.items.append(state.item_rc[0].astype(np.float32))
        self.present.append(state.item_node[0] >= 0)
        self.belief.append(grid(mission.knowledge.belief[0]).astype(np.int16))
        self.idleness.append(grid(mission.idleness(first)[0]).astype(np.float16))
        by_scouts, by_foragers = (
            mission.times_seen(team, first)[0] > 0 for team in (fleet.discoverers, fleet.collectors)
        )
        self.in_view.append(grid(by_scouts + np.uint8(2) * by_foragers).astype(np.uint8))


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
    edges = [(*a, *b) for ring in _rings(setup) for a, b in itertools.pairwise(ring)]
    classes = draw_classes(mission.keys, mission.initial.item_node, item_choices(choice))
    return Recording(
        navigable=setup.grid.navigable,
        pitch_m=setup.scenario.map.pitch_m,
        horizon=setup.scenario.horizon,
        period_s=setup.scenario.period_s,
        team_names=setup.fleet.team_names,
        agent_team=setup.fleet.team,
        agent_collects=setup.fleet.collects,
        agent_rc=np.stack(recorder.agents),
        item_rc=np.stack(recorder.items),
        item_present=np.stack(recorder.present),
        belief=np.stack(recorder.belief),
        idleness=np.stack(recorder.idleness),
        in_view=np.stack(recorder.in_view),
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
        agent_target=None if world == "graph" else np.stack(recorder.targets),
        begins_s=None if begins is None else begins[0].item(),
        quays=np.array(edges, np.float32) if edges else None,
    )


def _rings(setup: Setup) -> tuple[Ring, ...]:
    """Outlines of the land, none if the map has none."""
    return setup.grid.place.quays if setup.grid.place else ()
