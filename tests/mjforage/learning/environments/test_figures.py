"""Figures of `render`, and the little work for a frame."""

from dataclasses import replace
from typing import Any

import gymnasium
import numpy as np
import pytest
from numpy.typing import NDArray

import mjforage
from mjforage.graph_planner.graph.navigation import OFFSETS
from mjforage.learning.environments.episode_figure import SIZE
from mjforage.mission.setup import Setup
from mjforage.runs.episode_recording import Recording
from mjforage.runs.recording import record
from mjforage.scenario.scenario_file import load_scenario
from mjforage.view.render import chart, map_film

SHORT = ("horizon=14",)
BY_STEP = ("agent_rc", "item_rc", "item_present", "belief", "idleness", "in_view")
BY_FRAME = ("track_pose", "track_items", "track_present", "track_wind")


@pytest.fixture(scope="module")
def played() -> Recording:
    setup = Setup.of(load_scenario("comb-port", SHORT))
    return replace(record(setup, "graph", "greedy", 5, 0), policy="")


def moves_at(replay: Recording, step: int) -> NDArray[np.int64]:
    """(agent,) moves 0-8 that led from a step to the next."""
    made = np.sign(replay.agent_rc[step + 1] - replay.agent_rc[step])  # of one node or two
    return np.array([np.flatnonzero((move == OFFSETS).all(axis=1))[0] for move in made])


def picture_of(env: gymnasium.Env[Any, Any]) -> NDArray[np.uint8]:
    drawn = env.render()
    assert isinstance(drawn, np.ndarray)
    return drawn


def until(replay: Recording, step: int) -> Recording:
    """The replay as if it had ended; discoveries later on are not known yet."""
    found = replay.t_discovered
    cut = {name: getattr(replay, name)[: step + 1] for name in (*BY_STEP, *BY_FRAME)}
    return replace(replay, **cut, t_discovered=np.where(found > step, np.int16(-1), found))


def test_a_picture_is_that_of_the_film_pixel_by_pixel(played: Recording) -> None:
    env = gymnasium.make("mjforage/Foraging-v0", set=SHORT, render_mode="rgb_array")
    env.reset(seed=5)
    for step in range(len(played.agent_rc)):
        drawn = map_film([until(played, step)], SIZE).frame(float(step))
        assert np.array_equal(picture_of(env), drawn), step
        if step + 1 < len(played.agent_rc):
            env.step(moves_at(played, step))


def test_of_environments_side_by_side_each_draws_its_own_episode() -> None:
    setup, last = Setup.of(load_scenario("comb-port", SHORT)), 8  # 4 of 84, 72 of 79 discovered
    films = [replace(record(setup, "graph", "greedy", seed, 0), policy="") for seed in (3, 4)]
    envs = gymnasium.make_vec(
        "mjforage/Foraging-v0", num_envs=2, set=SHORT, render_mode="rgb_array"
    )
    envs.reset(seed=3)
    for step in range(last):
        envs.step(np.stack([moves_at(film, step) for film in films]))
    for film, drawn in zip(films, envs.render() or (), strict=True):
        assert np.array_equal(drawn, map_film([until(film, last)], SIZE).frame(float(last)))


@pytest.mark.parametrize("world", ["graph", "physics"])
def test_figures_of_a_batch_are_those_of_single_environments(world: str) -> None:
    """Also of one that started again while another went on."""
    about: dict[str, Any] = {"set": SHORT, "world": world, "render_mode": "rgb_array"}
    envs = gymnasium.make_vec("mjforage/Foraging-v0", num_envs=2, **about)
    singles = [gymnasium.make("mjforage/Foraging-v0", **about) for _ in range(2)]
    envs.reset(seed=3)
    for i, env in enumerate(singles):
        env.reset(seed=3 + i)
    actions = np.random.default_rng(0).integers(0, 9, (5, 2, 4))
    for step, action in enumerate(actions):
        if step == 3:
            envs.reset(options={"reset_mask": np.array([False, True])})
            singles[1].reset()
        envs.step(action)
        for env, own in zip(singles, action, strict=True):
            env.step(own)
    drawn = envs.render()
    assert isinstance(drawn, tuple)
    assert len(drawn) == 2
    for env, one in zip(singles, drawn, strict=True):
        assert np.array_equal(picture_of(env), one)
    assert not np.array_equal(*drawn)


def test_the_background_is_painted_once_however_many_pictures() -> None:
    env = gymnasium.make("mjforage/Foraging-v0", set=SHORT, render_mode="rgb_array")
    many = gymnasium.make_vec(
        "mjforage/Foraging-v0", num_envs=3, set=SHORT, render_mode="rgb_array"
    )
    chart._ground.cache_clear()
    for one in (env, many):
        one.reset(seed=1)
        for _ in range(20):
            one.render()
            one.step(one.action_space.sample())
    assert chart._ground.cache_info().misses == 1


def test_what_a_picture_gathers_does_not_grow_with_the_episode() -> None:
    env = mjforage.parallel_env(set=("horizon=60",), render_mode="rgb_array")
    env.reset(seed=1)
    held = []
    for _ in range(50):
        env.step(dict.fromkeys(env.agents, 8))
        assert env._figure is not None
        replay = env._figure.recording(env.core, env._episodes)
        held.append(sum(getattr(replay, name).base.nbytes for name in BY_STEP[3:]))
    assert len(set(held)) == 1  # of the present alone, whatever the step
    assert replay.belief.shape[0] == 51
