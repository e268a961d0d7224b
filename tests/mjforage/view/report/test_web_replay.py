"""The interactive replay: what goes into the page comes out of it again, small and harmless."""

import base64
import json
import re
import shutil
import subprocess
import zlib
from collections.abc import Callable, Iterator
from dataclasses import replace
from html import unescape
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
from numpy.typing import NDArray

from mjforage.core.errors import UserError
from mjforage.core.whole_files import write_bytes
from mjforage.runs.episode_replay import Replay
from mjforage.view.page import html
from mjforage.view.report import write_report
from mjforage.view.report.run_logs import load_logs
from mjforage.view.report.web_replay import LIMIT, SCRIPTS, WebReplay, web_replay
from mjforage.view.report.web_stream import changes, folded, packed, thinned, track

MakeRun = Callable[..., Path]
Numbers = Iterator[int]
NODE = shutil.which("node")


def unpacked(text: str) -> Numbers:
    """Written apart from the code under test: one byte after the other."""
    number = shift = 0
    for byte in zlib.decompress(base64.b64decode(text)):
        number |= (byte & 127) << shift
        shift += 7
        if byte < 128:
            yield number
            number = shift = 0


def read_track(numbers: Numbers, lines: int, times: int, unit: float) -> NDArray[np.float64]:
    """(line, time)."""
    order, values = next(numbers), np.empty((lines, times))
    for line in range(lines):
        value = rate = 0
        for time in range(times):
            code = next(numbers)
            change = -(code + 1) // 2 if code % 2 else code // 2
            rate = rate + change if order == 2 else change
            value += rate
            values[line, time] = value * unit
    return values


def read_layer(numbers: Numbers, shape: tuple[int, ...]) -> NDArray[np.int64]:
    """(step, row, column)."""
    counts = [next(numbers) for _ in range(shape[0])]
    gaps = [next(numbers) for _ in range(sum(counts))]
    values = [next(numbers) for _ in range(sum(counts))]
    grid, steps, at = np.zeros(shape[1] * shape[2], np.int64), [], 0
    for count in counts:
        cell = 0
        for _ in range(count):
            cell += gaps[at]
            grid[cell] = values[at]
            at += 1
        steps.append(grid.copy())
    return np.array(steps).reshape(shape)


def finer(replay: Replay, frame_s: float, world: str) -> Replay:
    """The same episode with a track as the physics world has it: smooth, noisy, often turning."""
    rng = np.random.default_rng(7)
    per = round(replay.period_s / frame_s)
    steps, items = replay.item_present.shape
    agents = len(replay.agent_team)
    frames = (steps - 1) * per + 1
    speed = np.cumsum(rng.normal(0.0, 0.01, (frames, agents, 2)), axis=0)
    yaw = np.cumsum(rng.normal(0.0, 0.15, (frames, agents, 1)), axis=0) + 3.0
    drift = 0.08 + 0.02 * rng.normal(size=(frames, items, 2))
    start = 4.0 * rng.uniform(1.0, 40.0, (items, 2))
    late = rng.integers(0, per, items)
    gone = ~replay.item_present
    frame = np.where(gone.any(0), np.maximum(gone.argmax(0) * per - late, 0), frames)
    present = np.arange(frames)[:, None] < frame
    place = start + np.cumsum(np.where(present[..., None], drift * frame_s, 0.0), axis=0)
    return replace(
        replay,
        world=world,
        frame_s=frame_s,
        track_pose=np.concatenate(
            [60.0 + np.cumsum(speed, axis=0) * 0.02, (yaw + np.pi) % (2 * np.pi) - np.pi], axis=-1
        ).astype(np.float32),
        track_items=place.astype(np.float32),
        track_present=present,
        track_wind=rng.normal(0.0, 3.0, (frames, 2)).astype(np.float32),
    )


def with_track(folder: Path, world: str, frame_s: float) -> Replay:
    """Give a world of the run a track of its own, and return that replay."""
    path = folder / "replay" / f"{world}-greedy-0.npz"
    replay = finer(Replay.load(path), frame_s, world)
    write_bytes(path, replay.content())
    return replay


def with_physics(folder: Path) -> Replay:
    return with_track(folder, "physics", 0.5)


def shown(folder: Path) -> WebReplay:
    result = web_replay(load_logs(folder))
    assert result is not None
    return result


def entry_of(result: WebReplay, world: str) -> dict[str, Any]:
    found: dict[str, Any] = next(e for e in result.data["replays"] if e["world"] == world)
    return found


@pytest.mark.parametrize("seed", range(3))
def test_numbers_of_every_length_come_back(seed: int) -> None:
    rng = np.random.default_rng(seed)
    edges = [0, 1, 127, 128, 16383, 16384, 2**21 - 1, 2**21, 2**28 - 1, 2**28, 2**32 - 1]
    numbers = np.concatenate([edges, rng.integers(0, 2**32, 200)]).astype(np.int64)
    assert list(unpacked(packed([numbers[:40], numbers[40:]]))) == numbers.tolist()
    assert folded(np.array([0, -1, 1, -2, 2])).tolist() == [0, 1, 2, 3, 4]


def test_steady_motion_takes_second_differences_and_noise_first_ones() -> None:
    steady = np.outer(np.arange(50.0), [0.4, -0.3])
    noise = np.random.default_rng(0).normal(0.0, 1.0, (50, 2))
    for values, order in ((steady, 2), (noise, 1)):
        parts = track(values, 0.01)
        assert parts[0].tolist() == [order]
        back = read_track(unpacked(packed(parts)), 2, 50, 0.01)
        np.testing.assert_allclose(back.T, values, atol=0.005 + 1e-9)


def test_layers_come_back(rng_seed: int = 3) -> None:
    rng = np.random.default_rng(rng_seed)
    layer = np.where(rng.random((9, 5, 7)) < 0.2, rng.integers(0, 256, (9, 5, 7)), 0)
    layer[3:6] = layer[2]  # steps without a change
    back = read_layer(unpacked(packed(changes(layer))), layer.shape)
    assert (back == layer).all()


def test_the_last_frame_is_kept() -> None:
    assert thinned(7, 3).tolist() == [0, 3, 6]
    assert thinned(8, 3).tolist() == [0, 3, 6, 7]
    assert thinned(1, 4).tolist() == [0]


def test_a_replay_comes_back_within_its_units(make_run: MakeRun) -> None:
    folder = make_run(worlds=("graph", "physics"), policies=("greedy",), episodes=1)
    replay = with_physics(folder)
    entry = entry_of(shown(folder), "physics")
    numbers = unpacked(entry["text"])
    steps, items = replay.item_present.shape
    frames, agents = replay.track_pose.shape[:2]
    assert (entry["frames"], entry["items"], entry["steps"]) == (frames, items, steps - 1)
    assert (entry["pose_stride"], entry["item_stride"]) == (1, 2)
    kept = thinned(frames, 2)
    place = read_track(numbers, 2 * agents, frames, 0.01).reshape(agents, 2, frames)
    yaw = read_track(numbers, agents, frames, 0.01)
    item = read_track(numbers, 2 * items, len(kept), 0.01).reshape(items, 2, len(kept))
    wind = read_track(numbers, 2, len(kept), 0.01)
    np.testing.assert_allclose(np.moveaxis(place, -1, 0), replay.track_pose[..., :2], atol=0.0051)
    turn = yaw.T - replay.track_pose[..., 2]
    np.testing.assert_allclose(np.cos(turn), 1.0, atol=2e-5)  # half a unit and whole turns
    assert np.abs(np.diff(yaw, axis=1)).max() < np.pi
    np.testing.assert_allclose(np.moveaxis(item, -1, 0), replay.track_items[kept], atol=0.0051)
    np.testing.assert_allclose(wind.T, replay.track_wind[kept], atol=0.0051)
    removed = [next(numbers) for _ in range(items)]
    assert removed == replay.track_present.sum(axis=0).tolist()
    logged = load_logs(folder).items.filter(world="physics").sort("item")["t_discovered"]
    assert [next(numbers) for _ in range(items)] == logged.fill_null(steps).to_list()
    shape = replay.belief.shape
    assert (read_layer(numbers, shape) == replay.belief).all()
    assert (np.abs(read_layer(numbers, shape) / 15 - replay.idleness) <= 0.5 / 15 + 1e-3).all()
    assert (read_layer(numbers, shape) == replay.in_view).all()
    assert next(numbers, None) is None


def test_the_same_logs_give_the_same_data(make_run: MakeRun) -> None:
    folder = make_run(worlds=("graph", "physics"), policies=("greedy",))
    with_physics(folder)
    assert json.dumps(shown(folder).data) == json.dumps(shown(folder).data)


def test_a_full_episode_stays_small(make_run: MakeRun) -> None:
    folder = make_run(
        worlds=("graph", "physics"),
        policies=("greedy",),
        episodes=1,
        horizon=150,
        shape=(62, 46),
        items=80,
    )
    with_physics(folder)
    result = shown(folder)
    assert len(entry_of(result, "graph")["text"]) < 40_000
    entry = entry_of(result, "physics")
    assert len(entry["text"]) < LIMIT
    assert (entry["pose_stride"], entry["item_stride"]) == (1, 2)


def test_what_is_too_large_is_kept_at_fewer_frames(
    make_run: MakeRun, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = make_run(worlds=("graph", "physics"), policies=("greedy",), episodes=1)
    with_physics(folder)
    whole = len(entry_of(shown(folder), "physics")["text"])
    monkeypatch.setattr("mjforage.view.report.web_replay.LIMIT", whole // 2)
    entry = entry_of(shown(folder), "physics")
    assert len(entry["text"]) <= whole // 2
    assert entry["item_stride"] == 2 * entry["pose_stride"] > 2


def test_worlds_and_policies_to_choose_from(make_run: MakeRun) -> None:
    ladder = ("graph", "hulls", "debris", "physics")
    result = shown(make_run(worlds=ladder, replays=("levy",), episodes=1))
    assert (result.worlds, result.shown) == (ladder, ("graph", "physics"))
    assert result.policies == ("levy",)
    alone = shown(make_run(episodes=1))
    assert (alone.worlds, alone.shown, alone.policies) == (
        ("graph",),
        ("graph",),
        ("greedy", "levy"),
    )


def test_without_replays_there_is_no_player(make_run: MakeRun) -> None:
    folder = make_run(episodes=1)
    shutil.rmtree(folder / "replay")
    assert web_replay(load_logs(folder)) is None


def other_map(replay: Replay) -> Replay:
    return replace(replay, navigable=~replay.navigable)


def other_items(replay: Replay) -> Replay:
    return replace(replay, item_present=replay.item_present[:, 1:])


def other_policy(replay: Replay) -> Replay:
    return replace(replay, policy="levy")


@pytest.mark.parametrize("change", [other_map, other_items, other_policy])
def test_a_replay_of_another_run_is_refused(
    make_run: MakeRun, change: Callable[[Replay], Replay]
) -> None:
    folder = make_run(episodes=1)
    path = folder / "replay" / "graph-greedy-0.npz"
    write_bytes(path, change(Replay.load(path)).content())
    with pytest.raises(UserError, match=r"greedy-0\.npz: (is not of the run|.* does not fit)"):
        web_replay(load_logs(folder))


def player(page: str) -> str:
    return page.split('<section id="replay">', 1)[1].split("</section>", 1)[0]


def test_hulls_are_as_long_as_those_that_ran(make_run: MakeRun) -> None:
    folder = make_run(policies=("greedy",), episodes=1)
    lengths = {agent["name"]: agent["length_m"] for agent in shown(folder).data["agents"]}
    assert (lengths["scouts-0"], lengths["foragers-0"]) == (1.35, 2.0)
    run = json.loads((folder / "run.json").read_text())
    run["hulls"] = {"vessels": {"scout": {"length_m": 3.5}}}
    (folder / "run.json").write_text(json.dumps(run))
    lengths = {agent["name"]: agent["length_m"] for agent in shown(folder).data["agents"]}
    assert (lengths["scouts-0"], lengths["foragers-0"]) == (3.5, 2.0)
    run["hulls"]["vessels"]["scout"] = {"length_m": "long"}
    (folder / "run.json").write_text(json.dumps(run))
    with pytest.raises(UserError, match=r"hulls.vessels.scout.length_m = 'long', expected a n"):
        shown(folder)


def options(part: str, mark: str) -> list[str]:
    inside = part.split(mark, 1)[1].split("</select>", 1)[0]
    return [unescape(word) for word in re.findall(r"<option[^>]*>(.*?)</option>", inside)]


def test_the_page_of_one_world(make_run: MakeRun) -> None:
    policy = "<b onclick=alert(1)>&\"'`x`</script>".replace("/", "")
    page = write_report(make_run(policies=("greedy", policy), episodes=1)).read_text("utf-8")
    part = player(page)
    assert options(part, 'id="player-policy"') == ["greedy", policy]
    assert part.count("<canvas tabindex") == 1
    assert "data-world" not in part.split("<script>", 1)[0]
    assert "<b onclick" not in page
    assert page.count("<script") == page.count("</script>") == 2
    data = json.loads(part.split('id="player-data">', 1)[1].split("</script>", 1)[0])
    assert [entry["policy"] for entry in data["replays"]] == ["greedy", policy]


def test_the_player_of_three_worlds(make_run: MakeRun) -> None:
    worlds = ("graph", "hulls", "physics")
    folder = make_run(worlds=worlds, policies=("greedy",), episodes=1)
    with_physics(folder)
    template = html.environment().get_template("player/player.html.j2")
    part = player(template.render(replay=shown(folder)))
    assert part.count("<canvas tabindex") == 2
    for panel, chosen in (("1", "graph"), ("2", "physics")):
        mark = f'aria-label="World of panel {panel}"'
        assert options(part, mark) == list(worlds)
        assert f"<option selected>{chosen}</option>" in part.split(mark, 1)[1].split("</select>")[0]
    assert options(part, 'id="player-follow"')[:2] == ["nobody", "scouts-0"]


def test_the_script_needs_nothing_from_outside() -> None:
    for name in (*SCRIPTS, "player.css", "player.html.j2"):
        text = resources.files("mjforage.view.report").joinpath("player", name).read_text("utf-8")
        assert not re.search(r"https?:|\beval\b|new Function|import\b|XMLHttp|url\(", text)


ASKING = """
let input = "";
process.stdin.on("data", (part) => { input += part; });
process.stdin.on("end", async () => {
  const { stage, entry, times } = JSON.parse(input);
  const episode = await decodeEpisode(entry, stage), steps = [...Array(entry.steps + 1).keys()];
  const agents = stage.agents.map((_, i) => i), items = [...Array(entry.items).keys()];
  console.log(JSON.stringify({
    poses: times.map((time) => agents.map((i) => Object.values(episode.pose(i, time)))),
    items: times.map((time) => items.map((i) => Object.values(episode.item(i, time)))),
    winds: times.map((time) => Object.values(episode.wind(time))),
    shares: steps.map((step) => Object.values(episode.shares(step * stage.period_s))),
    belief: [...steps, ...steps.reverse()].map((step) => [...episode.belief.at(step)]),
  }));
});
"""


def linear(values: NDArray[np.floating], frame: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values (frame, ...) between frames."""
    before = np.minimum(frame.astype(np.int64), len(values) - 2)
    part = (frame - before).reshape(-1, *[1] * (values.ndim - 1))
    mixed: NDArray[np.float64] = values[before] * (1.0 - part) + values[before + 1] * part
    return mixed


def answers(result: WebReplay, world: str, times_s: NDArray[np.float64]) -> dict[str, Any]:
    """What the page's own code makes of a replay, run by Node.js."""
    if NODE is None:
        pytest.skip("Node.js is not installed")
    stage = {key: value for key, value in result.data.items() if key != "replays"}
    asked = {"stage": stage, "entry": entry_of(result, world), "times": times_s.tolist()}
    code = (
        resources.files("mjforage.view.report").joinpath("player", "decode.js").read_text("utf-8")
    )
    done = subprocess.run(
        [NODE, "-e", code + ASKING],
        input=json.dumps(asked),
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    )
    return {key: np.array(value) for key, value in json.loads(done.stdout).items()}


@pytest.mark.parametrize(("world", "frame_s"), [("graph", 10.0), ("physics", 0.5)])
def test_the_browsers_code_reads_the_same(make_run: MakeRun, world: str, frame_s: float) -> None:
    folder = make_run(worlds=("graph", "physics"), policies=("greedy",), episodes=1)
    replay = with_track(folder, world, frame_s)
    frames = len(replay.track_pose)
    frame = np.random.default_rng(1).uniform(0, frames - 1, 40)
    frame[:3] = 0.0, frames - 1, 4.0
    said = answers(shown(folder), world, frame * frame_s)
    yaw = np.unwrap(replay.track_pose[..., 2].astype(np.float64), axis=0)
    early = frame.astype(np.int64) + np.minimum(1.0, frame % 1.0 / 0.35)
    np.testing.assert_allclose(
        said["poses"][..., :2], linear(replay.track_pose[..., :2], frame), atol=0.0055
    )
    turned = linear(yaw, np.minimum(early, frames - 1) if world == "graph" else frame)
    np.testing.assert_allclose(said["poses"][..., 2], turned, atol=0.0055)
    np.testing.assert_allclose(said["items"], linear(replay.track_items, frame), atol=0.03)
    logged = load_logs(folder).steps.filter(world=world, episode=0).sort("step")
    shares = logged.select("pta_d", "pta_c").to_numpy()[: len(replay.item_present)]
    np.testing.assert_allclose(said["shares"], shares, atol=1e-9)
    both_ways = np.concatenate([replay.belief, replay.belief[::-1]])
    assert (said["belief"] == both_ways.reshape(len(both_ways), -1)).all()


def test_what_nobody_saw_is_discovered_as_it_is_collected(make_run: MakeRun) -> None:
    folder = make_run(policies=("greedy",), episodes=2)
    items = pl.read_parquet(folder / "items.parquet")
    assert items["t_collected"].null_count() < len(items)
    never = pl.lit(None, pl.Int64).alias("t_discovered")
    items.with_columns(never).write_parquet(folder / "items.parquet")
    said = answers(shown(folder), "graph", np.zeros(1))
    assert said["shares"][-1, 1] > 0.0
    assert (said["shares"][:, 0] == said["shares"][:, 1]).all()
