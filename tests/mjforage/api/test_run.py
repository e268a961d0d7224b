"""A run's tables, differences, figures and files."""

from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

import mjforage as mf
from mjforage.metrics import holm, paired_difference, paired_p
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
        wanted = paired_difference(mine - other, np.zeros(3), 0)
        assert (row["difference"], row["n"]) == (pytest.approx(float(wanted.value)), 3)
        assert row["p"] == pytest.approx(float(paired_p(mine, other)), nan_ok=True)
    gap = run.differences(world=("graph", "physics"), metrics=["pta_d"])
    assert gap["policy"].to_list() == ["nearest", "drawn"]
    wanted = (values("physics", "nearest") - values("graph", "nearest")).mean()
    assert gap[0, "difference"] == pytest.approx(wanted)
    assert gap[0, "world"] == "physics - graph"


def test_p_values_are_corrected_for_all_rows(run: mf.Run) -> None:
    found = run.differences("nearest", "drawn")
    assert found["p_holm"].to_list() == pytest.approx(holm(found["p"]).tolist(), nan_ok=True)
    assert (found["p_holm"] > found["p"]).any()


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
