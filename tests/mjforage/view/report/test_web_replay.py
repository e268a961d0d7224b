"""The interactive replay's data: which episodes, how large, in which order."""

from collections.abc import Callable
from dataclasses import replace
from itertools import product

import pytest

from mjforage.base.atomic_files import write_bytes
from mjforage.base.errors import UserError
from mjforage.runs.episode_recording import Recording
from mjforage.view.report.run_logs import load_logs
from mjforage.view.report.web_entry import thinned
from mjforage.view.report.web_replay import web_replay
from tests.mjforage.view.report.replay_data import (
    MakeRun,
    entry_of,
    shown,
    with_physics,
)


def test_the_last_frame_is_kept() -> None:
    assert thinned(7, 3).tolist() == [0, 3, 6]
    assert thinned(8, 3).tolist() == [0, 3, 6, 7]
    assert thinned(1, 4).tolist() == [0]


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
    assert len(entry["text"]) < 400_000
    assert (entry["pose_stride"], entry["item_stride"]) == (1, 2)


def test_what_is_too_large_is_kept_at_fewer_frames(make_run: MakeRun) -> None:
    folder = make_run(worlds=("graph", "physics"), policies=("greedy",), episodes=1)
    with_physics(folder)
    sizes = {world: len(entry_of(shown(folder), world)["text"]) for world in ("graph", "physics")}
    budget = sizes["graph"] + sizes["physics"] // 2
    result = web_replay(load_logs(folder), budget)
    assert result is not None and result.left_out == 0
    entry = entry_of(result, "physics")
    assert len(entry["text"]) <= budget - sizes["graph"]
    assert entry["item_stride"] == 2 * entry["pose_stride"] > 2
    assert len(entry_of(result, "graph")["text"]) == sizes["graph"], "the small one pays nothing"


def test_what_does_not_fit_is_left_out_and_counted_first_episodes_last(make_run: MakeRun) -> None:
    folder = make_run(episodes=3, kept=(0, 1, 2))
    sizes = [len(entry["text"]) for entry in shown(folder).data["replays"]]
    firsts = sizes[0] + sizes[3]
    result = web_replay(load_logs(folder), firsts + min(sizes) // 2)
    assert result is not None and result.left_out == 4
    kept = [(entry["policy"], entry["episode"]) for entry in result.data["replays"]]
    assert kept == [("greedy", 0), ("levy", 0)]
    assert web_replay(load_logs(folder), 1) is None, "no episode has room"


def test_each_episode_is_named_by_its_rank_in_its_world_and_policy(make_run: MakeRun) -> None:
    cases = list(product(("graph", "hulls"), ("greedy", "levy")))
    folder = make_run(worlds=("graph", "hulls"), episodes=3, kept=(0, 1, 2))
    episodes = load_logs(folder).episodes
    entries = shown(folder).data["replays"]
    for world, policy in cases:
        own = episodes.filter(world=world, policy=policy).sort(
            "pta_c", "length", "episode", descending=[False, True, False]
        )
        worst, median, best = own["episode"].to_list()
        mine = [e for e in entries if (e["world"], e["policy"]) == (world, policy)]
        ranks = {e["episode"]: e["ranks"] for e in mine}
        assert "first" in ranks[0]
        assert ("worst" in ranks[worst], "median" in ranks[median], "best" in ranks[best]) == (
            (True,) * 3
        )
        assert sum(map(len, ranks.values())) == 4
    assert shown(make_run(episodes=1)).data["replays"][0]["ranks"] == []


def test_one_map_at_first_and_two_where_there_are_worlds(make_run: MakeRun) -> None:
    ladder = ("graph", "hulls", "debris", "physics")
    several = shown(make_run(worlds=ladder, replays=("levy",), episodes=1))
    assert several.panels == (True, True)
    assert [entry["world"] for entry in several.data["replays"]] == list(ladder)
    alone = make_run(episodes=1)
    assert shown(alone).panels == (True, False)
    assert shown(make_run(policies=("levy",), episodes=1)).panels == (True,)


def other_map(replay: Recording) -> Recording:
    return replace(replay, navigable=~replay.navigable)


def other_items(replay: Recording) -> Recording:
    return replace(replay, item_present=replay.item_present[:, 1:])


def other_policy(replay: Recording) -> Recording:
    return replace(replay, policy="levy")


@pytest.mark.parametrize("change", [other_map, other_items, other_policy])
def test_a_replay_of_another_run_is_refused(
    make_run: MakeRun, change: Callable[[Recording], Recording]
) -> None:
    folder = make_run(episodes=1)
    path = folder / "replay" / "graph-greedy-0.npz"
    write_bytes(path, change(Recording.load(path)).content())
    with pytest.raises(UserError, match=r"greedy-0\.npz: (is not of the run|.* does not fit)"):
        web_replay(load_logs(folder))
