import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

from mjforage.base.errors import UserError
from mjforage.mission.setup import Setup
from mjforage.runs.evaluate import evaluate
from mjforage.runs.recording import record
from mjforage.runs.replaying import recording_of_run
from mjforage.scenario.scenario_file import load_scenario
from mjforage.scenario.vessel_files import vessel_path


def error_of(
    folder: Path, world: str = "graph", policy: str | None = None, episode: int = 0
) -> str:
    with pytest.raises(UserError) as caught:
        recording_of_run(folder, world, policy, episode)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def change(path: Path, edit: Callable[[dict[str, Any]], object]) -> None:
    content = json.loads(path.read_text())
    edit(content)
    path.write_text(json.dumps(content))


@pytest.mark.parametrize("policy", ["greedy", "levy"])
@pytest.mark.parametrize("episode", [0, 2])
def test_an_episode_comes_out_as_logged(finished: Path, policy: str, episode: int) -> None:
    replay = recording_of_run(finished, "graph", policy, episode)
    key = (pl.col("policy") == policy) & (pl.col("episode") == episode)
    items = pl.read_parquet(finished / "items.parquet").filter(key)
    assert (replay.policy, replay.episode, replay.seed) == (policy, episode, 0)
    assert replay.item_rc.shape[1] == items.height
    assert np.array_equal(replay.item_rc[0], items.select("row_start", "col_start").to_numpy())
    found = items["t_discovered"].fill_null(-1).to_numpy()
    np.testing.assert_array_equal(replay.t_discovered, found)
    removed = items["t_collected"].fill_null(10_000).to_numpy()
    steps = np.arange(len(replay.item_present))
    assert np.array_equal(replay.item_present, steps[:, None] < removed[None, :])


def test_a_recorded_episode_is_the_one_that_is_played_again(run_copy: Path) -> None:
    stored = recording_of_run(run_copy, "graph", None, 0)
    (run_copy / "replay" / "graph-greedy-0.npz").unlink()
    played = recording_of_run(run_copy, "graph", None, 0)
    for name, value in vars(played).items():
        assert np.array_equal(value, getattr(stored, name)), name


@pytest.mark.parametrize(
    ("choice", "words"),
    [
        ({"episode": 3}, "no episode 3 of greedy in world graph; it holds episodes 0 to 2"),
        ({"episode": -1}, "no episode -1 of greedy"),
        (
            {"policy": "pso"},
            "no episode 0 of pso in world graph; it holds episodes 0 to 2 of greedy",
        ),
        ({"world": "physics"}, "no episode 0 of greedy in world physics"),
    ],
)
def test_what_the_run_does_not_hold_is_named(
    finished: Path, choice: dict[str, Any], words: str
) -> None:
    assert words in error_of(finished, **choice)


def test_a_tampered_log_does_not_come_out(run_copy: Path) -> None:
    path = run_copy / "agents.parquet"
    frame = pl.read_parquet(path)
    east = frame["x_m"].to_list()
    east[-1] += 0.01
    frame.with_columns(x_m=pl.Series(east, dtype=pl.Float32)).write_parquet(path)
    assert recording_of_run(run_copy, "graph", "levy", 0).episode == 0
    message = error_of(run_copy, policy="levy", episode=2)
    assert "episode 2 of levy does not come out as logged" in message


def test_a_shortened_log_does_not_come_out(run_copy: Path) -> None:
    path = run_copy / "agents.parquet"
    pl.read_parquet(path).filter(pl.col("step") < 12).write_parquet(path)
    assert "does not come out as logged" in error_of(run_copy)


def test_a_hull_that_was_changed_since_does_not_come_out(tmp_path: Path) -> None:
    boat, run = tmp_path / "boat.toml", tmp_path / "run"
    boat.write_text(vessel_path("scout").read_text())
    overrides = ("horizon=2", f"physics.vessels.scouts='{boat}'")
    setup = Setup.of(load_scenario("comb-port", overrides))
    evaluate(setup, ["levy"], run, episodes=1, worlds=("physics",), kept=())
    assert recording_of_run(run, "physics", None, 0).policy == "levy"
    boat.write_text(boat.read_text().replace("mass_kg = { value = 36.0", "mass_kg = { value = 72"))
    message = error_of(run, "physics")
    assert "it was made with other versions, code or vessels" in message
    assert 'again with resume="fresh" (--fresh)' in message


@pytest.mark.parametrize("content", [None, b"", b"PAR1"])
def test_a_spoilt_log_is_named(run_copy: Path, content: bytes | None) -> None:
    path = run_copy / "agents.parquet"
    path.unlink()
    if content is not None:
        path.write_bytes(content)
    missing = "missing, as in a run that is not finished; run"
    words = missing if content is None else "missing, truncated or not Parquet"
    assert error_of(run_copy).startswith(f"{path}: {words}")


@pytest.mark.parametrize(
    ("edit", "words"),
    [
        (lambda run: run.update(seed=1), "does not come out as logged"),
        (lambda run: run.pop("map"), "missing map; run what"),
        (
            lambda run: run.update(policies=["gready"]),
            "policy gready: unknown; did you mean greedy",
        ),
        (lambda run: run["scenario"].update(horizn=3), "unknown key horizn; did you mean horizon?"),
        (lambda run: run["scenario"]["map"].update(starts=[[0, 0]]), "start (0, 0) of"),
        (lambda run: run.update(timings=3), "timings = 3 should be a table; run what"),
        (
            lambda run: run.update(timings={"wall_s": "x"}),
            "timings.wall_s = 'x' should be a",
        ),
        (lambda run: run.update(policies=[]), "policies = []: Tuple should have at lea"),
        (lambda run: run["scenario"].update(horizon=0), "scenario: horizon = 0 should be "),
        (lambda run: run["map"].update(rows=3), "map.navigable is not 3 strings"),
    ],
)
def test_a_tampered_run_json_is_named(
    run_copy: Path, edit: Callable[[dict[str, Any]], object], words: str
) -> None:
    shutil.rmtree(run_copy / "replay")
    change(run_copy / "run.json", edit)
    assert words in error_of(run_copy)


def test_the_map_file_is_not_needed_any_more(tmp_path: Path) -> None:
    path = tmp_path / "harbour.csv"
    path.write_text("1,1,1,1\n1,1,1,1\n1,1,1,1\n")
    starts = path.with_name("harbour.starts.csv")
    starts.write_text("0,0\n0,1\n1,0\n1,1\n")
    setup = Setup.of(load_scenario("channels", ["horizon=3"], str(path)))
    evaluate(setup, ["random"], tmp_path / "run", episodes=2)
    path.unlink()
    starts.unlink()
    replay = recording_of_run(tmp_path / "run", "graph", "random", 1)
    assert replay.navigable.shape == (3, 4)
    assert {tuple(rc) for rc in replay.agent_rc[0].tolist()} == {(0, 0), (0, 1), (1, 0), (1, 1)}


def test_a_replay_tells_which_items_were_missed() -> None:
    """Detection is honoured: an item in view that nobody noticed is not discovered."""
    overrides = ["horizon=2", "sensors.detection=0.3", "items.mean=300", "map.starts=[]"]
    setup = Setup.of(load_scenario("comb-port", overrides))
    replay = record(setup, "physics", "greedy", 0, 0)
    node = np.rint(replay.item_rc).astype(int)
    seen = replay.in_view[np.arange(3)[:, None], node[..., 0], node[..., 1]] > 0
    in_view = (seen & replay.item_present).any(axis=0)
    found = replay.t_discovered >= 0
    assert (found & in_view).any() and (~found & in_view).any()
