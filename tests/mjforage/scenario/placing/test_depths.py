"""Depths of a drawn place, and what the draught of a fleet closes of it."""

import logging
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

import mjforage as mf
from mjforage.learning.environments.choices import chosen_setup
from mjforage.scenario.placing.gridding import least_depths
from tests.mjforage.scenario.placing.drawn import geojson
from tests.mjforage.scenario.placing.test_bad_places import one_line

AREAS = ((-80, 0, "4"), (0, 16, "1"), (16, 40, "3 m"), (40, 48, None))
"""West and east ends of what lies side by side [m], and its depth: a pool, a bar, a creek."""
ROWS = 20  # of 4 m; a column of land stands on each side of them


def written(folder: Path) -> Path:
    features = [
        (shapely.box(west, -40, east, 40), {"natural": "water"} | ({"depth": d} if d else {}))
        for west, east, d in AREAS
    ]
    return geojson(folder / "port.geojson", features)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("made") / "place"
    mf.Map.of_chart(written(folder.parent), folder)
    return folder


@pytest.fixture
def place(made: Path, tmp_path: Path) -> mf.Map:
    return mf.Map(shutil.copytree(made, tmp_path / "place"))


def fleet(folder: Path, draught_m: float, level_m: float = 0.0, **keys: Any) -> mf.Scenario:
    water = {"file": str(folder), "water_level_m": level_m}
    team = {"scouts": {"draught_m": 0.5 * draught_m}, "foragers": {"draught_m": draught_m}}
    return mf.load_scenario("open-bay", map=water | {"starts": []} | keys, team=team)


def widths(scenario: mf.Scenario) -> list[int]:
    """Nodes of the columns of the pool, the bar, the creek and the reach without a depth."""
    found = scenario.grid.navigable.sum(axis=0)[1:-1]
    return [int(part.sum()) // ROWS for part in np.split(found, [20, 24, 30])]


def test_a_node_has_the_least_depth_of_its_cell(place: mf.Map, tmp_path: Path) -> None:
    depth_m = place.grid.depth_m
    assert depth_m is not None and np.array_equal(~np.isnan(depth_m), place.water)
    assert (depth_m[1:-1, 1:-1] == np.repeat([4.0, 1.0, 3.0, np.inf], [20, 4, 6, 2])).all()
    assert place.place is not None
    assert "depths of 600 of 640 nodes, 1 to 4 m;" in place.place.remarks[-1]
    again = mf.Map(place.to_file(tmp_path / "again")).grid.depth_m
    np.testing.assert_array_equal(again, depth_m)


def test_a_cell_across_two_depths_has_the_lesser() -> None:
    """Cells of 4 m in two rows, row 0 above; an area that ends on a cell's edge is not in it."""
    nodes = np.array([[True, True, True, True], [True, True, True, False]])
    areas = [shapely.box(-2, -2, 5, 6), shapely.box(5, -2, 10, 2), shapely.box(10, 2, 13, 6)]
    found = least_depths(np.array(areas), np.array([3.0, 1.0, 0.5]), nodes, 4.0)
    expected = [[3.0, 3.0, np.inf, 0.5], [3.0, 1.0, 1.0, np.nan]]
    np.testing.assert_array_equal(found, expected)


@pytest.mark.parametrize(
    ("draught_m", "level_m", "left"),
    [
        (0.0, 0.0, [20, 4, 6, 2]),
        (0.9, 0.0, [20, 4, 6, 2]),
        (1.0, 0.0, [20, 0, 0, 0]),  # no water under the keel, and what lies beyond is cut off
        (1.0, 0.1, [20, 4, 6, 2]),
        (0.5, -0.6, [20, 0, 0, 0]),
        (3.5, 0.0, [20, 0, 0, 0]),
    ],
)
def test_the_deepest_draught_closes_what_is_no_deeper(
    place: mf.Map, tmp_path: Path, draught_m: float, level_m: float, left: list[int]
) -> None:
    assert place.grid.nodes == 640
    assert widths(fleet(tmp_path / "place", draught_m, level_m)) == left


def test_a_team_without_agents_has_no_draught(place: mf.Map, tmp_path: Path) -> None:
    found = fleet(tmp_path / "place", 1.5).replace(team={"foragers": {"count": 0}})
    assert place.grid.nodes == found.grid.nodes


def test_one_line_says_how_many(
    place: mf.Map, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.WARNING):
        found = fleet(tmp_path / "place", 1.5)
    assert [record.getMessage() for record in caplog.records] == [
        "team.foragers.draught_m = 1.5: closes 80 of 640 nodes of map place, and cuts off 160"
    ]
    assert len(found.graph) == 400 == place.grid.nodes - 240


def test_a_tide_opens_them_again(place: mf.Map, tmp_path: Path) -> None:
    ebb = fleet(tmp_path / "place", 1.5)
    assert widths(ebb.replace(map={"water_level_m": 0.6})) == [20, 4, 6, 2]
    assert chosen_setup(ebb, None, {"map.water_level_m": 0.6}).grid.nodes == place.grid.nodes
    assert widths(ebb.replace(horizon=9)) == widths(ebb)
    kept = mf.load_scenario(ebb.to_file(tmp_path / "mine.toml"))
    assert widths(kept) == widths(ebb)
    assert widths(kept.replace(map={"water_level_m": 0.6})) == [20, 4, 6, 2]


def test_a_run_has_the_nodes_that_are_left(place: mf.Map, tmp_path: Path) -> None:
    ebb = fleet(tmp_path / "place", 1.5).replace(horizon=3)
    run = mf.evaluate(ebb, "greedy", episodes=1, folder=tmp_path / "run")
    assert np.array_equal(run.scenario.grid.navigable, ebb.grid.navigable)
    assert place.grid.nodes > ebb.grid.nodes


def test_what_cannot_float_is_refused(place: mf.Map, tmp_path: Path) -> None:
    folder = tmp_path / "place"
    shallow, beyond = [[5, 22]], [[5, 28]]
    one_line(
        lambda: fleet(folder, 1.5, starts=shallow), "start (5, 22) of scenario open-bay: has 1 m"
    )
    one_line(lambda: fleet(folder, 1.5, starts=beyond), "closes it or cuts it off; give another")
    (folder / "depths.csv").write_text((folder / "depths.csv").read_text().replace("inf", "0.5"))
    one_line(lambda: fleet(folder, 4.0), "closes all 640 nodes of map place, whose deepest has 4 m")
    one_line(lambda: fleet(folder, 0.0, 1.0), "water_level_m = 1 closes no node without a draught")
    for text, words in (
        ("1,2\n", "has shape (1, 2)"),
        ("x", "not a table of metres"),
        ("1\n1,2", "not a"),
    ):
        (folder / "depths.csv").write_text(text)
        one_line(lambda: fleet(folder, 1.0), words)


def test_without_depths_a_draught_closes_nothing_and_says_so(
    caplog: pytest.LogCaptureFixture,
) -> None:
    team = {"scouts": {"draught_m": 1.0}}
    with caplog.at_level(logging.WARNING):
        found = mf.load_scenario("open-bay", team=team)
    assert found.grid.nodes == mf.load_scenario("open-bay").grid.nodes
    assert "map open_bay has no depths, and no node is closed" in caplog.text


def test_water_with_a_depth_has_a_least_one(tmp_path: Path) -> None:
    deep = mf.Map.of_chart(written(tmp_path), tmp_path / "deep", min_depth_m=2.0)
    assert deep.grid.nodes == 20 * ROWS
    assert deep.place is not None
    assert any("1 depth areas are shallower" in line for line in deep.place.remarks)
