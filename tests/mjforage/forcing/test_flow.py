"""Flow on a map: no flow through quays, no divergence, what comes in goes out, closed forms."""

from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.forcing import flow as flows
from mjforage.forcing.flow import Flow, flow_of
from mjforage.forcing.stream_element import TURN, stream_velocity
from mjforage.forcing.stream_solver import still_unknowns, stream_functions
from mjforage.graph_planner.graph.navigation import NavigationGraph, navigation_graph
from mjforage.scenario.maps import load_map

PITCH = 4.0
PORTS = ("comb_port", "channels", "open_bay")
GAUSS = np.array([-1.0, 0.0, 1.0]) * np.sqrt(0.6) / 2  # exact for polynomials of degree 5
WEIGHTS = np.array([5.0, 8.0, 5.0]) / 18
Point = tuple[float, float]  # x, y [m]
Share = tuple[float, float, float]  # of the streams to the east and the north, of the circulation
EAST, NORTH, CIRCULATION = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
EVERY = (EAST, NORTH, CIRCULATION)


@lru_cache
def map_of(port: str) -> NavigationGraph:
    return navigation_graph(load_map(port).navigable, PITCH, False)


def harbour() -> NavigationGraph:
    return map_of("comb_port")


@lru_cache
def drawn(*rows: str) -> NavigationGraph:
    """A map of characters, row 0 in the north: land is #."""
    return navigation_graph(np.array([[c != "#" for c in row] for row in rows]), PITCH, False)


def flow(graph: NavigationGraph) -> Flow:
    return flow_of(graph, True, True)


def velocity(graph: NavigationGraph, xy: Point, share: Share = CIRCULATION) -> tuple[float, float]:
    field = flow(graph)
    return stream_velocity(field.patches, field.spacing_m, field.corner_m, *xy, *share)


def flux(
    graph: NavigationGraph, start: Point, end: Point, share: Share = CIRCULATION
) -> tuple[float, float]:
    """Flow through a straight line to its right, and the integral of the speed along it."""
    spacing = flow(graph).spacing_m
    (x0, y0), (x1, y1) = start, end
    length = float(np.hypot(x1 - x0, y1 - y0))
    parts = max(1, round(length / spacing))
    through = total = 0.0
    for part in range(parts):
        for node, weight in zip(GAUSS, WEIGHTS, strict=True):
            s = (part + 0.5 + node) / parts
            u, v = velocity(graph, (x0 + s * (x1 - x0), y0 + s * (y1 - y0)), share)
            through += weight * (u * (y1 - y0) - v * (x1 - x0)) / parts
            total += weight * float(np.hypot(u, v)) * length / parts
    return through, total


def faces(graph: NavigationGraph, open_rim: bool) -> NDArray[np.float64]:
    """(face, along, 2) points on every face between water and land, or rim if it is land [m]."""
    water = np.pad(graph.navigable, 1, constant_values=open_rim)
    along = np.linspace(-0.5, 0.5, 33)
    points = []
    for offset in ((0, 1), (1, 0), (0, -1), (-1, 0)):
        beside = np.roll(water, (-offset[0], -offset[1]), (0, 1))
        for row, col in np.argwhere((water & ~beside)[1:-1, 1:-1]):
            rc = np.stack(
                [
                    row + offset[0] / 2 + along * abs(offset[1]),
                    col + offset[1] / 2 + along * abs(offset[0]),
                ],
                axis=-1,
            )
            points.append(graph.metres(rc))
    return np.array(points)


@pytest.mark.parametrize("share", EVERY)
@pytest.mark.parametrize("port", PORTS)
def test_quays_let_nothing_through_and_nothing_along(port: str, share: Share) -> None:
    graph = map_of(port)
    points = faces(graph, open_rim=share != CIRCULATION)
    assert len(points) > 150
    speeds = [np.hypot(*velocity(graph, (x, y), share)) for x, y in points.reshape(-1, 2)]
    assert max(speeds) < 1e-12
    land = graph.metres(np.argwhere(~graph.navigable).astype(np.float64))
    assert max(np.hypot(*velocity(graph, (x, y), share)) for x, y in land) < 1e-12


@pytest.mark.parametrize("share", EVERY)
@pytest.mark.parametrize("port", PORTS)
def test_every_node_keeps_its_water(port: str, share: Share) -> None:
    """Divergence: what flows into the square of a node flows out of it, to rounding."""
    graph = map_of(port)
    centres = graph.metres(np.stack((graph.rows, graph.cols), axis=-1))
    half = PITCH / 2
    for x, y in centres[::7]:
        corners = [(x - half, y - half), (x + half, y - half), (x + half, y + half)]
        corners.append((x - half, y + half))
        sides = [flux(graph, corners[i], corners[(i + 1) % 4], share) for i in range(4)]
        assert abs(sum(through for through, _ in sides)) < 1e-12
    if share == CIRCULATION:
        assert min(np.hypot(*velocity(graph, (x + 0.3, y + 0.2))) for x, y in centres) > 0.0


def test_the_peak_is_one_metre_per_second_counter_clockwise() -> None:
    graph = harbour()
    rng = np.random.default_rng(0)
    node = rng.integers(len(graph), size=100_000)
    rc = np.stack((graph.rows[node], graph.cols[node]), -1) + rng.uniform(-0.5, 0.5, (100_000, 2))
    speeds = [np.hypot(*velocity(graph, (x, y))) for x, y in graph.metres(rc)]
    assert 0.98 < max(speeds) < 1.001
    box = navigation_graph(np.ones((8, 8), np.bool_), PITCH, False)
    middle = 3.5 * PITCH
    assert velocity(box, (middle + 10, middle))[1] > 0.8
    assert velocity(box, (middle, middle + 10))[0] < -0.8


def test_without_friction_it_bends_like_a_clamped_plate() -> None:
    """Deflection of a square plate's centre: 0.00126532 a^4 q/D (Timoshenko and Woinowsky-Krieger,
    Theory of Plates and Shells, section 44; more digits by Taylor and Govindjee 2004).
    """
    layer = 1e5
    water = np.ones((12, 12), np.bool_)
    psi = stream_functions(water, still_unknowns(water), layer, TURN[:, None])[..., 0, 0]
    assert layer**2 * psi[6, 6] / 12**4 == pytest.approx(0.00126532, rel=1e-4)
    np.testing.assert_allclose(psi, psi.T, atol=1e-12 * psi.max())


def test_velocity_is_continuous_and_patches_meet() -> None:
    graph, spacing = harbour(), flow(harbour()).spacing_m
    x, y = graph.metres(np.array([graph.rows[600], graph.cols[600]]))
    for step in range(-4, 5):
        edge = -PITCH / 2 + spacing * (round((x + PITCH / 2) / spacing) + step)
        for other in (y + 0.31, y - 0.77):
            before, after = (velocity(graph, (edge + side, other)) for side in (-1e-9, 1e-9))
            np.testing.assert_allclose(before, after, atol=1e-8)


def test_positions_off_the_map_are_still_and_lost_ones_stay_lost() -> None:
    graph = harbour()
    for x, y in ((-1e6, 0.0), (0.0, 1e6), (np.inf, 3.0), (-2.0000001, 9.0)):
        assert velocity(graph, (x, y)) == (0.0, 0.0)
    assert np.isnan(velocity(graph, (np.nan, 3.0))).all()


def test_a_flow_that_takes_long_is_kept_for_other_processes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """To the bit; a damaged file, another source or another map is solved anew."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(flows, "_LONG", 10)
    solved: list[int] = []

    def counted(*given: Any) -> Any:
        solved.append(1)
        return stream_functions(*given)

    monkeypatch.setattr(flows, "stream_functions", counted)

    def patches(*rows: str) -> bytes:
        flow_of.cache_clear()
        return flow_of(drawn(*rows), True, False).patches.tobytes()

    bay = ("......", "..##..", "......")
    first = patches(*bay)
    assert patches(*bay) == first and len(solved) == 1
    (kept,) = (tmp_path / "mjforage" / "arrays").iterdir()
    for damaged in (b"", kept.read_bytes()[:300], b"\x93NUMPY junk"):
        kept.write_bytes(damaged)
        assert patches(*bay) == first
    assert len(solved) == 4
    assert patches(*bay[:2], "#.....") != first and len(solved) == 5
    with monkeypatch.context() as patch:
        patch.setattr("mjforage.base.kept_arrays.getsource", lambda module: "another")
        assert patches(*bay) == first and len(solved) == 6
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(kept))  # no folder: nothing can be written
    assert patches(*bay) == first and len(solved) == 7
    monkeypatch.setattr(flows, "_LONG", 1000)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert patches(*bay) == first and len(solved) == 8
    flow_of.cache_clear()
