import math

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.controllers import Chart
from mjforage.physics.dynamics.touch import contact, touches

HULL = np.array([1.0, 0.5])  # half length, half beam [m]
CELL = np.array([2.0, 2.0])


def pose(x: float, y: float, degrees: float = 0.0) -> NDArray[np.float64]:
    return np.array([x, y, math.radians(degrees)])


@pytest.mark.parametrize(
    ("hull", "touching", "normal"),
    [
        (pose(3.0, 0.0), True, (1.0, 0.0)),  # bow to stern at the cell's east side: 2 + 1
        (pose(3.02, 0.0), False, None),
        (pose(0.0, 2.49), True, (0.0, 1.0)),
        (pose(0.0, 2.51), False, None),
        (pose(0.0, -2.9, 90), True, (0.0, -1.0)),
        (pose(2.0 + math.sqrt(0.5) * 1.5 - 0.01, 0.0, 45), True, (1.0, 0.0)),
        (pose(2.0 + math.sqrt(0.5) * 1.5 + 0.01, 0.0, 45), False, None),
        (pose(3.0, 2.4), True, None),  # corner to corner
        (pose(3.2, 2.7), False, None),
    ],
)
def test_a_vessel_beside_a_cell(
    hull: NDArray[np.float64], touching: bool, normal: tuple[float, float] | None
) -> None:
    hit, nx, ny, _ = contact(hull, pose(0, 0), HULL, CELL)
    assert hit is touching
    if normal:
        assert (nx, ny) == pytest.approx(normal, abs=1e-12)


def test_a_corner_between_axes_does_not_touch_although_bounding_boxes_do() -> None:
    """Both boxes' bounding boxes overlap; only the vessel's own axis separates them."""
    assert not contact(pose(2.9, 2.9, 45), pose(0, 0), HULL, CELL)[0]
    assert contact(pose(2.3, 2.3, 45), pose(0, 0), HULL, CELL)[0]


def found(
    poses: list[NDArray[np.float64]], velocities: list[tuple[float, float, float]], rows: list[str]
) -> tuple[list[bool], list[float]]:
    touching, closing = np.zeros(len(poses), np.bool_), np.zeros(len(poses))
    size = np.tile(HULL, (len(poses), 1))
    land = Chart(np.array([[c == "1" for c in row] for row in rows]), 4.0).land
    touches(np.stack(poses), np.array(velocities), size, land, 4.0, touching, closing)
    return touching.tolist(), closing.tolist()


@pytest.mark.parametrize(
    ("x", "speed", "touching", "closing"),
    [(1.0, 0.7, True, 0.7), (0.9, 0.7, False, 0.0), (1.0, -0.7, True, 0.0)],
)
def test_speed_towards_a_quay_counts_and_speed_along_it_does_not(
    x: float, speed: float, touching: bool, closing: float
) -> None:
    """The centre of the south-west cell is the origin; the cell east of it is land from x = 2."""
    hit, fastest = found([pose(x, 0.0)], [(speed, 5.0, 0.0)], ["11", "10"])
    assert hit == [touching]
    assert fastest == pytest.approx([closing])


@pytest.mark.parametrize(("y", "speed", "hits"), [(5.5, 0.4, 1), (5.4, 0.4, 0), (-1.5, -0.4, 1)])
def test_the_maps_edge_is_a_quay(y: float, speed: float, hits: int) -> None:
    hit, fastest = found([pose(0.0, y)], [(0.0, speed, 0.0)], ["1", "1"])
    assert hit == [bool(hits)]
    assert fastest == pytest.approx([0.4 * hits])


def test_a_swinging_bow_hits_with_its_own_speed() -> None:
    """Turning to port at 0.5 rad/s, the bow's port corner 1 m ahead closes on the quay at 0.5."""
    hit, fastest = found([pose(0.0, 1.5)], [(0.0, 0.0, 0.5)], ["0", "1"])
    assert hit == [True]
    assert fastest == pytest.approx([0.5])


@pytest.mark.parametrize("along", [-0.02, 0.0, 0.02])
def test_at_a_seam_between_cells_a_straight_quay_is_one(along: float) -> None:
    """The starboard bow slides along a quay at x = 2, over the seam at y = 2 [m].

    Against a corner of either cell it would close at 0.33 m/s, as fast as the bow's side turns.
    """
    yaw, velocity = 215.8, (-0.116, -0.089, 0.34)
    c, s = math.cos(math.radians(yaw)), math.sin(math.radians(yaw))
    corner = (c * HULL[0] + s * HULL[1], s * HULL[0] - c * HULL[1])
    hull = pose(1.999 - corner[0], 2.0 + along - corner[1], yaw)
    touching, closing = found([hull], [velocity], ["01", "01"])
    assert touching == [True]
    assert closing == pytest.approx([0.116 + 0.34 * corner[1]], abs=0.01)
    if along == 0.0:  # where the quay ends, the corner is one
        assert found([hull], [velocity], ["11", "01"])[1][0] > 0.3


@pytest.mark.parametrize(("rows", "middle"), [(["10", "10"], 2.0), (["111", "101", "111"], 4.0)])
def test_no_point_of_a_touch_lies_outside_the_vessel(rows: list[str], middle: float) -> None:
    """Turning at 1 rad/s on the spot beside a quay, nearly parallel to it, no point of a vessel is
    faster than its corner, 1 m along the quay; a cell's own corners are up to 4 m off.

    The quay is of two cells, or one cell alone, whose corners jut out.
    """
    rng = np.random.default_rng(0)
    fastest, hits = 0.0, 0
    for _ in range(2000):
        at = pose(1.505, middle + rng.uniform(-3.0, 3.0), 90 + rng.normal(0.0, 0.4))
        hit, closing = found([at], [(0.0, 0.0, 1.0)], rows)
        fastest, hits = max(fastest, *closing), hits + hit[0]
    assert hits > 1000
    assert 0.9 < fastest < 1.05
