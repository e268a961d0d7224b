"""Radio formulas against closed forms and published numbers."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mjforage.graph_planner.graph.visibility import rounded_line
from mjforage.mission.link.propagation import (
    LIGHT_MPS,
    gilbert_elliott,
    log_distance_loss_db,
    packet_error,
    two_ray_loss_db,
    walls_between,
)
from mjforage.mission.link.reach import reach_m
from mjforage.scenario.link import Link

WIFI_HZ = 2.4e9


def test_path_loss_grows_by_its_exponent_in_every_decade() -> None:
    assert log_distance_loss_db(1.0, 2.5, 40.0) == 40.0
    assert log_distance_loss_db(300.0, 2.5, 40.0) == pytest.approx(40.0 + 25.0 * math.log10(300.0))
    assert 27.0 - log_distance_loss_db(300.0, 2.5, 40.0) == pytest.approx(-75.0, abs=0.1)
    assert log_distance_loss_db(0.0, 2.5, 40.0) == 40.0


def test_two_rays_cross_over_and_fall_by_the_fourth_power() -> None:
    assert two_ray_loss_db(184.0, 0.5, 0.5, WIFI_HZ) == pytest.approx(102.6, abs=0.1)
    for far in (2e3, 2e4):
        plane_earth = 40.0 * math.log10(far) - 20.0 * math.log10(0.5 * 2.0)
        assert two_ray_loss_db(far, 0.5, 2.0, WIFI_HZ) == pytest.approx(plane_earth, abs=0.01)


def test_planners_reckon_with_the_lowest_two_antennas() -> None:
    """Far off the reach goes with the root of the product of both heights."""
    link, heights = Link(model="two-ray"), ((0.3, 0.3), (1.2, 0.3, 2.7, 0.3), (2.7, 1.2, 0.3))
    low, mixed, farther = (reach_m(link, np.array(each)) for each in heights)
    assert mixed == low
    assert farther == pytest.approx(2.0 * low, rel=0.01)


def test_without_an_echo_two_rays_are_free_space() -> None:
    """Where both rays differ by a quarter of a wavelength, the powers add up."""
    wave, d = LIGHT_MPS / WIFI_HZ, 50.0
    free = 20.0 * math.log10(4.0 * math.pi * d / wave)
    height = math.sqrt(wave / 4.0 * d / 2.0)
    loss = two_ray_loss_db(d, height, height, WIFI_HZ)
    assert loss == pytest.approx(free - 10.0 * math.log10(2.0), abs=0.05)


def test_errors_of_bits_and_packets() -> None:
    """A bit error rate of 1e-4 garbles 7.69 % of packets of 100 bytes."""
    low, high = 0.0, 20.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        ber = 0.5 * math.erfc(math.sqrt(10.0 ** (0.1 * middle)))
        low, high = (middle, high) if ber > 1e-4 else (low, middle)
    assert packet_error(low, 100) == pytest.approx(0.0769, abs=5e-5)
    assert packet_error(-30.0, 100) == pytest.approx(1.0)
    assert packet_error(30.0, 100) == 0.0


def test_gilbert_and_elliott() -> None:
    assert gilbert_elliott(0.6, 10.0) == pytest.approx((0.15, 0.1))
    assert gilbert_elliott(0.9, 1.0) == pytest.approx((0.9, 0.1)), "independent"


@given(st.integers(-9, 9), st.integers(-9, 9), st.integers(0, 2**31))
def test_walls_are_counted_on_the_rounded_line_alike_both_ways(
    down: int, right: int, seed: int
) -> None:
    cells = np.random.default_rng(seed).integers(-1, 1, (19, 19)).astype(np.int32)
    here = (9, 9)
    there = (9 + down, 9 + right)
    cells[here] = cells[there] = 0
    first, last = min(here, there), max(here, there)
    line = rounded_line(last[0] - first[0], last[1] - first[1]) + first
    walls = int((cells[line[:, 0], line[:, 1]] < 0).sum())
    assert walls_between(cells, *here, *there) == walls_between(cells, *there, *here) == walls
