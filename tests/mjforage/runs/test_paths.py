"""Runs and trainings of a scenario's file whose place, record and vessel lie beside it."""

import json
import logging
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import shapely

import mjforage as mf
from mjforage.base.cached import warn_once
from mjforage.base.errors import UserError
from mjforage.scenario.vessel_files import vessel_path
from tests.mjforage.scenario.placing.drawn import geojson

HOURS = "".join(f"2024-06-01T{h:02}:00,{3 + h / 4},{200 + 3 * h}\n" for h in range(24))
MINE = """extends = "open-bay"
horizon = 4
[map]
file = "port"
[items]
mean = 5.0
[weather]
file = "wind.csv"
[physics.vessels]
foragers = "boat.toml"
[team.foragers]
moves = "from vessel"
"""
MOVES = "team.foragers.moves = 1, from vessel boat"
TINY = {"num_envs": 2, "capacity": 1000, "batch": 4, "warmup": 4, "evaluate_episodes": 1}


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Folder of a scenario's files, with another one as working folder."""
    folder = tmp_path / "project"
    folder.mkdir()
    water = [(shapely.box(-30, -20, 30, 20), {"natural": "water"})]
    mf.Map.of_chart(geojson(folder / "basin.geojson", water), folder / "port", pitch_m=4.0)
    (folder / "wind.csv").write_text("time,wind_speed_mps,wind_from_deg\n" + HOURS)
    (folder / "boat.toml").write_bytes(vessel_path("forager").read_bytes())
    (folder / "mine.toml").write_text(MINE)
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path)
    warn_once.cache_clear()
    yield folder
    warn_once.cache_clear()


def test_a_run_finds_its_vessels_from_any_folder(
    project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = mf.evaluate(
        "project/mine.toml", "greedy", world="physics", episodes=2, record=[0], folder="run"
    )
    assert MOVES in run.warnings
    monkeypatch.chdir(project.parent / "elsewhere")
    found = mf.load_run(project.parent / "run")
    info = json.loads((project.parent / "run" / "run.json").read_text())
    boat = project / "boat.toml"
    assert info["scenario"]["physics"]["vessels"] == {"foragers": str(boat)}
    assert list(info["hulls"]["vessels"]) == ["scout", str(boat)]
    assert found.report().is_file()
    for episode in (0, 1):
        assert found.export(f"scene-{episode}", "mjcf", episode=episode).is_dir()
    boat.unlink()
    with pytest.raises(UserError, match=f"^vessel {boat}: neither a shipped vessel nor a TOML"):
        found.export("gone", "mjcf", episode=1)


def test_a_run_goes_on_from_any_folder(project: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the same scenario, named from there or taken from the run itself."""
    folder = project.parent / "run"
    monkeypatch.chdir(project)
    mf.evaluate("mine.toml", "greedy", episodes=1, folder=folder)
    monkeypatch.chdir(project.parent / "elsewhere")
    again = mf.evaluate("../project/mine.toml", "greedy", episodes=2, folder=folder)
    assert again.scenario.to_dict()["map"]["file"] == str(project / "port")
    found = mf.evaluate(mf.load_run(folder).scenario, "greedy", episodes=3, folder=folder)
    assert found.episodes["episode"].to_list() == [0, 1, 2]


def test_a_run_is_shown_from_any_folder(project: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """`mjforage render` makes an episode anew that was not recorded, with vessels and record."""
    from mjforage.cli import main

    monkeypatch.chdir(project)
    mf.evaluate("mine.toml", "greedy", world="physics", episodes=2, record=[0], folder="../run")
    monkeypatch.chdir(project.parent / "elsewhere")
    for episode in ("0", "1"):
        main(["render", "../run", "--episode", episode, "-o", f"{episode}.png"])
        assert Path(f"{episode}.png").stat().st_size > 1000


def test_a_training_has_its_files_from_the_folder_of_the_scenario(
    project: Path, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It tells moves once, goes on from any folder, and does not with another record."""
    how: dict[str, Any] = {"settings": TINY, "folder": project.parent / "learned"}
    with caplog.at_level(logging.WARNING):
        mf.train("ddqn", "project/mine.toml", updates=1, **how)
    said = [record.message for record in caplog.records]
    assert said.count(MOVES) == 1
    info = json.loads((project.parent / "learned" / "training.json").read_text())
    assert info["scenario"]["weather"]["file"] == str(project / "wind.csv")
    assert info["scenario"]["map"]["file"] == str(project / "port")
    monkeypatch.chdir(project.parent / "elsewhere")
    mf.train("ddqn", "../project/mine.toml", updates=2, **how)
    changed = (project / "wind.csv").read_text().replace(",200", ",190")
    (project / "wind.csv").write_text(changed)
    with pytest.raises(UserError, match="holds another training: maps is"):
        mf.train("ddqn", "../project/mine.toml", updates=3, **how)


def test_a_training_keeps_the_place_of_a_map_that_is_an_object(project: Path) -> None:
    bay = mf.load_scenario("open-bay", map=mf.Map(project / "port"), horizon=4)
    mf.train("ddqn", bay, updates=1, folder="learned", settings=TINY)
    assert mf.Map(project.parent / "learned.place").place == bay.map.place


def test_an_environment_says_once_which_moves_follow(
    project: Path, caplog: pytest.LogCaptureFixture
) -> None:
    from mjforage.learning.environments.options import EnvironmentOptions

    with caplog.at_level(logging.WARNING):
        for _ in range(2):
            EnvironmentOptions("project/mine.toml", "physics")
    said = [record.message for record in caplog.records if "from vessel" in record.message]
    assert said == [MOVES]
