from collections.abc import Callable
from pathlib import Path

import numpy as np
import polars as pl
import pytest

from mjforage.base.errors import UserError
from mjforage.graph_planner.policies import create_policy
from mjforage.mission.scoring import Scorer, chosen_metrics
from mjforage.mission.setup import Setup
from mjforage.physics.worlds import create_mission
from mjforage.runs.tables import METRIC_COLUMNS, SCHEMAS, TABLES, check_table, frames, read_table
from mjforage.scenario.scenario_file import load_scenario

HORIZON = 12


@pytest.mark.parametrize("table", TABLES)
def test_tables_are_what_they_are_checked_for(finished: Path, table: str) -> None:
    path = finished / f"{table}.parquet"
    check_table(path, table)
    schema = dict(read_table(path, table).schema)
    assert list(schema)[: len(SCHEMAS[table])] == list(SCHEMAS[table])
    assert {name: schema.pop(name) for name in SCHEMAS[table]} == SCHEMAS[table]
    assert set(schema.values()) <= {METRIC_COLUMNS.get(table)}
    other = TABLES[(TABLES.index(table) + 1) % len(TABLES)]
    with pytest.raises(UserError, match=f"not a table of {other}"):
        check_table(path, other)


def test_every_metric_has_its_columns(finished: Path) -> None:
    episodes = read_table(finished / "episodes.parquet", "episodes")
    steps = read_table(finished / "steps.parquet", "steps")
    metrics = chosen_metrics()
    assert episodes.columns[4:] == [one.key for one in metrics]
    assert steps.columns[8:] == [one.series_name() for one in metrics if one.has_series()]


@pytest.mark.parametrize(
    ("table", "damage", "words"),
    [
        ("episodes", lambda frame: frame.drop("items"), "items differ"),
        (
            "episodes",
            lambda frame: frame.with_columns(pl.col("episode").cast(pl.String)),
            "episode",
        ),
        ("episodes", lambda frame: frame.with_columns(note=pl.lit("x")), "note differ"),
        ("steps", lambda frame: frame.with_columns(more=pl.lit(1.0, pl.Float64)), "more differ"),
        ("items", lambda frame: frame.with_columns(more=pl.lit(1.0, pl.Float64)), "more differ"),
    ],
)
def test_a_foreign_table_is_refused(
    finished: Path,
    tmp_path: Path,
    table: str,
    damage: Callable[[pl.DataFrame], pl.DataFrame],
    words: str,
) -> None:
    path = tmp_path / f"{table}.parquet"
    damage(pl.read_parquet(finished / path.name)).write_parquet(path)
    with pytest.raises(UserError, match=words):
        check_table(path, table)


def test_a_table_without_a_metric_or_with_another_one_is_one(
    finished: Path, tmp_path: Path
) -> None:
    path = tmp_path / "episodes.parquet"
    frame = pl.read_parquet(finished / path.name).drop("csr").with_columns(new=pl.lit(1.0))
    frame.write_parquet(path)
    assert "new" in read_table(path, "episodes").columns


def test_a_message_asks_to_move_the_file_unless_told_better(tmp_path: Path) -> None:
    path = tmp_path / "items.parquet"
    path.write_bytes(b"PAR1")
    with pytest.raises(UserError, match=r"items\.parquet away and run what wrote it"):
        check_table(path, "items")
    with pytest.raises(UserError, match=r"; mend it$"):
        read_table(path, "items", "mend it")


def test_steps_run_to_the_horizon_and_end_as_the_episode_does(finished: Path) -> None:
    episodes = pl.read_parquet(finished / "episodes.parquet")
    steps = pl.read_parquet(finished / "steps.parquet")
    rows = steps.filter(pl.col("policy") == "greedy").select("episode", "step").rows()
    assert rows == [(episode, step) for episode in range(3) for step in range(HORIZON + 1)]
    last = steps.filter(pl.col("step") == HORIZON)
    for name in ("pta_d", "pta_c", "rmse", "rmse_columns", "gini_scouts", "csr"):
        assert np.allclose(last[name], episodes[name], equal_nan=True, rtol=1e-6), name
    assert last["irr"].is_nan().all()
    assert (steps["mi"] <= 1).all()


def test_events_agree_with_the_episodes(finished: Path) -> None:
    items = pl.read_parquet(finished / "items.parquet")
    key = ["world", "policy", "episode"]
    counted = items.group_by(key, maintain_order=True).agg(
        items=pl.len(),
        pta_d=100 * pl.col("t_discovered").is_not_null().mean(),
        pta_c=100 * pl.col("t_collected").is_not_null().mean(),
    )
    episodes = pl.read_parquet(finished / "episodes.parquet")
    assert counted["items"].to_list() == episodes["items"].to_list()
    assert np.allclose(counted["pta_d"], episodes["pta_d"])
    assert np.allclose(counted["pta_c"], episodes["pta_c"])
    assert counted["pta_d"].sum() > 0
    for when, who in (("t_discovered", "discovered_by"), ("t_collected", "collected_by")):
        assert items[when].is_null().equals(items[who].is_null())


def test_agents_move_on_nodes_and_add_up_their_way(finished: Path) -> None:
    agents = pl.read_parquet(finished / "agents.parquet").sort("policy", "episode", "agent", "step")
    key = ["policy", "episode", "agent"]
    moved = agents.with_columns(
        way=((pl.col("x_m").diff() ** 2 + pl.col("y_m").diff() ** 2) ** 0.5).over(key),
        more=pl.col("distance_m").diff().over(key),
    ).filter(pl.col("step") > 0)
    assert np.allclose(moved["way"], moved["more"], atol=1e-3)
    assert np.allclose(moved["more"] / 10.0, moved["speed_mps"], atol=1e-4)
    assert moved["more"].max() > 0  # type: ignore[operator]
    assert set(moved["outcome"].unique()) <= {"arrived", "blocked"}
    assert (agents["x_m"] == 4.0 * agents["col"]).all()
    assert (agents["y_m"] == 4.0 * (61 - agents["row"])).all()


def test_steps_have_the_wind_and_the_current_that_act_in_their_world() -> None:
    """By compass: in the graph world of the paper no current flows; a calm has no bearing."""
    air = ("wind_speed_mps=5", "wind_from_deg=210", "gust_intensity=0.2", "shelter_height_m=3")
    given = (*air, "current_speed_mps=0.25", "current_to_deg=300")
    blown = [f"weather.{one}" for one in given]
    calm = ["weather.drift_node_per_step=0"]
    for world, sets, blows, flows in (
        ("graph", blown, (5.0, 210.0), (0.0, None)),
        ("graph", [*blown, "weather.drift=forced"], (5.0, 210.0), (0.25, 300.0)),
        ("physics", blown, (5.0, 210.0), (0.25, 300.0)),
        ("physics", calm, (0.0, None), (0.0, None)),
    ):
        setup = Setup.of(load_scenario("open-bay", [*sets, "horizon=2"]))
        mission = create_mission(setup, world)
        mission.reset(1, np.arange(2))
        scorer = Scorer(mission, chosen_metrics())
        mission.run(create_policy("random"), (scorer,))
        about = setup, world, "random", np.arange(2), scorer.log, scorer.scores()
        steps = frames(*about)["steps"]
        assert steps.height == 6
        for name, value in zip(list(SCHEMAS["steps"])[4:], (*blows, *flows), strict=True):
            found = steps[name].to_list()
            assert found == [None if value is None else pytest.approx(value, rel=1e-6)] * 6, name
