"""Batches of `Waypoint-v0` on a device, against the environment of one vessel."""

import os
import subprocess
import sys
from collections.abc import Iterator
from typing import Any

import gymnasium
import numpy as np
import pytest
import torch
from gymnasium.vector import AutoresetMode, SyncVectorEnv

import mjforage
from mjforage.base.errors import UserError
from mjforage.base.randomness import episode_keys
from mjforage.forcing import Forcing
from mjforage.learning.environments.waypoint import HORIZON, WAYPOINTS, WaypointEnv
from mjforage.learning.environments.waypoint_vector import WaypointVectorEnv
from mjforage.physics.scaled_vessels import deviations
from mjforage.scenario.scenario import Spread, Weather

ID, SEED, CLOSE = "mjforage/Waypoint-v0", 5, 1.05
assert mjforage


def batch(envs: int, mode: str = "NextStep", /, **options: Any) -> WaypointVectorEnv:
    made = gymnasium.make_vec(ID, envs, device="warp-cpu", autoreset_mode=mode, **options)
    assert isinstance(made, WaypointVectorEnv)
    return made


def drawn_as(env: WaypointVectorEnv, ones: list[WaypointEnv]) -> None:
    """Have a batch begin with what single environments have drawn."""
    tracks, hulls = env._batch.tracks, env._batch.hulls
    for i, one in enumerate(ones):
        track, forcing = one.track, one.track._forcing
        tracks.waypoint[i] = track.waypoints
        tracks.mean_wind[i], tracks.mean_current[i] = (
            forcing.mean_wind_mps[0],
            forcing.mean_current_mps[0],
        )
        tracks.gust_key[i] = forcing._gust_keys[0]
        hulls.live.places[i, 2] = tracks.pose[i, 0, 2] = track.pose[2]
        tracks.wind[i, 0], tracks.current[i, 0] = track.wind, track.current
        tracks.distance[i] = track.distance_m
        hulls.live.around[i, 0, 5:7] = 1.0 + track.simulation.spread[0, 0, 2]
        hulls.live.around[i, 0, 7:] = 1.0 + track.simulation.spread[0, 0, :2]


def steered(observation: Any) -> Any:
    """(2,) or (env, 2) thrust towards the waypoint, as far as it lies ahead."""
    x, y = observation[..., 2], observation[..., 3]
    bearing = np.arctan2(y, x)
    ahead = 0.6 * np.cos(bearing).clip(0.0, 1.0)
    return np.stack((ahead - 0.4 * bearing, ahead + 0.4 * bearing), axis=-1).clip(-1.0, 1.0)


@pytest.mark.parametrize("vessel", ["scout", "otter"])
def test_a_batch_does_what_single_environments_do(vessel: str) -> None:
    """Half a minute in gusts, with masses of their own, to the end of one of two episodes."""
    options: dict[str, Any] = {"vessel": vessel, "mass_spread": 0.2, "thrust_spread": 0.3}
    ones = [WaypointEnv(**options) for _ in range(2)]
    for i, one in enumerate(ones):
        one.reset(seed=i)
        assert one.track.simulation.spread[0, 0].astype(bool).tolist() == [True, False, True]
    yaw = ones[0].track.pose[2]
    ones[0].track.waypoints = CLOSE * np.arange(1.0, 9.0)[:, None] * (np.cos(yaw), np.sin(yaw))
    many = batch(2, **options)
    many.reset(seed=0)
    drawn_as(many, ones)
    seen = np.stack([one._observed() for one in ones])
    for _ in range(60):
        actions = steered(seen)
        known = [one.step(action) for one, action in zip(ones, actions, strict=True)]
        observation, reward, ended, late, info = many.step(actions)
        seen = np.stack([each[0] for each in known])
        np.testing.assert_allclose(observation.numpy(), seen, atol=2e-3)
        np.testing.assert_allclose(reward.numpy(), [each[1] for each in known], atol=2e-3)
        assert ended.tolist() == [each[2] for each in known]
        assert not late.any()
        for name in ("reached", "distance_m", "reward/progress", "reward/effort"):
            told = [each[4][name] for each in known]
            np.testing.assert_allclose(info[name].numpy(), told, atol=5e-3)
        if ended.any():
            break
    assert ended.tolist() == [True, False]
    assert np.hypot(*ones[1].track.pose[:2]) > 3.0


def test_an_environment_is_the_same_in_any_batch() -> None:
    many, alone = batch(3), batch(1)
    seen, _ = many.reset(seed=SEED)
    one, _ = alone.reset(seed=SEED + 2)
    for _ in range(4):
        assert torch.equal(seen[2:], one)
        action = steered(seen.numpy())
        seen, *_ = many.step(action)
        one, *_ = alone.step(action[2:])
    assert not torch.equal(seen[0], seen[1])
    again, _ = many.reset(seed=[SEED + 2, None, 9])
    other, _ = alone.reset(seed=SEED + 2)
    assert torch.equal(again[:1], other)


def test_an_episode_begins_as_the_first_time() -> None:
    """Nothing of the episode before is left: not its way, its clock, its thrust or its marks."""
    env, played = batch(2), []
    for _ in range(2):
        found = [env.reset(seed=SEED)[0]]
        for _ in range(3):
            observation, reward, *_, info = env.step(np.full((2, 2), (1.0, -1.0)))
            found += [observation, reward, info["distance_m"]]
        played.append(found)
        env._batch.tracks.reached[:] = 3
    assert all(map(torch.equal, *played))


def test_a_reset_copies_while_the_device_is_at_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    """Or else an episode of a stream of torch's own could be read too early, or begin too early."""
    env, calls = batch(1), []
    arrays = env.hulls.arrays
    for part, name in ((env.hulls, "wait"), (arrays, "fetch"), (arrays, "send")):
        monkeypatch.setattr(part, name, lambda *_, name=name: calls.append(name))
    monkeypatch.setattr(env._batch, "begin", lambda: calls.append("begin"))
    env.reset(seed=0)
    assert calls == ["wait", "fetch", "send", "send", "send", "wait", "begin"]


def test_unstable_motion_is_one_line_and_a_reset_begins_anew() -> None:
    env, fresh = batch(2), batch(2)
    fresh.reset(seed=SEED)
    env.reset(seed=SEED)
    env._batch.hulls.live.velocities[1] = np.inf
    env.step(np.ones((2, 2)))
    with pytest.raises(UserError, match=r"^vessel of environment 1: its motion is unstable; take"):
        env.step(np.ones((2, 2)))
    env.reset(seed=[None, SEED + 1], options={"reset_mask": np.array([False, True])})
    seen, *_ = env.step(np.ones((2, 2)))
    known, *_ = fresh.step(np.ones((2, 2)))
    assert torch.equal(seen[1], known[1]) and torch.isfinite(seen).all()


def test_actions_beyond_full_thrust_are_full_thrust() -> None:
    found = []
    for actions in ((1.0, -1.0), (7.0, -3.0)):
        env = batch(1)
        env.reset(seed=SEED)
        found.append(env.step(np.array([actions]))[:2])
    assert all(map(torch.equal, *found))


@pytest.fixture(scope="module")
def wide() -> Iterator[WaypointVectorEnv]:
    spread: dict[str, Any] = {"mass_spread": 0.2, "drag_spread": 0.4, "thrust_spread": 0.3}
    env = batch(400, wind_mps=4.0, wind_spread=0.5, current_spread=0.25, **spread)
    env.reset(seed=SEED)
    yield env


def test_draws_are_those_of_missions(wide: WaypointVectorEnv) -> None:
    """Winds, currents and vessels of an episode follow from its key as in a mission."""
    keys = np.concatenate([episode_keys(SEED + i, np.zeros(1, np.int64)) for i in range(400)])
    weather = Weather(
        wind_speed_mps=4.0, wind_spread=0.5, current_speed_mps=0.15, current_spread=0.25
    )
    forcing, tracks = Forcing.create(weather, keys), wide._batch.tracks
    np.testing.assert_array_equal(tracks.mean_wind, forcing.mean_wind_mps)
    np.testing.assert_array_equal(tracks.mean_current, forcing.mean_current_mps)
    np.testing.assert_array_equal(tracks.gust_key, forcing._gust_keys)
    given = 1.0 + deviations(Spread(mass=0.2, drag=0.4, thrust=0.3), 1, keys)[:, 0]
    found = wide._batch.hulls.live.around[:, 0, 5:]
    np.testing.assert_allclose(found, given[:, [2, 2, 0, 1]], rtol=1e-6)


def test_memory_of_an_environment_is_told(wide: WaypointVectorEnv) -> None:
    """Warp's contacts and rows, and our arrays; they grow with the batch alone."""
    few = batch(100)
    assert 8_000 < wide.hulls.memory_bytes < 12_000
    assert few.hulls.memory_bytes == pytest.approx(wide.hulls.memory_bytes, rel=0.05)


def test_waypoints_lie_one_to_three_nodes_apart_all_around(wide: WaypointVectorEnv) -> None:
    way = np.diff(wide._batch.tracks.waypoint, axis=1, prepend=0.0)
    length, bearing = np.hypot(*way.T), np.arctan2(*way.T)
    assert 4.0 <= length.min() < 4.1 and 11.9 < length.max() <= 12.0
    assert abs(length.mean() - 8.0) < 0.15
    assert abs(np.exp(1j * bearing).mean()) < 0.05
    assert abs((length * np.exp(1j * bearing)).mean()) < 0.5  # one does not tell the other
    assert abs(np.exp(1j * wide._batch.tracks.pose[:, 0, 2]).mean()) < 0.15
    assert len(np.unique(way)) == way.size


def near_the_end(mode: str) -> tuple[WaypointVectorEnv, Any, dict[str, Any]]:
    """A batch of which the second is in its last step, and what it shows."""
    env = batch(3, mode)
    env.reset(seed=SEED)
    env._batch.tracks.steps[1], env._batch.tracks.reached[1] = HORIZON - 1, 3
    seen, _, ended, late, info = env.step(np.zeros((3, 2)))
    assert late.tolist() == [False, True, False] and not ended.any()
    return env, seen, info


def test_all_waypoints_in_the_last_step_are_an_end_and_no_cut() -> None:
    env = batch(1)
    env.reset(seed=SEED)
    env._batch.tracks.steps[0], env._batch.tracks.reached[0] = HORIZON - 1, WAYPOINTS
    _, _, ended, late, _ = env.step(np.zeros((1, 2)))
    assert ended.all() and not late.any()
    env.step(np.zeros((1, 2)))
    assert env._batch.tracks.episode.tolist() == [2]


def test_the_next_step_begins_anew() -> None:
    env, seen, _ = near_the_end("NextStep")
    assert seen[1, 15] == 0.0
    seen, reward, ended, late, info = env.step(np.ones((3, 2)))
    assert seen[:, 15].tolist() == pytest.approx([1.0 - 2 / HORIZON, 1.0, 1.0 - 2 / HORIZON])
    assert reward[1] == 0.0 and not (ended | late).any() and (reward[[0, 2]] != 0.0).all()
    assert info["_reward/time"].tolist() == [True, False, True] and info["_reached"].all()
    assert info["reward/time"][1] == 0.0
    _, reward, *_, info = env.step(np.ones((3, 2)))
    assert (reward != 0.0).all() and info["_reward/time"].all()
    assert env._batch.tracks.episode.tolist() == [1, 2, 1]


def test_the_same_step_begins_anew() -> None:
    env, seen, info = near_the_end("SameStep")
    assert info["_final_obs"].tolist() == [False, True, False] == info["_final_info"].tolist()
    assert info["final_obs"][1, 15] == 0.0 and seen[1, 15] == 1.0
    assert info["final_info"]["reward/time"].tolist() == pytest.approx([0.0, -0.1, 0.0])
    assert info["_reward/time"].tolist() == [True, False, True] and info["_reached"].all()
    assert info["final_info"]["reached"].tolist() == [0, 3, 0]
    far = info["final_info"]["distance_m"]
    assert torch.equal(far > 0.0, info["_final_info"]) and far[1] != info["distance_m"][1]
    _, reward, *_, info = env.step(np.ones((3, 2)))
    assert (reward != 0.0).all() and not info["_final_obs"].any()
    assert env._batch.tracks.steps.tolist() == [2, 1, 2]
    fresh = batch(1)
    fresh.reset(seed=SEED + 1)
    then, _ = fresh.reset()
    assert torch.equal(then[0, :9], seen[1, :9])


def test_without_autoreset_a_mask_begins_anew() -> None:
    env, _, _ = near_the_end("Disabled")
    seen, *_ = env.step(np.ones((3, 2)))
    kept = seen.clone()
    seen, info = env.reset(options={"reset_mask": torch.tensor([False, True, False])})
    assert seen[1, 15] == 1.0 and torch.equal(seen[[0, 2]], kept[[0, 2]])
    assert info["_reached"].tolist() == [False, True, False]


def test_tensors_of_a_step_are_kept() -> None:
    env = batch(2)
    first, _ = env.reset(seed=0)
    kept = first.clone()
    results = env.step(torch.ones(2, 2))
    assert torch.equal(first, kept)
    before = [each.clone() for each in results[:4]]
    env.step(torch.zeros(2, 2))
    assert all(map(torch.equal, before, results[:4]))
    assert results[0].dtype == results[1].dtype == torch.float32
    assert env.observation_space.contains(results[0].numpy())


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"device": "gpu"}, r"^device = 'gpu': unknown; choose warp-cpu, cuda"),
        ({"device": "cuda"}, r"^device cuda: .*(GPU|numba_cuda)"),
        ({"mass_spread": 0.9}, r"^spread: mass = 0.9 should be"),
        ({"wind_spread": -1.0}, r"^weather: wind_spread = -1.0 should be"),
        ({"render_mode": "rgb_array"}, r"^render_mode = 'rgb_array': batches on a device draw"),
        ({"autoreset_mode": "never"}, r"^autoreset_mode = 'never': unknown; choose"),
        ({"vesel": "scout"}, r"vesel"),
    ],
)
def test_what_cannot_be_is_one_line(options: dict[str, Any], words: str) -> None:
    with pytest.raises(UserError, match=words) as found:
        gymnasium.make_vec(ID, 2, **{"device": "warp-cpu", **options})
    assert "\n" not in str(found.value)


@pytest.mark.parametrize(
    ("actions", "words"),
    [
        (np.zeros((3, 2)), r"^actions: have shape \(3, 2\), expected \(2, 2\); give finite"),
        ([[0.0, 1.0], [np.nan, 0.0]], r"^actions\[1\] = \[nan, 0.0\]: give finite numbers"),
        ("ahead", r"^actions: are no array"),
    ],
)
def test_bad_actions_are_one_line_and_change_nothing(actions: Any, words: str) -> None:
    env = batch(2)
    with pytest.raises(UserError, match=r"^step before the first reset"):
        env.step(np.zeros((2, 2)))
    env.reset(seed=0)
    with pytest.raises(UserError, match=words):
        env.step(actions)
    assert not env._batch.tracks.steps.any()


@pytest.mark.parametrize("count", [0, 2.5, "2", True])
@pytest.mark.parametrize("name", [ID, "mjforage/Foraging-v0"])
def test_a_number_of_environments_that_is_none_is_one_line(count: Any, name: str) -> None:
    with pytest.raises(UserError, match=f"^num_envs = {count!r}: give a whole number from 1 on"):
        gymnasium.make_vec(name, num_envs=count)


def test_without_a_device_a_batch_is_of_single_environments() -> None:
    made = gymnasium.make_vec(ID, 2, autoreset_mode=AutoresetMode.SAME_STEP)
    assert isinstance(made, SyncVectorEnv)
    seen, _ = made.reset(seed=3)
    one = WaypointEnv()
    for i in range(2):
        np.testing.assert_array_equal(seen[i], one.reset(seed=3 + i)[0])


def test_simulated_threads_step_as_this_processor_does() -> None:
    """Bit for bit, with device = "cuda" in numba's simulator and Warp on the processor."""
    pytest.importorskip("numba_cuda")
    program = (
        "import numpy as np, sys\n"
        "from mjforage.learning.environments.waypoint_vector import WaypointVectorEnv\n"
        "env = WaypointVectorEnv(2, 'SameStep', device=sys.argv[1])\n"
        "env.reset(seed=4)\n"
        "env._batch.tracks.steps[0] = 299\n"
        "env._batch.hulls.arrays.send(env._batch.tracks.steps)\n"
        "for _ in range(2): result = env.step(np.full((2, 2), 0.7))\n"
        "print([each.numpy().tobytes().hex() for each in result[:4]])\n"
    )
    found = []
    for device, simulated in (("cuda", "1"), ("warp-cpu", "0")):
        done = subprocess.run(
            [sys.executable, "-c", program, device],
            env={**os.environ, "NUMBA_ENABLE_CUDASIM": simulated},
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr[-2000:]
        found.append(done.stdout.splitlines()[-1])
    assert found[0] == found[1]


@pytest.mark.parametrize("mode", ["NextStep", "SameStep"])
def test_info_is_laid_out_as_that_of_single_environments(mode: str) -> None:
    """Keys and masks of the step that ends an episode, and of the next; `final_obs` but for."""
    many, ones = batch(2, mode), gymnasium.make_vec(ID, 2, autoreset_mode=mode)
    assert isinstance(ones, SyncVectorEnv)
    infos: list[list[dict[str, Any]]] = [[], []]
    many.reset(seed=np.int64(SEED))
    ones.reset(seed=SEED)
    assert many.np_random_seed == SEED
    many._batch.tracks.steps[1] = ones.envs[1].unwrapped._steps = HORIZON - 1  # type: ignore[attr-defined]
    for _ in range(2):
        for env, found in zip((many, ones), infos, strict=True):
            found.append(env.step(np.zeros((2, 2), np.float32))[4])
    for found, known in zip(*infos, strict=True):
        parts = [(found, known)]
        if "final_info" in known:
            parts += [(found["final_info"], known["final_info"])]
        for own, other in parts:
            assert own.keys() >= other.keys()
            for name in [name for name in other if name.startswith("_")]:
                assert own[name].tolist() == other[name].tolist(), name
