from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.runs.episode_recording import Recording
from mjforage.view.render import cameras
from mjforage.view.render.cameras import (
    CAMERAS,
    Area,
    Circumstances,
    View,
    fitted,
    looking,
    magnified,
)
from mjforage.view.render.track import Track
from tests.mjforage.view.render.conftest import track_of_poses

Floats = NDArray[np.float64]
ASPECT = 16 / 9
TALL, WIDE = Area(0.0, 0.0, 150.0, 216.0), Area(-10.0, 5.0, 290.0, 65.0)


def straight_track(yaw: float, speed: float = 1.0) -> Track:
    """A hull on a straight line through the origin at t = 50 s."""
    t = np.arange(0.0, 100.5, 0.5) - 50.0
    pose = np.column_stack((speed * np.cos(yaw) * t, speed * np.sin(yaw) * t, np.full(len(t), yaw)))
    return track_of_poses(pose[:, None])


def about(track: Track, speed: float = 1.0) -> Circumstances:
    return Circumstances(track, TALL, ASPECT, speed, 0, np.array([0.2, 0.0, 0.74]))


def test_points_project_by_similar_triangles() -> None:
    view = looking(np.zeros(3), np.array([5.0, 0.0, 0.0]), np.radians(90.0))
    points = np.array([[4.0, 0.0, 0.0], [4.0, -4.0, 2.0], [-1.0, 0.0, 0.0]])
    seen = view.project(points, 2.0)
    np.testing.assert_allclose(seen[:2], np.array([[0.0, 0.0, 4.0], [0.5, 0.5, 4.0]]), atol=1e-12)
    assert seen[2, 2] < 0.0


@pytest.mark.parametrize("area", [TALL, WIDE])
@pytest.mark.parametrize("aspect", [16 / 9, 4 / 3, 0.6])
@pytest.mark.parametrize("elevation", [0.5, 1.0, np.pi / 2])
def test_a_fitted_view_shows_all_of_the_area_in_the_middle(
    area: Area, aspect: float, elevation: float
) -> None:
    view = fitted(area, aspect, elevation_rad=elevation, fov_rad=0.5)
    seen = view.project(area.corners, aspect)[:, :2]
    assert 0.9 < np.abs(seen).max() <= 0.9301
    np.testing.assert_allclose(seen.min(axis=0) + seen.max(axis=0), 0.0, atol=1e-3)


@pytest.mark.parametrize(("yaw", "north_deg"), [(0.0, -90.0), (0.5 * np.pi, 0.0), (np.pi, 90.0)])
def test_north_is_beside_what_a_following_camera_looks_at(yaw: float, north_deg: float) -> None:
    """Eastward, north is to the left."""
    view = cameras.chase(about(straight_track(yaw)), 50.0)
    assert np.degrees(view.north_rad) == pytest.approx(north_deg, abs=0.1)


@pytest.mark.parametrize("yaw", [0.0, 1.0, -2.5])
def test_chase_stands_behind_the_hull_and_has_it_in_the_middle(yaw: float) -> None:
    view = cameras.chase(about(straight_track(yaw)), 50.0)
    bow = np.array([np.cos(yaw), np.sin(yaw)])
    assert view.eye[:2] @ bow < -4.0
    assert abs(view.eye[0] * bow[1] - view.eye[1] * bow[0]) < 1e-6
    x, y, ahead = view.project(np.zeros((1, 3)), ASPECT)[0]
    assert abs(x) < 1e-6
    assert abs(y) < 0.5
    assert ahead > 4.0


def test_chase_turns_smoothly_where_the_hull_turns_at_once() -> None:
    t = np.arange(0.0, 60.5, 0.5)
    pose = np.column_stack((t, 0 * t, np.where(t < 30.0, 0.0, np.pi / 2)))[:, None]
    track = track_of_poses(pose)
    where = about(track, speed=10.0)
    ways = [cameras.chase(where, s).forward[:2] for s in np.arange(20.0, 40.0, 1.0 / 3.0)]
    headings = np.unwrap([np.arctan2(way[1], way[0]) for way in ways])
    turns = np.diff(headings)
    assert headings[-1] - headings[0] > 1.2
    assert np.abs(turns).max() < np.radians(3.0)
    assert np.abs(np.diff(turns)).max() < np.radians(0.6)


def test_scout_looks_from_its_mast_over_the_bow() -> None:
    yaw = 0.8
    view = cameras.scout(about(straight_track(yaw)), 50.0)
    np.testing.assert_allclose(view.eye, [0.2 * np.cos(yaw), 0.2 * np.sin(yaw), 0.74], atol=1e-9)
    assert np.arctan2(view.forward[1], view.forward[0]) == pytest.approx(yaw)
    assert -0.3 < view.forward[2] < 0.0


@pytest.mark.parametrize("name", CAMERAS)
def test_cameras_are_functions_of_the_time_and_never_upside_down(
    build: Callable[..., Recording], name: str
) -> None:
    track = Track.of(build(np.ones((20, 20), np.bool_), steps=20, items=1))

    def views() -> list[View]:
        return [CAMERAS[name].view(about(track, 5.0), t) for t in (0.0, 33.3, 200.0)]

    for one, again in zip(views(), views(), strict=True):
        np.testing.assert_array_equal(one.eye, again.eye)
        basis = np.stack((one.right, one.up, -one.forward))
        np.testing.assert_allclose(basis @ basis.T, np.eye(3), atol=1e-9)
        assert np.linalg.det(basis) == pytest.approx(1.0)
        assert one.up[2] >= -1e-9
        assert one.eye[2] > 0.5


def test_what_is_seen_as_a_whole_is_drawn_larger_the_larger_it_is() -> None:
    assert magnified(CAMERAS["overview"], TALL) == (4.0, 8.0)
    assert magnified(CAMERAS["top"], Area(0.0, 0.0, 12.0, 16.0)) == (1.0, 2.0)
    assert magnified(CAMERAS["chase"], TALL)[0] == magnified(CAMERAS["scout"], TALL)[0] == 1.0
    assert TALL.grown(2.0) == Area(-2.0, -2.0, 152.0, 218.0)
