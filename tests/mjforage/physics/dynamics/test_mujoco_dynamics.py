"""The mission in MuJoCo: same worlds, same bits, honest outcomes."""

from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.graph_planner.policies import create_policy
from mjforage.mission.dynamics import ARRIVED, BLOCKED, LATE
from mjforage.mission.episode_log import EpisodeLog
from mjforage.mission.scoring import Scorer
from mjforage.mission.setup import Setup
from mjforage.mission.trajectory import TrajectoryRecorder
from mjforage.physics.dynamics.mujoco_dynamics import MujocoDynamics
from mjforage.physics.simulation import InstabilityError
from mjforage.physics.worlds import WORLDS, create_mission
from mjforage.scenario.scenario_file import load_scenario

SHORT = ("horizon=6",)
IDEAL = (
    "physics.vessels.scouts=ideal",
    "physics.vessels.foragers=ideal",
    "physics.items=graph",
)


@cache
def setup_of(preset: str, *overrides: str) -> Setup:
    return Setup.of(load_scenario(preset, overrides))


def scored(
    setup: Setup,
    episodes: list[int],
    world: str = "physics",
    policy: str = "greedy",
    trajectory: TrajectoryRecorder | None = None,
) -> Scorer:
    mission = create_mission(setup, world, trajectory)
    mission.reset(3, np.array(episodes, np.int64))
    scorer = Scorer(mission)
    mission.run(create_policy(policy), (scorer,))
    return scorer


def played(
    setup: Setup, episodes: list[int], world: str = "physics", policy: str = "greedy"
) -> EpisodeLog:
    return scored(setup, episodes, world, policy).log


def fingerprint(scorer: Scorer, episode: int) -> bytes:
    """Everything that is logged of one episode of a batch."""
    log, error = scorer.log, scorer.scores().series["rmse"][episode]
    count = int(log.n_items[episode])
    agents: list[NDArray[np.generic]] = [
        log.agent_rc[episode],
        log.yaw[episode],
        log.speed[episode],
        log.outcome[episode],
        log.work[episode],
        log.impact[episode],
    ]
    items = [log.t_collected[episode, :count], log.t_discovered[episode, :count]]
    return b"".join(part.tobytes() for part in (*agents, *items, error))


@pytest.mark.parametrize("preset", ["comb-port", "comb-port-weather"])
def test_an_episode_is_the_same_to_the_bit_in_any_batch(preset: str) -> None:
    """Alone, in another order, and beside episodes that need a larger pool of bodies."""
    setup = setup_of(preset, *SHORT, "items.mean=95", "items.std=8")
    whole = scored(setup, [0, 1, 2, 3, 4, 5])
    for episode in (int(np.argmin(whole.log.n_items)), 5):
        assert fingerprint(scored(setup, [episode]), 0) == fingerprint(whole, episode)
    back = scored(setup, [5, 3])
    assert fingerprint(back, 0) == fingerprint(whole, 5)
    assert fingerprint(back, 1) == fingerprint(whole, 3)


@pytest.mark.parametrize("camera", [False, True])
def test_collectors_know_where_items_are_or_what_their_cameras_saw(camera: bool) -> None:
    """Scouts have no camera, and no camera sees all items."""
    setup = setup_of("comb-port-weather", *SHORT, f"sensors.camera_noise_m={0.1 * camera}")
    mission = create_mission(setup, "physics")
    mission.reset(3, np.arange(4))
    mission.run(create_policy("greedy"))
    dynamics = mission._dynamics
    assert isinstance(dynamics, MujocoDynamics)
    ticks: Any = dynamics._playing
    known, xy = ticks._known(), dynamics._simulation.item_xy[:, None]
    if not camera:
        assert (known == xy).all()
        return
    collects = setup.fleet.collects
    assert np.isnan(known[:, ~collects]).all()
    seen = np.isfinite(known[:, collects, :, 0])
    assert seen.any() and not seen.all()


def test_pilots_are_told_one_item_to_pick_up_or_one_to_be_ready_for() -> None:
    """The latter lies outside the node that the forager is sent to, within 9 m."""
    setup = setup_of("comb-port-weather", "horizon=45", "sensors.camera_noise_m=0.0")
    mission, policy, ready = create_mission(setup, "physics"), create_policy("greedy"), 0
    mission.reset(3, np.arange(4))
    mission.prepare(policy)
    dynamics, foragers = mission._dynamics, setup.fleet.collectors
    assert isinstance(dynamics, MujocoDynamics)
    for _ in range(45):
        mission.advance(mission.ask(policy))
        state = dynamics._pilot._fleets.state
        expects, seeks = np.isfinite(state["next_x"]), np.isfinite(state["item_x"])
        assert not (expects & seeks).any() and not expects[:, ~setup.fleet.collects].any()
        off_x, off_y = state["next_x"] - state["target_x"], state["next_y"] - state["target_y"]
        assert (np.maximum(abs(off_x), abs(off_y))[expects] > 0.5 * setup.graph.pitch_m).all()
        assert (np.hypot(off_x, off_y)[expects] < 9.0 + setup.graph.pitch_m).all()
        ready += int(expects[:, foragers].sum())
    assert ready > 0


def test_filming_changes_nothing_and_shows_where_vessels_were() -> None:
    setup, trajectory = setup_of("comb-port", *SHORT), TrajectoryRecorder()
    recorded = scored(setup, [1], trajectory=trajectory)
    assert fingerprint(recorded, 0) == fingerprint(scored(setup, [1]), 0)
    log = recorded.log
    assert trajectory.frames.pose.shape == (1 + 6 * 20, 4, 3)
    ends = setup.graph.row_column(trajectory.frames.pose[::20, :, :2].astype(np.float64))
    np.testing.assert_allclose(ends, log.agent_rc[0], atol=1e-5)
    assert trajectory.frames.items.shape[1] == log.n_items[0]
    steps, taken = np.arange(7)[:, None], log.t_collected[0][None]
    assert (trajectory.frames.present[::20] == ~((taken >= 0) & (taken <= steps))).all()
    assert taken.max() > 0


@pytest.mark.parametrize("world", WORLDS)
def test_every_world_plays_with_every_kind_of_policy(world: str) -> None:
    for policy in ("greedy", "levy", "random"):
        log = played(setup_of("comb-port-weather", *SHORT), [0, 1], world, policy)
        assert log.length.tolist() == [6, 6]
        assert np.isfinite(log.agent_rc).all()
        assert set(np.unique(log.outcome[:, 1:]).tolist()) <= {ARRIVED, LATE, BLOCKED}


def test_ideal_vessels_play_the_graphs_mission() -> None:
    """Fast hulls, no wind load, node capture, items moved by the rule: the same nodes."""
    setup = setup_of("comb-port", *IDEAL)
    graph, physics = (played(setup, list(range(3)), world) for world in ("graph", "physics"))
    assert (graph.length == physics.length).all()
    same = (graph.agent_node == physics.agent_node).all(axis=-1)
    assert same.mean() >= 0.99
    assert (physics.outcome[:, 1:] == ARRIVED).mean() >= 0.99


def test_a_vessel_that_is_too_slow_is_late_and_decides_from_where_it_is() -> None:
    """A third of the time that a decision needs: far nodes are not reached, nodes still fit."""
    setup = setup_of("comb-port", "horizon=12", "period_s=3.0")
    log = played(setup, [0], policy="random")
    outcome = log.outcome[0, 1:]
    assert (outcome[:, :2] == LATE).any()
    nodes = np.rint(log.agent_rc[0]).astype(int)
    graph = setup.graph
    assert (graph.rows[log.agent_node[0]] == nodes[..., 0]).all()
    assert (graph.cols[log.agent_node[0]] == nodes[..., 1]).all()
    for agent in range(4):
        here = graph.metres(log.agent_rc[0, :, agent].astype(np.float64))
        way = np.hypot(*np.diff(here, axis=0).T)
        assert (log.speed[0, 1:, agent] * 4.0 >= way - 1e-3).all(), "way made is at least the chord"


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        (("period_s=9.8",), "period_s = 9.8 s does not fit; 9.8 s has to be a whole number"),
        (("physics.step_s=0.03",), "physics.step_s = 0.03 s does not fit; 0.1 s has to be"),
        (("physics.vessels.scouts=skout",), "vessel skout: neither a shipped vessel"),
        (('physics.item_classes=["botle"]',), "physics.item_classes: 'botle'; choose from bottle"),
        (
            ("physics.capture=intake", "physics.items=graph"),
            "physics.capture = 'intake' with physics.items = 'graph': items without bodies enter",
        ),
        (("physics.item_classes=[]",), "physics.item_classes is empty"),
        (("map.pitch_m=1.1",), "needs 2.27 m to turn, the narrowest corridor is"),
    ],
)
def test_what_cannot_be_run_is_named(overrides: tuple[str, ...], words: str) -> None:
    with pytest.raises(UserError, match=words.replace("(", r"\(")):
        create_mission(setup_of("comb-port", *overrides), "physics")


def test_an_instability_names_seed_episode_time_and_body() -> None:
    mission = create_mission(setup_of("comb-port", *SHORT), "physics")
    mission.reset(3, np.array([7, 12]))
    dynamics = mission._dynamics
    assert isinstance(dynamics, MujocoDynamics)
    preferences = np.zeros((2, 4, 9))
    mission.advance(preferences)
    speed = np.zeros((2, 4, 3))
    speed[1, 2] = 1e12
    dynamics._simulation.place_vessels(dynamics._simulation.vessel_pose, speed)
    with pytest.raises(InstabilityError) as caught:
        mission.advance(preferences)
    assert "seed 3, episode 12, t = 10.00 s, body foragers_0" in str(caught.value)


@pytest.mark.parametrize("world", ["hulls", "calibrated", "debris", "intake", "physics"])
def test_what_was_collected_is_carried(world: str) -> None:
    mission = create_mission(setup_of("comb-port-weather", "horizon=25"), world)
    mission.reset(3, np.arange(4))
    mission.run(create_policy("greedy"))
    dynamics = mission._dynamics
    assert isinstance(dynamics, MujocoDynamics)
    taken = (mission.state.collected_by[..., None] == np.arange(4)).sum(axis=1)
    assert taken.sum() > 0
    assert (dynamics._simulation.load == taken).all()


@pytest.mark.parametrize("world", ["graph", "physics"])
def test_without_energy_a_vessel_stays_and_that_is_no_hindrance(world: str) -> None:
    setup = setup_of("comb-port", "horizon=8", "team.scouts.energy=2", "team.foragers.energy=1")
    log = played(setup, [0, 1], world)
    assert (log.outcome[:, 4:] == ARRIVED).all()
    assert (log.energy[:, -1] < 4.0).all()


@pytest.mark.parametrize("meet", [True, False])
def test_items_of_a_mission_meet_where_they_shall(meet: bool) -> None:
    """In a wind of 8 m/s some of two episodes would overlap."""
    meeting = f"physics.item_contacts={str(meet).lower()}"
    mission = create_mission(setup_of("comb-port-wind-8", "horizon=20", meeting), "physics")
    mission.reset(3, np.arange(2))
    mission.run(create_policy("greedy"))
    dynamics = mission._dynamics
    assert isinstance(dynamics, MujocoDynamics)
    nearest = np.inf
    for xy, kind in zip(dynamics._simulation.item_xy, dynamics._simulation.item_class, strict=True):
        apart = np.hypot(*(xy[kind >= 0, None] - xy[None, kind >= 0]).T)
        nearest = min(nearest, apart[np.triu_indices(len(apart), 1)].min())
    assert nearest > 0.19 if meet else nearest < 0.1
