"""Selection of recorded episodes: those asked for, for each world and policy."""

import logging
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

from mjforage.base.errors import UserError
from mjforage.mission.setup import Setup
from mjforage.runs.episode_recording import Recording
from mjforage.runs.evaluate import evaluate
from mjforage.runs.selection import check_selection, parse_selection, ranks_of, recording_files
from mjforage.runs.workers import Workers
from mjforage.scenario.scenario_file import load_scenario


@pytest.mark.parametrize(
    ("text", "kept"),
    [
        ("0,3,worst", (0, 3, "worst")),
        (" first , 00,0", ("first", 0)),
        ("none", ()),
        ("best,best,median", ("best", "median")),
    ],
)
def test_a_list_of_numbers_and_ranks(text: str, kept: tuple[str | int, ...]) -> None:
    assert parse_selection(text) == kept


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("0,wrost", "wrost"),
        ("", ""),
        ("1,", ""),
        ("-1", "-1"),
        ("0,none", "none"),
        ("²", "²"),
        ("1.5", "1.5"),
    ],
)
def test_what_names_no_episode_is_named(text: str, word: str) -> None:
    with pytest.raises(UserError, match=f"--replay {text}: '{word}' names no episode; give epi"):
        parse_selection(text)


def test_an_episode_that_the_run_has_not_is_refused() -> None:
    assert check_selection((2, 0, 2), 3) == (2, 0)
    with pytest.raises(UserError, match="recorded episode 3: the run has episodes 0 to 2"):
        check_selection((0, 3), 3)


def test_ranks_go_by_the_share_collected_then_by_decisions() -> None:
    pta_c = np.array([100.0, 40.0, 100.0, 100.0, 90.0])
    length = np.array([80.0, 150.0, 90.0, 70.0, 150.0])
    found = ranks_of(pta_c, length)
    assert found == {"first": 0, "worst": 1, "median": 2, "best": 3}
    even = ranks_of(pta_c[:4], length[:4])
    assert even["median"] == 2, "the worse of the two in the middle"
    assert set(ranks_of(pta_c[:1], length[:1]).values()) == {0}


def run(folder: Path, **settings: Any) -> Path:
    setup = Setup.of(load_scenario("comb-port", ["horizon=25"]))
    evaluate(setup, ["greedy", "levy"], folder, **{"episodes": 5} | settings)
    return folder


def kept_in(folder: Path, policy: str) -> list[int]:
    return list(recording_files(folder, "graph", policy))


def by_rank(folder: Path, policy: str) -> list[int]:
    """Episodes from worst to best, by the logged shares."""
    rows = pl.read_parquet(folder / "episodes.parquet").filter(policy=policy)
    order = sorted(rows.iter_rows(named=True), key=lambda r: (r["pta_c"], -r["length"]))
    return [row["episode"] for row in order]


@pytest.fixture(scope="module")
def usual(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return run(tmp_path_factory.mktemp("kept") / "run")


def test_the_first_the_median_and_the_worst_of_each_policy_are_kept(usual: Path) -> None:
    for policy in ("greedy", "levy"):
        order = by_rank(usual, policy)
        assert kept_in(usual, policy) == sorted({0, order[0], order[2]})
    assert kept_in(usual, "greedy") != kept_in(usual, "levy"), "a seed where each has its own"


def test_what_is_kept_is_what_was_logged(usual: Path) -> None:
    logged = pl.read_parquet(usual / "agents.parquet")
    for policy in ("greedy", "levy"):
        for episode, path in recording_files(usual, "graph", policy).items():
            rows = logged.filter(policy=policy, episode=episode).sort("step", "agent")
            replay = Recording.load(path)
            assert (replay.policy, replay.episode) == (policy, episode)
            assert (replay.agent_rc.reshape(-1, 2) == rows.select("row", "col").to_numpy()).all()


@pytest.mark.parametrize("workers", [Workers(jobs=2)])
def test_other_workers_keep_the_same(usual: Path, tmp_path: Path, workers: Workers) -> None:
    other = run(tmp_path / "run", workers=workers)
    names = sorted(path.name for path in (usual / "replay").iterdir())
    assert sorted(path.name for path in (other / "replay").iterdir()) == names
    for name in names:
        assert (other / "replay" / name).read_bytes() == (usual / "replay" / name).read_bytes()


def test_the_choice_is_no_part_of_the_run_and_a_finished_one_is_added_to(tmp_path: Path) -> None:
    folder = run(tmp_path / "run", kept=())
    assert not (folder / "replay").exists()
    before = {path.name: path.read_bytes() for path in folder.glob("*.parquet")}
    run(folder, kept=(3, "best"))
    best = by_rank(folder, "levy")[-1]
    assert kept_in(folder, "levy") == sorted({3, best})
    run(folder, kept=(1,))
    assert kept_in(folder, "levy") == sorted({1, 3, best}), "what is there stays"
    assert {path.name: path.read_bytes() for path in folder.glob("*.parquet")} == before


def test_an_episode_that_does_not_come_out_as_logged_is_not_kept(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    folder = run(tmp_path / "run", kept=())
    agents = pl.read_parquet(folder / "agents.parquet")
    moved = pl.when(pl.col("episode") == 1, pl.col("policy") == "levy").then(1.0).otherwise(0.0)
    agents.with_columns((pl.col("x_m") + moved).cast(pl.Float32)).write_parquet(
        folder / "agents.parquet"
    )
    with caplog.at_level(logging.WARNING):
        run(folder, kept=(1, 2))
    assert (kept_in(folder, "greedy"), kept_in(folder, "levy")) == ([1, 2], [2])
    (said,) = caplog.messages
    assert "episode 1 of levy in world graph does not come out as logged" in said
