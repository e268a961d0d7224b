"""Where the cells of a place lie, and its file."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyproj import Geod

from mjforage.scenario.place import Place, read_place, write_place

PLACE = Place(36.0, -5.6, 2.0, 2501, 2501, remarks=("made of nothing",))


@given(st.floats(-80, 80), st.floats(-180, 180), st.floats(-360, 360), st.integers(0, 2**32))
def test_cells_and_back_are_good_to_a_centimetre(
    latitude: float, longitude: float, rotation: float, seed: int
) -> None:
    place = replace(PLACE, latitude_deg=latitude, longitude_deg=longitude, rotation_deg=rotation)
    cells = np.random.default_rng(seed).uniform(0, 2500, (20, 2))
    back = place.cells(place.latlon(cells))
    assert np.abs(back - cells).max() * place.pitch_m < 0.01


@pytest.mark.parametrize("rotation", [0.0, 30.0, -100.0])
def test_bearing_and_distance_from_the_middle_are_those_on_the_ellipsoid(rotation: float) -> None:
    """Azimuthal equidistant, against geodesics."""
    place = replace(PLACE, rotation_deg=rotation)
    cells = np.array([[0.0, 1250.0], [1250.0, 2500.0], [2400.0, 100.0]])
    latlon = place.latlon(cells)
    bearing, _, distance = Geod(ellps="WGS84").inv(
        [-5.6] * 3, [36.0] * 3, latlon[:, 1], latlon[:, 0]
    )
    up, right = 1250.0 - cells[:, 0], cells[:, 1] - 1250.0
    np.testing.assert_allclose(distance, 2.0 * np.hypot(up, right), atol=1e-3)
    turned = np.degrees(np.arctan2(right, up)) + rotation - bearing
    np.testing.assert_allclose((turned + 180.0) % 360.0 - 180.0, 0.0, atol=1e-6)


def test_a_place_is_read_as_it_was_written(tmp_path: Path) -> None:
    ring = ((0.0, 0.0), (5.0, 0.0), (5.0, 5.0), (0.0, 0.0))
    place = replace(PLACE, quays=(ring, ring[::-1]), licence="mine", rotation_deg=-12.5)
    write_place(place, tmp_path)
    assert read_place(tmp_path / "place.toml") == place
