"""The player on the page: harmless, and its script reads what was written."""

import json
import re
import subprocess
from dataclasses import replace
from html import unescape
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
from numpy.typing import NDArray

from mjforage.base.atomic_files import write_bytes
from mjforage.base.errors import UserError
from mjforage.runs.episode_recording import Recording
from mjforage.view.page import html
from mjforage.view.report import write_report
from mjforage.view.report.web_replay import SCRIPTS, WebReplay
from tests.mjforage.view.report.replay_data import (
    NODE,
    MakeRun,
    entry_of,
    shown,
    with_link,
    with_physics,
    with_track,
)

pytestmark = pytest.mark.usefixtures("unprinted")


def player(page: str) -> str:
    return page.split('<section id="replay">', 1)[1].split("</section>", 1)[0]


def lengths_of(folder: Path) -> dict[str, float]:
    run = shown(folder).data["run"]
    return {agent["name"]: agent["length_m"] for agent in run["agents"]}


def test_hulls_are_as_long_as_those_that_ran(make_run: MakeRun) -> None:
    folder = make_run(policies=("greedy",), episodes=1)
    lengths = lengths_of(folder)
    assert (lengths["scouts_0"], lengths["foragers_0"]) == (1.35, 2.0)
    run = json.loads((folder / "run.json").read_text())
    run["hulls"] = {"vessels": {"scout": {"length_m": 3.5}}}
    (folder / "run.json").write_text(json.dumps(run))
    lengths = lengths_of(folder)
    assert (lengths["scouts_0"], lengths["foragers_0"]) == (3.5, 2.0)
    run["hulls"]["vessels"]["scout"] = {"length_m": "long"}
    (folder / "run.json").write_text(json.dumps(run))
    with pytest.raises(
        UserError, match=r"hulls.vessels.scout.length_m = 'long' should be a valid n"
    ):
        shown(folder)


def options(part: str, mark: str) -> list[str]:
    inside = part.split(mark, 1)[1].split("</select>", 1)[0]
    return [unescape(word) for word in re.findall(r"<option[^>]*>(.*?)</option>", inside)]


def test_the_player_of_three_worlds(make_run: MakeRun) -> None:
    worlds = ("graph", "hulls", "physics")
    folder = make_run(worlds=worlds, policies=("greedy",), episodes=1)
    with_physics(folder)
    template = html.environment().get_template("player/player.html.j2")
    part = player(template.render(replay=shown(folder)))
    assert part.count("<canvas tabindex") == 2 and 'panel" hidden' not in part
    for level in ("World", "Policy", "Episode"):
        assert part.count(f'aria-label="{level} of map') == 2
    assert options(part, 'id="player-follow"')[:2] == ["nobody", "scouts_0"]


CHOOSING = """
const { replays, before: place, level, value } = JSON.parse(process.argv[1]);
const before = replays[place];
const chosen = value === null ? besides(replays, before) : chooseAt(replays, before, level, value);
console.log(JSON.stringify([replays.indexOf(chosen), LEVELS.map((one) =>
  valuesAt(replays, chosen, one).map((each) => wordsOf(replays, chosen, one, each)))]));
"""


def replays_of(*keys: tuple[str, str, int, str]) -> list[dict[str, Any]]:
    names = ("world", "policy", "episode")
    return [dict(zip(names, key[:3], strict=True)) | {"ranks": key[3].split()} for key in keys]


def choose(
    replays: list[dict[str, Any]], before: int, level: str = "", value: object = None
) -> tuple[int, list[list[str]]]:
    """What the page's own code chooses, run by Node.js: which replay, and what it then offers."""
    if NODE is None:
        pytest.skip("Node.js is not installed")
    asked = {"replays": replays, "before": before, "level": level, "value": value}
    code = resources.files("mjforage.view.report").joinpath("player", "choice.js")
    script = code.read_text("utf-8") + CHOOSING
    done = subprocess.run(
        [NODE, "-e", script, json.dumps(asked)], capture_output=True, text=True, check=True
    )
    place, offered = json.loads(done.stdout)
    return int(place), offered


OWN_MEDIANS = replays_of(
    ("graph", "greedy", 0, "first"),
    ("graph", "greedy", 4, "worst"),
    ("graph", "levy", 0, "first"),
    ("graph", "levy", 2, "worst"),
    ("physics", "greedy", 0, "first"),
    ("physics", "greedy", 2, "median"),
    ("physics", "greedy", 4, "worst"),
)


def test_another_policy_is_shown_in_the_same_episode_else_in_that_of_the_same_rank() -> None:
    place, offered = choose(OWN_MEDIANS, 0, "policy", "levy")
    assert place == 2
    assert offered == [
        ["graph world", "physics world"],
        ["greedy", "levy"],
        ["episode 0 (first)", "episode 2 (worst)"],
    ]
    assert choose(OWN_MEDIANS, 1, "policy", "levy")[0] == 3, "its own worst"
    assert choose(OWN_MEDIANS, 1, "world", "physics")[0] == 6, "the same number and rank"
    assert choose(OWN_MEDIANS, 5, "world", "graph")[0] == 0, "neither: the first"


def test_beside_a_replay_stands_another_world_else_policy_else_episode() -> None:
    assert choose(OWN_MEDIANS[:7], 1)[0] == 6
    assert choose(OWN_MEDIANS[:4], 0)[0] == 2
    assert choose(OWN_MEDIANS[:2], 0)[0] == 1
    assert choose(OWN_MEDIANS[:1], 0)[0] == 0


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
  const { agents: fleet, period_s: period } = stage.run;
  const agents = fleet.map((_, i) => i), items = [...Array(entry.items).keys()];
  console.log(JSON.stringify({
    poses: times.map((time) => agents.map((i) => Object.values(episode.pose(i, time)))),
    items: times.map((time) => items.map((i) => Object.values(episode.item(i, time)))),
    winds: times.map((time) => Object.values(episode.wind(time))),
    shares: steps.map((step) => Object.values(episode.shares(step * period))),
    belief: [...steps, ...[...steps].reverse()].map((step) => [...episode.belief.at(step)]),
    minds: [-1, ...agents].map((agent) => [...steps, ...[...steps].reverse()].map((step) =>
      ["belief", "idleness", "view"].map((layer) => [...episode.mind(agent)[layer].at(step)]))),
    heard: steps.map((step) => agents.map((agent) => agents.map((other) =>
      episode.heardAt(agent, other, step)))),
    knows: [-1, ...agents].map((agent) => steps.map((step) =>
      items.map((item) => episode.knows(agent, item, step * period)))),
    links: steps.flatMap((step) => episode.links(step).map(({ a, b, lost }) => [step, a, b, lost])),
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
    logged = pl.read_parquet(folder / "steps.parquet").filter(world=world, episode=0).sort("step")
    shares = logged.select("pta_d", "pta_c").to_numpy()[: len(replay.item_present)]
    np.testing.assert_allclose(said["shares"], shares, atol=1e-9)
    stored = frame[:3].astype(int)
    np.testing.assert_allclose(said["winds"][:3], replay.track_wind[stored], atol=0.0055)
    layers = said["minds"][0, : len(replay.belief)]  # (step, layer, node)
    levels = np.rint(15 * replay.idleness.astype(np.float32))
    for layer, values in enumerate((replay.belief, levels, replay.in_view)):
        np.testing.assert_array_equal(layers[:, layer], values.reshape(len(values), -1))
    both_ways = np.concatenate([replay.belief, replay.belief[::-1]])
    assert (said["belief"] == both_ways.reshape(len(both_ways), -1)).all()


def test_what_nobody_saw_is_discovered_as_it_is_collected(make_run: MakeRun) -> None:
    folder = make_run(policies=("greedy",), episodes=2)
    path = folder / "replay" / "graph-greedy-0.npz"
    replay = Recording.load(path)
    never = np.full(replay.item_present.shape[1], -1, np.int16)
    write_bytes(path, replace(replay, t_discovered=never).content())
    said = answers(shown(folder), "graph", np.zeros(1))
    assert said["shares"][-1, 1] > 0.0
    assert (said["shares"][:, 0] == said["shares"][:, 1]).all()


def test_the_browsers_code_reads_what_each_vessel_knows(make_run: MakeRun) -> None:
    folder = make_run(policies=("greedy",), episodes=1)
    replay = with_link(folder)
    held, agents = replay.knowledge, len(replay.agent_team)
    assert held is not None
    said = answers(shown(folder), "graph", np.zeros(1))
    water, steps = replay.navigable.ravel(), np.arange(len(held.changes))
    for agent in range(agents):
        belief, seen = held.maps(agent, water.size)
        idle = np.rint(15 * np.minimum(1.0, (steps[:, None] - seen.astype(float)) * 0.05))
        view = np.where(seen == steps[:, None], replay.in_view.reshape(seen.shape), 0)
        for layer, values in enumerate((belief, idle, view)):
            both_ways = np.concatenate((values, values[::-1]))
            off = np.abs(said["minds"][agent + 1, :, layer][:, water] - both_ways[:, water])
            assert off.max() <= (layer == 1), "halves of a level of idleness round either way"
        known = (held.known_from[agent] >= 0) & (held.known_from[agent] <= steps[:, None])
        np.testing.assert_array_equal(said["knows"][agent + 1], known)
    pooled = replay.belief.reshape(len(steps), -1)
    np.testing.assert_array_equal(said["minds"][0, : len(steps), 0], pooled)
    np.testing.assert_array_equal(said["heard"], held.received)
    step, b, a = np.nonzero(np.triu(held.linked))
    lost = held.lost[step, a, b] + held.lost[step, b, a]
    expected = np.stack((step, a, b, lost), axis=1)
    np.testing.assert_array_equal(
        said["links"][np.lexsort(said["links"].T[::-1])], expected[np.lexsort(expected.T[::-1])]
    )


def test_the_page_offers_vessels_only_over_a_link(make_run: MakeRun) -> None:
    folder = make_run(policies=("greedy",), episodes=1)
    plain = player(write_report(folder).read_text("utf-8")).split("<script", 1)[0]
    assert "player-seen" not in plain and 'data-layer="links"' not in plain
    with_link(folder)
    part = player(write_report(folder).read_text("utf-8")).split("<script", 1)[0]
    names = ["all", "scouts_0", "scouts_1", "foragers_0", "foragers_1"]
    assert options(part, 'id="player-seen"') == names
    assert 'data-layer="links" checked' in part
