"""S-57 charts: their layers, depths and widths; a real cell where it is at hand."""

import os
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from tests.mjforage.scenario.placing.drawn import geojson, made, place_of, written

CHART = Path(os.environ.get("MJFORAGE_CHART", "../shared/data/chart/US4MD81M.000"))
CROP = -76.48954, 38.95799, -76.46646, 38.97601  # 2 km x 2 km
DEEP, SHOAL = shapely.box(-100, -60, 60, 60), shapely.box(60, -60, 100, 60)
ROCK = shapely.box(-20, -20, 20, 20)


def cell(path: Path) -> Path:
    """Layers as GDAL has those of a cell."""
    layers: dict[str, list[tuple[Any, dict[str, Any]]]] = {
        "DEPARE": [(DEEP, {"DRVAL1": 5.0}), (SHOAL, {"DRVAL1": 1.0})],
        "LNDARE": [(ROCK, {"OBJNAM": "a rock"})],
        "SLCONS": [
            (shapely.LineString([(-59, -60), (-59, 0)]), {"CATSLC": "4", "WATLEV": "2"}),
            (shapely.LineString([(-80, -60), (-80, 0)]), {"CATSLC": "4", "WATLEV": "3"}),
        ],
        "COALNE": [(shapely.LineString([(-100, -60), (60, -60)]), {"CATCOA": "1"})],
    }
    for number, (layer, features) in enumerate(layers.items()):
        kind = features[0][0].geom_type
        written(path, features, layer=layer, append=number > 0, geometry_type=kind)
    return path


def test_layers_of_a_chart(tmp_path: Path) -> None:
    path = cell(tmp_path / "cell.gpkg")
    grid = made(path, 2.0)
    assert grid.nodes == (200 * 120 - 40 * 40 - 2 * 60) / 4
    assert "1 lines of pier taken as 2 m wide (--pier-width)" in place_of(grid).remarks
    assert "left out: 1 COALNE (line), 1 SLCONS (line)" in place_of(grid).remarks
    deep = made(path, 2.0, min_depth_m=2.0)
    assert deep.nodes == grid.nodes - 40 * 120 / 4
    assert any("1 depth areas are shallower" in line for line in place_of(deep).remarks)


@pytest.fixture
def chart() -> Path:
    if not CHART.is_file():
        pytest.skip(f"no chart {CHART}: set MJFORAGE_CHART to the NOAA cell US4MD81M.000")
    return CHART


def test_a_real_chart_becomes_a_place(chart: Path) -> None:
    """2 km x 2 km at 4 m in less than a minute of CPU time; within 0.5 % of the water at 1 m."""
    start = time.process_time()
    grid = made(chart, 4.0, crop=CROP)
    assert time.process_time() - start < 60.0
    assert grid.navigable.size == pytest.approx(250_000, rel=0.01)
    place = place_of(grid)
    assert (
        np.abs(np.array([place.latitude_deg - 38.967, place.longitude_deg + 76.478])).max() < 1e-6
    )
    assert "lines of pier taken as 2 m wide" in " ".join(place.remarks)
    assert "NOAA" in place.licence and len(place.sha256) == 64
    fine = made(chart, 1.0, crop=CROP)
    land = shapely.polygonize([shapely.LineString(ring) for ring in place_of(fine).quays])
    side = np.array(fine.navigable.shape, float)
    water = side.prod() - _covered(land)
    assert fine.nodes == pytest.approx(water, rel=0.005)


def _covered(rings: Any) -> float:
    """Area within an odd number of outlines."""
    found = shapely.Polygon()
    for ring in shapely.get_parts(rings):
        found = found.symmetric_difference(shapely.Polygon(ring.exterior))
    return float(found.area)


def test_a_plain_file_is_no_chart(tmp_path: Path) -> None:
    path = geojson(tmp_path / "a.geojson", [(DEEP, {"DRVAL1": "1"})])
    assert made(path, 2.0).nodes == 160 * 120 / 4
