import json
import math
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jsonschema
import polars as pl
import pytest

from mjforage.base.errors import UserError
from mjforage.graph_planner.networks.weights import shipped_weights
from mjforage.graph_planner.policies.registry import check_policies
from mjforage.mission.scoring import chosen_metrics, description
from mjforage.mission.setup import Setup
from mjforage.runs import evaluate as module
from mjforage.runs import layout
from mjforage.runs.costs import Costs
from mjforage.runs.episode_recording import Recording
from mjforage.runs.evaluate import evaluate, summarise
from mjforage.runs.run_info import RunInfo
from mjforage.runs.tables import SCHEMAS, TABLES
from mjforage.scenario.scenario_file import load_scenario
from mjforage.scenario.schema import json_schema

Small = Callable[..., Path]
HORIZON = 12


def tables(folder: Path, policy: str | None = None) -> dict[str, pl.DataFrame]:
    """The merged tables of a run, or one policy's rows of them."""
    frames = {table: pl.read_parquet(folder / f"{table}.parquet") for table in TABLES}
    if policy is None:
        return frames
    return {table: frame.filter(pl.col("policy") == policy) for table, frame in frames.items()}


def test_every_policy_meets_the_same_items(finished: Path) -> None:
    greedy, levy = (tables(finished, policy) for policy in ("greedy", "levy"))
    world = ["episode", "item", "row_start", "col_start"]
    assert greedy["items"].select(world).equals(levy["items"].select(world))
    assert greedy["episodes"]["items"].equals(levy["episodes"]["items"])
    assert not greedy["agents"]["node"].equals(levy["agents"]["node"])
    start = pl.col("step") == 0
    assert greedy["agents"].filter(start)["node"].equals(levy["agents"].filter(start)["node"])


def test_another_seed_is_another_world(
    finished: Path, evaluate_small: Small, tmp_path: Path
) -> None:
    other = tables(evaluate_small(tmp_path / "other", seed=1))
    assert not other["items"]["row_start"].equals(tables(finished)["items"]["row_start"])


def test_a_run_folder_holds_what_it_should(finished: Path) -> None:
    names = {path.name for path in finished.iterdir()}
    assert names == {
        ".lock",
        "run.json",
        "costs.json",
        "summary.json",
        "replay",
        *(f"{t}.parquet" for t in TABLES),
    }
    frames, run = tables(finished), json.loads((finished / "run.json").read_text())
    jsonschema.validate(run, json_schema(RunInfo))
    jsonschema.validate(json.loads((finished / "costs.json").read_text()), json_schema(Costs))
    assert set(frames) == set(SCHEMAS)
    assert frames["episodes"].height == 2 * 3
    assert frames["steps"].height == 2 * 3 * (HORIZON + 1)
    assert frames["items"].height == frames["episodes"]["items"].sum()
    assert frames["agents"].height == 4 * int((frames["episodes"]["length"] + 1).sum())
    assert frames["agents"].filter(pl.col("step") == 0)["outcome"].unique().to_list() == ["start"]
    assert [agent["name"] for agent in run["agents"]] == [
        *("scouts_0", "scouts_1", "foragers_0", "foragers_1"),
    ]
    assert (run["map"]["rows"], run["map"]["columns"], run["map"]["nodes"]) == (62, 46, 1297)
    assert sum(row.count("1") for row in run["map"]["navigable"]) == 1297
    assert set(run["versions"]) == {"mjforage", "numpy", "numba", "scipy", "python"}
    assert run["timings"]["wall_s"] > 0
    assert len(run["hash"]) == 16


def test_every_decision_is_logged(finished: Path) -> None:
    """At graph level a move ends in its target, in the direction that was chosen."""
    agents = tables(finished)["agents"].sort("policy", "episode", "agent", "step")
    assert (agents["node"] == agents["target"]).all()
    assert (agents["direction"].is_null() == (agents["step"] == 0)).all()
    moved = agents.with_columns(
        north=-pl.col("row").diff().sign(), east=pl.col("col").diff().sign()
    ).drop_nulls("direction")
    compass = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (0, 0)]
    assert moved.select("north", "east").rows() == [compass[d] for d in moved["direction"]]


def test_summary_is_of_the_episodes_with_null_where_undefined(finished: Path) -> None:
    summary = json.loads((finished / "summary.json").read_text(), parse_constant=pytest.fail)
    assert list(summary) == ["graph"]
    assert list(summary["graph"]) == ["greedy", "levy"]
    for policy, entries in summary["graph"].items():
        rows = tables(finished, policy)["episodes"]
        assert list(entries) == [one.key for one in chosen_metrics()]
        for key, entry in entries.items():
            assert list(entry) == ["mean", "sem", "ci95", "iqm", "worst5", "n"]
            values = [value for value in rows[key] if not math.isnan(value)]
            assert entry["n"] == len(values)
            if values:
                assert entry["mean"] == pytest.approx(sum(values) / len(values))
            if len(values) > 1:
                low, high = entry["ci95"]
                assert low - 1e-9 <= entry["mean"] <= high + 1e-9
            else:
                assert entry["sem"] is None


def test_summary_of_numbers_known_by_hand() -> None:
    row = {"world": "graph", "policy": "a", "items": 5}
    frame = pl.DataFrame(
        [
            row | {"episode": i, "pta_c": value, "csr": csr, "dsl": math.nan, "nt50": 2.0}
            for i, (value, csr) in enumerate(((1.0, 0.5), (3.0, math.nan), (5.0, 0.7)))
        ]
    )
    entries = summarise(frame, map(description, chosen_metrics()), 150)["graph"]["a"]
    assert entries["pta_c"]["mean"] == 3.0
    assert entries["pta_c"]["sem"] == pytest.approx(2 / math.sqrt(3))
    assert (entries["csr"]["mean"], entries["csr"]["n"]) == (pytest.approx(0.6), 2)
    assert entries["dsl"] == UNDEFINED
    assert entries["pta_c"]["worst5"] == 1.0
    share = 1 - 0.05 ** (1 / 3)  # of episodes with 0, of which three are none
    assert entries["nt50"]["ci95"] == pytest.approx([2.0 - 2.0 * share, 2.0])


UNDEFINED = dict.fromkeys(("mean", "sem", "iqm", "worst5")) | {"ci95": [None, None], "n": 0}
EVERYWHERE = {
    *("pta_d", "pta_c", "rmse", "rmse_columns", "nt50", "nt90", "mi_final", "mi_mean", "irr_mean"),
    *("itl", "itl_level", "length", "cleared", "below_90", "aoi", "aoi_peak"),
}
OF_LINKS = {
    *("position_age", "disagreement", "rmse_holders", "contact"),
    *("delivered", "lost", "dropped", "bytes_sent", "handover"),
}
OF_FORECASTS = {"brier_skill", "calibration_error", "reliability"}


def undefined(frame: pl.DataFrame) -> set[str]:
    """Columns with a NaN in every row."""
    nan = frame.select(pl.selectors.float().is_nan().mean()).row(0, named=True)
    return {name for name, share in nan.items() if share == 1.0}


def test_a_fleet_without_scouts_leaves_their_metrics_undefined(
    evaluate_small: Small, tmp_path: Path
) -> None:
    overrides = ["team.scouts.count=0", "team.foragers.radius=3", "items.covariance_node2=200"]
    run = evaluate_small(tmp_path / "run", overrides=overrides, horizon=60, policies=["greedy"])
    rows = tables(run)["episodes"]
    assert (
        undefined(rows)
        == {"throughput_scouts", "gini_scouts", "co_scouts", "dsl"} | OF_LINKS | OF_FORECASTS
    )
    assert (rows["pta_c"] > 0).all()
    assert (rows["csr"] == 0).all()
    assert not rows.select(pl.col(*EVERYWHERE).is_nan().any()).row(0).count(True)
    entry = json.loads((run / "summary.json").read_text())["graph"]["greedy"]["co_scouts"]
    assert entry == UNDEFINED


def test_a_fleet_without_foragers_removes_nothing(evaluate_small: Small, tmp_path: Path) -> None:
    run = evaluate_small(tmp_path / "run", overrides=["team.foragers.count=0"])
    frames = tables(run)
    rows = frames["episodes"]
    missing = {"throughput", "gini_foragers", "co_foragers", "csr", "dsl", "energy_per_item"}
    assert undefined(rows) == missing | OF_LINKS | OF_FORECASTS
    assert (rows["pta_c"] == 0).all()
    assert frames["items"]["t_collected"].null_count() == frames["items"].height
    assert not rows.select(pl.col(*EVERYWHERE).is_nan().any()).row(0).count(True)


def test_teams_of_any_name_and_number_run(evaluate_small: Small, tmp_path: Path) -> None:
    more = "{count=1, moves=3, radius=6.0, collects=true, capacity=2, energy=20.0}"
    run = evaluate_small(tmp_path / "run", overrides=[f"team.helpers={more}"], policies=["levy"])
    info = json.loads((run / "run.json").read_text())
    assert [agent["name"] for agent in info["agents"]][-1] == "helpers_0"
    assert tables(run)["agents"]["agent"].max() == 4


def recompute_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        pytest.fail("a finished run was computed again")

    monkeypatch.setattr(module, "run_chunk", fail)


def test_a_finished_run_is_left_alone(
    run_copy: Path, evaluate_small: Small, monkeypatch: pytest.MonkeyPatch
) -> None:
    recompute_nothing(monkeypatch)
    before = {path: path.stat().st_mtime_ns for path in run_copy.rglob("*") if path.is_file()}
    evaluate_small(run_copy)
    assert {p: p.stat().st_mtime_ns for p in run_copy.rglob("*") if p.is_file()} == before


@pytest.mark.parametrize("name", ["summary.json", "replay/graph-levy-0.npz"])
@pytest.mark.parametrize("content", [b"", b"PK\x03\x04 half", b"{}"])
def test_what_follows_from_the_tables_is_mended(
    name: str,
    content: bytes,
    run_copy: Path,
    evaluate_small: Small,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    recompute_nothing(monkeypatch)
    whole = (run_copy / name).read_bytes()
    (run_copy / name).write_bytes(content)
    evaluate_small(run_copy)
    if name == "summary.json":
        assert (run_copy / name).read_bytes() == whole
    else:
        assert Recording.load(run_copy / name).policy == "levy"


def test_weights_that_changed_are_another_run(
    evaluate_small: Small, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.copy(shipped_weights("ddqn"), "mine.safetensors")
    evaluate_small(tmp_path / "run", policies=["mine"], episodes=1)
    shutil.copy(shipped_weights("ddqn-reward"), "mine.safetensors")
    with pytest.raises(UserError, match=r"weights.mine is .* there and .* here"):
        evaluate_small(tmp_path / "run", policies=["mine"], episodes=1)


@pytest.fixture
def harbour(tmp_path: Path) -> Path:
    """Return a user's map with starts beside it."""
    path = tmp_path / "harbour.csv"
    path.write_text("0,0,0,0,0,0\n0,1,1,1,1,0\n0,1,1,1,1,0\n0,1,1,1,1,0\n0,0,0,0,0,0\n")
    (tmp_path / "harbour.starts.csv").write_text("1,1\n1,2\n1,3\n1,4\n")
    return path


def on_harbour(harbour: Path, folder: Path, *overrides: str) -> pl.DataFrame:
    text = "map.starts" in "".join(overrides)
    overrides = ("horizon=4", *overrides)
    scenario = load_scenario("channels", overrides, str(harbour))
    assert text or scenario.map.starts is None
    evaluate(Setup.of(scenario), ["greedy"], folder, episodes=2)
    return pl.read_parquet(folder / "agents.parquet")


def test_changed_cells_or_starts_of_a_map_are_another_run(harbour: Path, tmp_path: Path) -> None:
    on_harbour(harbour, tmp_path / "run")
    starts = harbour.with_name("harbour.starts.csv")
    starts.write_text("3,1\n3,2\n3,3\n3,4\n")
    with pytest.raises(UserError, match=r"scenario.map.starts is \[\[1, 1\], "):
        on_harbour(harbour, tmp_path / "run")
    starts.write_text("1,1\n1,2\n1,3\n1,4\n")
    harbour.write_text(
        harbour.read_text().replace("1,1,1,1", "1,1,1,0").replace("1,0,0", "1,1,0", 1)
    )
    with pytest.raises(UserError, match="navigable"):
        on_harbour(harbour, tmp_path / "run")


def test_a_changed_map_of_the_same_name_is_read_again(harbour: Path, tmp_path: Path) -> None:
    starts = harbour.with_name("harbour.starts.csv")
    starts.unlink()
    before = on_harbour(harbour, tmp_path / "before")
    assert set(before["row"]) <= {1, 2, 3}
    harbour.write_text("0,0,0,0,0,0\n" * 3 + "0,1,1,1,1,0\n0,1,1,1,1,0\n")
    after = on_harbour(harbour, tmp_path / "after")
    assert set(after["row"]) <= {3, 4}


@pytest.mark.parametrize(
    "settings",
    [{"episodes": 0}, {"seed": -1}, {"seed": 1 << 64}, {"worlds": ["moon"]}],
)
def test_numbers_out_of_range_are_refused_before_anything_is_written(
    settings: dict[str, Any], evaluate_small: Small, tmp_path: Path
) -> None:
    with pytest.raises(UserError, match=r"give at least 1 and 0|world moon: unknown"):
        evaluate_small(tmp_path / "run", **settings)
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize(
    ("policies", "words"),
    [
        ([], "no policy given"),
        (["greedy", "greedy"], "policy greedy: given twice"),
        (["greedy", "mjforage.graph_planner.policies.greedy:GreedyPolicy"], "greedy: given twice"),
        (["greedyy"], "policy greedyy: unknown; did you mean greedy?"),
        (["Q"], "policy Q: unknown; choose auction, belief, ddqn"),
    ],
)
def test_policies_are_checked(policies: list[str], words: str) -> None:
    with pytest.raises(UserError) as caught:
        check_policies(policies)
    assert words in str(caught.value)


def test_the_largest_seed_runs(evaluate_small: Small, tmp_path: Path) -> None:
    run = evaluate_small(tmp_path / "run", seed=(1 << 64) - 1, episodes=1, policies=["greedy"])
    assert json.loads((run / "run.json").read_text())["seed"] == (1 << 64) - 1
    summary = json.loads((run / "summary.json").read_text())["graph"]["greedy"]
    assert summary["pta_d"]["sem"] is None
    assert summary["pta_d"]["n"] == 1


def test_progress_counts_from_what_is_done_to_all(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(layout, "CHUNK", 2)
    setup = Setup.of(load_scenario("comb-port", ["horizon=3"]))
    seen: list[tuple[int, int]] = []

    def stop(done: int, total: int) -> None:
        seen.append((done, total))
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        evaluate(setup, ["greedy"], tmp_path / "run", episodes=5, progress=stop)
    assert seen == [(0, 5), (2, 5)]
    seen.clear()
    evaluate(
        setup, ["greedy"], tmp_path / "run", episodes=5, progress=lambda d, t: seen.append((d, t))
    )
    assert seen == [(2, 5), (4, 5), (5, 5)]
    shutil.rmtree(tmp_path / "run")
