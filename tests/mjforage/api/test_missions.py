"""Missions step by step: units, batches, moves and what is refused."""

from typing import Any

import numpy as np
import pytest

import mjforage as mf
from tests.mjforage.api.conftest import drawn


def test_a_move_goes_its_way_in_metres(bay: mf.Scenario) -> None:
    mission = mf.make_mission(bay)
    before = mission.reset(seed=1)
    after = mission.step({"scouts_0": "E", "foragers_0": 6})
    moved = after.agent_xy_m - before.agent_xy_m
    scouts, foragers = (bay.scenario.team[team].nodes for team in ("scouts", "foragers"))
    assert moved.tolist() == [[4.0 * scouts, 0.0], [0, 0], [-4.0 * foragers, 0.0], [0, 0]]
    assert (after.step, after.time_s, after.over) == (1, bay.scenario.period_s, False)


def test_an_agent_whose_move_is_not_legal_stays(bay: mf.Scenario) -> None:
    mission = mf.make_mission(bay)
    start = mission.reset(seed=1)
    for _ in range(8):  # to the west edge, and on
        state = mission.step(["W"] * 4)
    assert not state.agent_xy_m[:, 0].any()
    assert state.agent_xy_m[:, 1].tolist() == start.agent_xy_m[:, 1].tolist()


def test_states_are_copies(bay: mf.Scenario) -> None:
    mission = mf.make_mission(bay)
    state = mission.reset(seed=1)
    before = [array.copy() for array in state[3:]]
    for array in state[3:]:
        array[:] = 1
    after: tuple[Any, ...] = mission.state[3:]
    for one, now in zip(before, after, strict=True):
        assert np.array_equal(one, now, equal_nan=True)


def test_a_batch_is_its_episodes(bay: mf.Scenario) -> None:
    batch, single = mf.make_mission(bay, batch=3), mf.make_mission(bay)
    batch.reset(seed=2, episode=[4, 0, 7])
    *_, together = batch.play(drawn)
    for place, episode in enumerate((4, 0, 7)):
        single.reset(seed=2, episode=episode)
        *_, alone = single.play(drawn)
        assert np.array_equal(alone.agent_xy_m, together.agent_xy_m[place])
        assert alone.collected.tolist() == together.collected[place].tolist()
        items = alone.item_present.size
        assert not together.item_present[place, items:].any()


def test_items_are_counted(bay: mf.Scenario) -> None:
    mission = mf.make_mission(bay.replace(horizon=100))
    start = mission.reset(seed=0)
    *_, end = mission.play("greedy")
    gone = int(start.item_present.sum() - end.item_present.sum())
    assert end.collected.sum() == gone > 0
    assert end.discovered.sum() >= gone


def test_the_physics_world_moves_hulls(bay: mf.Scenario) -> None:
    mission = mf.make_mission(bay, world="physics")
    mission.reset(seed=1)
    state = mission.step({"foragers_0": "E"})
    assert state.agent_speed_mps[2] > 0.0 and not float(state.agent_xy_m[2, 0]).is_integer()


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda m: m.step({}), "step: no episode has been started; call reset first"),
        (lambda m: (m.reset(), m.step({"scout_0": "N"})), "agent 'scout_0': unknown"),
        (lambda m: (m.reset(), m.step({"scouts_0": "up"})), "step: gave 'up' for scouts_0"),
        (lambda m: (m.reset(), m.step([0, 1])), r"moves of shape \(2,\): give \(4,\)"),
        (lambda m: (m.reset(), m.step([0, 1, 9, 2])), "step: gave 9 for foragers_0"),
        (lambda m: m.reset(seed=-1), "seed -1: give 0 to"),
        (lambda m: m.reset(episode=-1), "episode -1: give 0 to"),
        (lambda m: m.reset(episode=[1, 2]), r"episode \[1, 2\]: give 1 whole number"),
    ],
)
def test_refusals(bay: mf.Scenario, call: object, words: str) -> None:
    with pytest.raises(mf.UserError, match=words):
        call(mf.make_mission(bay))  # type: ignore[operator]


@pytest.mark.parametrize("world", ["graph", "physics"])
def test_a_mission_step_by_step_is_the_runs_episode(bay: mf.Scenario, world: str) -> None:
    run = mf.evaluate(bay, "greedy", episodes=2, seed=3, world=[world], record=(), progress=False)  # type: ignore[list-item]
    mission = mf.make_mission(bay, world=world)  # type: ignore[arg-type]
    states = [mission.reset(seed=3, episode=1), *mission.play("greedy")]
    logged = run.agents.filter(episode=1).sort("step", "agent")
    nodes = np.concatenate([state.agent_node for state in states])
    xy = np.concatenate([state.agent_xy_m for state in states])
    assert nodes.tolist() == logged["node"].to_list()
    # Logs keep places in 32 bits, counted in nodes, and metres of those.
    np.testing.assert_allclose(xy, logged.select("x_m", "y_m").to_numpy(), rtol=0, atol=1e-5)
