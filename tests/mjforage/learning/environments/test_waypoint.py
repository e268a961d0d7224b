import logging
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.learning.environments.waypoint import REWARD, WaypointEnv
from mjforage.learning.environments.waypoint_track import FARTHEST_M, NEAREST_M
from mjforage.scenario.vessel_files import vessel_path


@pytest.fixture(scope="module")
def env() -> WaypointEnv:
    return WaypointEnv()


def test_the_built_in_controller_reaches_all_waypoints_and_noise_none(env: WaypointEnv) -> None:
    env.reset(seed=0)
    pilot, total, over = env.builtin_pilot(), 0.0, False
    while not over:
        observation, reward, over, late, info = env.step_builtin(pilot)
        assert env.observation_space.contains(observation)
        assert not late
        total += reward
    assert info["reached"] == 8
    start, length = np.zeros((1, 2)), 0.0
    for leg in np.diff(np.concatenate((start, env.track.waypoints)), axis=0):
        assert NEAREST_M <= np.hypot(*leg) <= FARTHEST_M
        length += float(np.hypot(*leg))
    assert 0.5 * length < total < 8 * REWARD["reached"] + length  # progress is bounded by the way
    env.reset(seed=0)
    env.action_space.seed(0)
    noise = sum(env.step(env.action_space.sample())[1] for _ in range(300))
    assert noise < 0.0 < total


def test_progress_is_the_way_made_good(env: WaypointEnv) -> None:
    env.reset(seed=4)
    before = env.track.distance_m
    *_, info = env.step(np.array([1.0, 1.0], np.float32))
    assert info["reward/progress"] == pytest.approx(before - env.track.distance_m)
    assert info["reward/effort"] == pytest.approx(REWARD["effort"])
    assert info["reward/time"] == REWARD["time"]


def test_entries_in_the_body_frame(env: WaypointEnv) -> None:
    observation, _ = env.reset(seed=2)
    x, y, yaw = env.track.pose
    bearing = np.arctan2(*(env.track.target - (x, y))[::-1]) - yaw
    distance = env.track.distance_m
    np.testing.assert_allclose(
        observation[:2] * 20.0, distance * np.array([np.cos(bearing), np.sin(bearing)]), rtol=1e-5
    )
    assert np.hypot(*observation[11:13]) * 15.0 > 0.5  # there is wind
    assert np.hypot(*observation[13:15]) == pytest.approx(0.15, abs=1e-6)  # and current
    assert observation[15] == 1.0


def test_what_a_hull_does_not_feel_and_that_it_hunts_is_told_once(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    text = vessel_path("scout").read_text("utf-8")
    head, _, rest = text.partition("\n[windage]")
    bare, light = tmp_path / "bare_one.toml", tmp_path / "light_one.toml"
    bare.write_text(head + rest[rest.index("\n\n") :], "utf-8")
    light.write_text(text.replace('36.0, unit = "kg"', '1.0, unit = "kg"'), "utf-8")
    stiff = tmp_path / "stiff_one.toml"
    stiff.write_text(text.replace("linear_yaw = { value = 3.3", "linear_yaw = { value = 330.0"))
    with caplog.at_level(logging.WARNING):
        for _ in range(2):
            for hull in (bare, light, stiff, "scout"):
                gymnasium.make("mjforage/Waypoint-v0", vessel=hull, wind_mps=8, wind_spread=0.5)
        gymnasium.make("mjforage/Waypoint-v0", vessel=bare, wind_mps=0)
    warnings = [line for line in caplog.messages if line.startswith("vessel ")]
    windless, hunting, steep = warnings
    assert windless == (
        "vessel bare_one: has no [windage] and does not feel the wind of up to 12 m/s"
    )
    assert hunting.startswith("vessel light_one: full thrust") and "it hunts" in hunting
    assert steep.startswith("vessel stiff_one: drag takes its turning in 0.021 s, too short for a ")
    assert steep.endswith(
        "; its motion will not be that of the hull; such drag needs steps of at most 0.059 s"
    )


def test_the_built_in_controller_pays_for_effort_like_actions_do(env: WaypointEnv) -> None:
    """Full astern is an action of -1 in both kinds of step."""

    class Astern:
        def command(self, *_: object) -> NDArray[np.float64]:
            return np.full((1, 1, 2), env.track.vessel.thruster.command_range[0])

    env.reset(seed=1)
    *_, builtin = env.step_builtin(Astern())  # type: ignore[arg-type]
    env.reset(seed=1)
    *_, ours = env.step(np.array([-1.0, -1.0], np.float32))
    assert builtin == ours
    assert ours["reward/effort"] == pytest.approx(REWARD["effort"])


def test_thrusts_beyond_full_are_cut_off(env: WaypointEnv) -> None:
    env.reset(seed=1)
    beyond = env.step(np.array([3.0, -2.0], np.float32))
    env.reset(seed=1)
    np.testing.assert_equal(beyond, env.step(np.array([1.0, -1.0], np.float32)))
