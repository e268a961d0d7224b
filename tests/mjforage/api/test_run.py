"""A run's tables, differences, figures and files."""

from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

import mjforage as mf
from mjforage.metrics import compared
from tests.mjforage.api.conftest import drawn, nearest


@pytest.fixture(scope="module")
def run(bay: mf.Scenario) -> mf.Run:
    return mf.compare(bay, [nearest, drawn], episodes=3, progress=False)


def test_tables_are_copies(run: mf.Run) -> None:
    frame = run.episodes
    frame[0, "pta_c"] = -1.0
    assert run.episodes[0, "pta_c"] != -1.0


def test_the_summary_is_of_the_episodes(run: mf.Run) -> None:
    kind = {"metric": "length", "world": "graph", "policy": "drawn"}
    [row] = run.summary.filter(**kind).iter_rows(named=True)
    lengths = run.episodes.filter(world="graph", policy="drawn")["length"]
    assert row["mean"] == lengths.mean() and row["n"] == 3
    wide = run.summary.filter(pl.col("low") != pl.col("high"))
    assert wide.height and (wide["low"] < wide["high"]).all()


def test_differences_between_policies_and_between_worlds(run: mf.Run) -> None:
    def values(world: str, policy: str) -> "np.ndarray[tuple[int], np.dtype[np.float64]]":
        return run.episodes.filter(world=world, policy=policy)["pta_d"].to_numpy()

    found = run.differences("nearest", "drawn", metrics=["pta_d"])
    assert found["world"].to_list() == ["graph", "physics"]
    for row in found.iter_rows(named=True):
        mine, other = values(row["world"], "nearest"), values(row["world"], "drawn")
        assert (row["difference"], row["n"]) == (pytest.approx(float((mine - other).mean())), 3)
        assert row["p"] is None is row["low"], "too few episodes"
    gap = run.differences(world=("graph", "physics"), metrics=["pta_d"])
    assert gap["policy"].to_list() == ["nearest", "drawn"]
    wanted = (values("physics", "nearest") - values("graph", "nearest")).mean()
    assert gap[0, "difference"] == pytest.approx(wanted)
    assert gap[0, "world"] == "physics - graph"


def test_intervals_and_p_are_of_all_rows_together_and_tell_what_a_difference_needs() -> None:
    run = mf.evaluate("comb-port", ["greedy", "random"], episodes=12, horizon=30, record=())
    found = run.differences("greedy", "random", metrics=["pta_d", "pta_c", "nt50"])
    keys = found["metric"].to_list()
    columns = {who: run.episodes.filter(policy=who) for who in run.policies}
    gaps = [(columns["greedy"][key] - columns["random"][key]).to_numpy() for key in keys]
    family = compared(gaps)
    np.testing.assert_array_equal(found["p"].to_numpy(), family.p)
    np.testing.assert_array_equal(found["low"].to_numpy(), family.low)
    needed = run.episodes_needed(1.0, "pta_d")
    assert needed.columns == ["world", "policy", "metric", "sd", "episodes"]
    sd = float(np.std(gaps[keys.index("pta_d")], ddof=1))
    assert needed[0, "sd"] == pytest.approx(sd)
    assert needed[0, "episodes"] == int(np.ceil((1.959964 + 0.841621) ** 2 * sd**2 + 1.920729))
    assert run.episodes_needed(2 * sd, "pta_d")[0, "episodes"] == 4
    with pytest.raises(mf.UserError, match=r"difference = -1: give a finite number above 0"):
        run.episodes_needed(-1)


def test_figures_page_and_player(run: mf.Run, tmp_path: Path) -> None:
    assert run.plot("progress").axes
    assert run.report(tmp_path / "mine.html").read_text("utf-8").startswith("<!DOCTYPE html>")
    html = run.replay("drawn", episode=1)._repr_html_()
    assert html.startswith("<iframe srcdoc=") and "drawn in world graph, episode 1" in html
    table = run._repr_html_()
    assert table.count("<tr>") == 5 and "<script" not in table


def test_a_saved_run_is_the_run(run: mf.Run, tmp_path: Path) -> None:
    again = mf.load_run(run.save(tmp_path / "kept"))
    assert again.summary.equals(run.summary) and again.folder == tmp_path / "kept"
    assert np.array_equal(again.scenario.map.water, run.scenario.map.water)
    with pytest.raises(mf.UserError, match="kept: is there already"):
        run.save(tmp_path / "kept")


def test_frames_are_pictures_of_the_time_asked_for(run: mf.Run) -> None:
    early, late = (run.frame("drawn", time_s=time_s, size=(320, 180)) for time_s in (0.0, 60.0))
    assert early.shape == (180, 320, 3) and early.dtype == np.uint8
    assert (early != late).any()
    with pytest.raises(mf.UserError, match="start 1e\\+06 s: the episode lasts from 0 to 120 s"):
        run.frame("drawn", time_s=1e6)


def test_a_frame_is_of_its_policy_world_and_episode(run: mf.Run) -> None:
    how: dict[str, Any] = {"time_s": 60.0, "size": (320, 180), "camera": "top"}
    plain = run.frame("drawn", **how)
    other = {"policy": "nearest"}, {"world": "physics"}, {"episode": 1}
    for change in other:
        assert (run.frame(**{"policy": "drawn", **how, **change}) != plain).any(), change
