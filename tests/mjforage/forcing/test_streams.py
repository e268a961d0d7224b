"""Streams through the open border: conserved, round obstacles, against closed forms."""

import numpy as np
import pytest
from scipy.special import k0, k1

from mjforage.forcing.flow import LAYER, has_open_border
from mjforage.graph_planner.graph.navigation import NavigationGraph, navigation_graph
from tests.mjforage.forcing.test_flow import (
    EAST,
    NORTH,
    PITCH,
    Share,
    drawn,
    flux,
    harbour,
    map_of,
    velocity,
)

CHANNEL = ("#" * 30, *["." * 30] * 4, "#" * 30)
NARROWS = ("#" * 40, *["." * 14 + "#" * 12 + "." * 14] * 2, *["." * 40] * 2, "#" * 40)


def at_node(graph: NavigationGraph, rc: list[float], share: Share) -> tuple[float, float]:
    """Velocity at a (row, column)."""
    x, y = graph.metres(np.array(rc))
    return velocity(graph, (x, y), share)


def across(graph: NavigationGraph, row: float, first: float, last: float, share: Share) -> float:
    """Flow to the north through a line along a row [m2/s]."""
    west, east = graph.metres(np.array([[row, first], [row, last]]))
    return -flux(graph, (west[0], west[1]), (east[0], east[1]), share)[0]


def along(graph: NavigationGraph, column: float, share: Share = EAST) -> float:
    """Flow to the east through the whole map at a column [m2/s]."""
    rows = graph.shape[0]
    south, north = graph.metres(np.array([[rows - 0.5, column], [-0.5, column]]))
    return flux(graph, (south[0], south[1]), (north[0], north[1]), share)[0]


@pytest.mark.parametrize(("share", "expected"), [(EAST, (1.0, 0.0)), (NORTH, (0.0, 1.0))])
def test_open_water_has_the_free_stream_everywhere(
    share: Share, expected: tuple[float, float]
) -> None:
    graph = drawn(*["." * 9] * 7)
    rng = np.random.default_rng(1)
    for x, y in graph.metres(rng.uniform(-0.5, 6.49, (50, 2))):
        np.testing.assert_allclose(velocity(graph, (x, y), share), expected, atol=1e-10)


def test_a_channel_has_the_profile_of_friction_and_viscosity() -> None:
    """u - L^2 d2u/dy2 = 1, u = 0 at y = +-h: u = 1 - cosh(y / L) / cosh(h / L)."""
    graph, half, layer = drawn(*CHANNEL), 2 * PITCH, LAYER * PITCH
    y = np.linspace(-half, half, 81)
    exact = 1.0 - np.cosh(y / layer) / np.cosh(half / layer)
    middle = graph.metres(np.array([2.5, 14.0]))
    found = np.array([velocity(graph, (middle[0], middle[1] + at), EAST) for at in y])
    np.testing.assert_allclose(found[:, 0], exact, atol=0.005)
    np.testing.assert_allclose(found[:, 1], 0.0, atol=1e-10)
    mean = 1.0 - layer / half * np.tanh(half / layer)
    assert along(graph, 14.0) == pytest.approx(2 * half * mean, rel=1e-3)


def test_a_contraction_carries_what_the_wide_parts_carry() -> None:
    """Half the width: the same flow through every section, so twice the mean speed."""
    graph = drawn(*NARROWS)
    flows = [along(graph, column) for column in (-0.49, 3.0, 13.5, 20.0, 25.5, 39.49)]
    assert np.ptp(flows) < 1e-10 and flows[0] > 0.0
    wide = at_node(graph, [2.5, 3.0], EAST)[0]
    narrow = at_node(graph, [3.5, 20.0], EAST)[0]
    assert narrow > 1.8 * wide


def test_what_comes_in_at_one_mouth_goes_out_at_the_other() -> None:
    graph = map_of("channels")
    north = across(graph, -0.4999, 10.5, 13.5, NORTH)
    south = across(graph, 55.4999, 19.5, 22.5, NORTH)
    assert south == pytest.approx(north, abs=1e-10) and north > 1.0


def test_a_bay_with_one_mouth_takes_no_stream_into_its_depth() -> None:
    """Straight in: all is still. Along the coast: in on one side of the mouth, out on the other."""
    graph = harbour()
    for x, y in graph.metres(np.stack((graph.rows, graph.cols), axis=-1))[::17]:
        assert np.hypot(*velocity(graph, (x, y), NORTH)) < 1e-10
    inward, outward = (across(graph, -0.4999, a, b, EAST) for a, b in ((2.5, 6.5), (6.5, 11.5)))
    assert inward == pytest.approx(-outward, abs=1e-10) and -inward > 1.0
    speeds = [np.hypot(*at_node(graph, [r, 7.0], EAST)) for r in (0, 40)]
    assert speeds[0] > 0.8 and speeds[1] < 1e-5


def test_a_round_pier_parts_the_stream_as_in_the_closed_form() -> None:
    """Brinkman's flow past a cylinder in open water: psi = sin(angle) (r + A / r + B K1(r / L)),
    psi = dpsi/dr = 0 at its radius; with L = 0 the potential flow, A = -radius^2. In cells.
    """
    size, radius, layer = 61, 5.0, LAYER
    rows, cols = np.indices((size, size)) - size // 2
    graph = navigation_graph(rows**2 + cols**2 > radius**2, PITCH, False)
    ratio = radius / layer
    slope = -(k0(ratio) + k1(ratio) / ratio) / layer  # of K1(r / L) at the pier
    a, b = np.linalg.solve(
        np.array([[1 / radius, k1(ratio)], [-1 / radius**2, slope]]), np.array([-radius, -1.0])
    )
    for r in (8.0, 10.0, 14.0):
        exact = 1.0 - a / r**2 - b * (k0(r / layer) + k1(r / layer) * layer / r) / layer
        x, y = graph.metres(np.array([size // 2 - r, size // 2]))
        u, v = velocity(graph, (x, y), EAST)
        assert u - 1.0 == pytest.approx(exact - 1.0, rel=0.1) and abs(v) < 1e-10
    ahead = at_node(graph, [size // 2, size // 2 - 6.0], EAST)[0]
    assert 0.0 < ahead < 0.2


@pytest.mark.parametrize(
    ("rows", "expected"),
    [(("###", "#.#", "###"), False), (("###", "..#", "###"), True), (("#.#", "#.#", "###"), True)],
)
def test_a_border_is_open_where_water_is_at_the_maps_edge(
    rows: tuple[str, ...], expected: bool
) -> None:
    assert has_open_border(drawn(*rows)) is expected


def test_nothing_passes_between_two_corners_of_land_that_touch() -> None:
    blocked = drawn("######", "..#...", "...#..", "######")
    open_one = drawn("######", "..#...", "....#.", "######")
    for column in (0.0, 1.0, 4.5):
        assert abs(along(blocked, column)) < 1e-10
        assert along(open_one, column) > 0.01
