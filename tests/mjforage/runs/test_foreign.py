"""Folders of anybody: names that could be paths, links, and files too large to be ours."""

import io
import json
import os
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

from mjforage.base.errors import UserError
from mjforage.mission.setup import Setup
from mjforage.runs import foreign
from mjforage.runs.episode_recording import Recording
from mjforage.runs.evaluate import evaluate
from mjforage.runs.resuming import archive, open_folder
from mjforage.runs.run_info import load_run, read_json
from mjforage.runs.selection import recording_file
from mjforage.runs.studies.study import load_study_info
from mjforage.scenario import sizes
from mjforage.scenario.scenario_file import load_scenario
from mjforage.view.report import write_report

AWAY = "a/../../X"


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of a short episode, which no test changes."""
    folder = tmp_path_factory.mktemp("made") / "run"
    setup = Setup.of(load_scenario("comb-port", ["horizon=4"]))
    evaluate(setup, ["greedy"], folder, episodes=1)
    return folder


@pytest.fixture
def run(made: Path, tmp_path: Path) -> Path:
    """The same, to be spoilt."""
    for file in (one for one in made.rglob("*") if one.is_file()):
        target = tmp_path / "run" / file.relative_to(made)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(file.read_bytes())
    return tmp_path / "run"


def content(run: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((run / "run.json").read_text())
    return found


def spoil(run: Path, key: str, name: str) -> None:
    """Give a name of `run.json` another value."""
    info = content(run)
    if key == "worlds":
        info["worlds"] = [name]
    elif key == "scenario.team":
        info["scenario"]["team"] = {name: {}}
    else:
        info["agents"][0][key.partition(".")[2]] = name
    (run / "run.json").write_text(json.dumps(info))


def test_what_no_run_holds_is_refused_before_it_is_drawn(run: Path) -> None:
    """A few thousand bytes that would take gigabytes: decimals, agents."""
    info = content(run)
    decimals = [one | {"digits": 10**6} for one in info["metrics"]]
    for key, value in (("metrics", decimals), ("agents", info["agents"] * 300)):
        (run / "run.json").write_text(json.dumps(info | {key: value}))
        with pytest.raises(UserError, match=rf"run.json: {key}.*; ") as caught:
            load_run(run / "run.json")
        assert "\n" not in str(caught.value) and len(str(caught.value)) < 1000


@pytest.mark.parametrize("key", ["worlds", "agents.team", "agents.name", "scenario.team"])
@pytest.mark.parametrize("name", [AWAY, "..", "", "C:x", "a\0b", "x\n", "/etc", "a\\b"])
def test_names_that_could_be_paths_are_refused(run: Path, key: str, name: str) -> None:
    spoil(run, key, name)
    words = rf"run.json: {key.partition('.')[0]}.*can be no part of a file's name"
    with pytest.raises(UserError, match=words) as caught:
        load_run(run / "run.json")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("key", ["variants", "worlds", "own"])
def test_names_of_a_study_are_refused_alike(tmp_path: Path, key: str) -> None:
    variant = {"title": "", "policies": ["greedy"], "worlds": [AWAY] if key == "own" else []}
    info = {
        "command": "",
        "started": "",
        "kind": "ablation",
        "scenario": {},
        "episodes": 1,
        "seed": 0,
        "options": {},
        "worlds": [AWAY if key == "worlds" else "graph"],
        "variants": {AWAY if key == "variants" else "complete": variant},
    }
    (tmp_path / "study.json").write_text(json.dumps(info))
    with pytest.raises(UserError, match=r"study.json: .*'a/../../X' can be no part of a file"):
        load_study_info(tmp_path / "study.json")


def test_metrics_of_anybody_name_no_file_elsewhere(run: Path) -> None:
    """A column that nobody knows gets a figure of its own, named by it."""
    path = run / "steps.parquet"
    frame = pl.read_parquet(path)
    frame.with_columns(frame["mi"].alias("../../X")).write_parquet(path)
    write_report(run)
    assert not list(run.parent.glob("*X*")) and not list(run.glob("*X*"))
    assert any("X" in one.name for one in (run / "figures").iterdir())


@pytest.mark.parametrize("place", ["report.html", "figures", "tables", "replay/x.npz", ".lock"])
@pytest.mark.parametrize("kind", ["link", "dangling"])
def test_links_in_a_folder_are_refused(run: Path, place: str, kind: str) -> None:
    victim = run.parent / "victim"
    victim.mkdir()
    (victim / "file").write_text("mine")
    (run / place).parent.mkdir(exist_ok=True)
    if (run / place).is_dir():
        (run / place).rename(run.parent / "aside")
    (run / place).unlink(missing_ok=True)
    target = victim if place in ("figures", "tables") else victim / "file"
    (run / place).symlink_to(target if kind == "link" else victim / "none")
    for opened in (
        lambda: write_report(run),
        lambda: open_folder(run, "run", content(run), ("seed",)),
        lambda: archive(run, "run"),
    ):
        with pytest.raises(UserError, match=f"{place}: is a link or a device") as caught:
            opened()
        assert "\n" not in str(caught.value)
    assert [one.name for one in victim.iterdir()] == ["file"]
    assert (victim / "file").read_text() == "mine"


def test_a_lock_is_no_file_elsewhere(tmp_path: Path) -> None:
    """Not even in a folder that holds nothing else: to lock a file empties it."""
    (tmp_path / "victim").write_text("mine")
    (tmp_path / "new").mkdir()
    (tmp_path / "new" / ".lock").symlink_to(tmp_path / "victim")
    setup = Setup.of(load_scenario("comb-port", ["horizon=4"]))
    with pytest.raises(UserError, match=r"\.lock: is a link or a device"):
        evaluate(setup, ["greedy"], tmp_path / "new", episodes=1)
    assert (tmp_path / "victim").read_text() == "mine"


def test_a_pipe_is_refused_and_not_waited_for(run: Path) -> None:
    (run / "run.json").unlink()
    os.mkfifo(run / "run.json")
    with pytest.raises(UserError, match=r"run.json: is a link or a device"):
        load_run(run / "run.json")


def test_a_folder_that_is_none_of_ours_is_not_searched(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(tmp_path)
    with pytest.raises(UserError, match=r"run.json: file is missing"):
        load_run(tmp_path / "run.json")


def test_the_folder_itself_may_be_reached_by_a_link(run: Path) -> None:
    (run.parent / "link").symlink_to(run)
    assert load_run(run.parent / "link" / "run.json").policies == ("greedy",)


def test_files_that_unpack_to_more_than_the_machine_has_are_refused(
    run: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = recording_file(run, "graph", "greedy", 0)
    assert Recording.load(path).policy == "greedy"
    zeros = io.BytesIO()
    np.save(zeros, np.zeros(10**7, np.int8))
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("belief.npy", zeros.getvalue())
    assert path.stat().st_size < 10**5
    monkeypatch.setattr(sizes, "machine_bytes", lambda: 10**6)
    with pytest.raises(UserError, match=r"greedy-0.npz needs about 0 GB of memory, this machine"):
        Recording.load(path)


def test_a_json_file_larger_than_any_of_ours_is_refused(
    run: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(foreign, "_LARGEST", 100)
    with pytest.raises(UserError, match="0 MB are more than any run writes; run what"):
        read_json(run / "run.json")
