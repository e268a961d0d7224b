from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Simulation
from mjforage.physics.vessels import load_vessel
from mjforage.runs.episode_recording import Recording
from mjforage.view.render import palette
from mjforage.view.render.cameras import CAMERAS
from mjforage.view.render.harbour_view import HarbourView, afloat, floating

pytestmark = pytest.mark.usefixtures("opengl")
Image = NDArray[np.uint8]
SIZE, LARGE = (160, 120), (400, 300)


@pytest.fixture(scope="module")
def recording(build: Callable[..., Recording]) -> Recording:
    """A small harbour with a pier and an open edge."""
    water = np.ones((14, 18), np.bool_)
    water[0], water[:, 0], water[6:8, 5:14] = False, False, False
    return build(water, steps=6, items=8)


@pytest.fixture(scope="module")
def physics(recording: Recording, refine: Callable[..., Recording]) -> Recording:
    return refine(recording)


def picture(
    recording: Recording, camera: str, time: float, size: tuple[int, int] = SIZE, **options: Any
) -> Image:
    with HarbourView(recording, camera, *size, **options) as view:
        return view.picture(time)


def close_to(image: Image, colour: palette.Colour, tolerance: float) -> int:
    """Number of pixels of a colour."""
    return int((np.abs(image.astype(float) - np.array(colour)).max(axis=-1) < tolerance).sum())


@pytest.mark.parametrize("camera", CAMERAS)
def test_frames_of_both_worlds_have_the_size_asked_for_and_repeat_to_the_bit(
    recording: Recording, physics: Recording, camera: str
) -> None:
    for episode in (recording, physics):
        with HarbourView(episode, camera, *SIZE) as view:
            first = view.picture(2.3)
            later = view.picture(4.0)
            np.testing.assert_array_equal(view.picture(2.3), first)
        assert first.shape == (SIZE[1], SIZE[0], 3)
        assert first.dtype == np.uint8
        assert first.std() > 15.0
        assert (first != later).mean() > 0.05
        np.testing.assert_array_equal(picture(episode, camera, 2.3), first)


def test_hulls_are_drawn_in_their_teams_colours_and_behind_them_nothing(
    recording: Recording,
) -> None:
    colours = palette.agent_colours([False, True])
    image = picture(recording, "top", 0.0, LARGE)
    assert all(close_to(image, colour, 30.0) > 2 for colour in colours)
    far = recording.track_pose.copy()
    far[..., :2] += 5000.0
    image = picture(replace(recording, track_pose=far), "top", 0.0, LARGE)
    assert all(close_to(image, colour, 30.0) == 0 for colour in colours)


def test_taken_items_are_gone(recording: Recording) -> None:
    none = np.zeros_like(recording.track_present)
    still = replace(
        recording, item_present=none, item_class=np.full(8, 4, np.int16), track_present=none
    )
    left = replace(still, item_present=~none, track_present=~none)
    sun = (240.0, 205.0, 60.0)
    shown, taken = (close_to(picture(one, "top", 5.0, LARGE), sun, 45.0) for one in (left, still))
    assert shown > taken


def test_the_mast_of_another_vessel_shows_another_view(recording: Recording) -> None:
    views = [picture(recording, "scout", 1.0, follow=name) for name in ("scouts_0", "scouts_1")]
    assert np.abs(views[0].astype(int) - views[1]).mean() > 3.0
    np.testing.assert_array_equal(views[0], picture(recording, "scout", 1.0))


@pytest.mark.parametrize(
    ("camera", "follow", "message"),
    [
        (
            "chase",
            "otter_0",
            "follow otter_0: no such vessel; choose scouts_0, scouts_1",
        ),
        ("top", "scouts_0", "follow scouts_0: camera top follows nobody; chase and scout do"),
    ],
)
def test_bad_choices_are_named(
    physics: Recording, camera: str, follow: str | None, message: str
) -> None:
    with pytest.raises(UserError, match=message):
        HarbourView(physics, camera, *SIZE, follow=follow)
    HarbourView(physics, "top", *SIZE).close()


@pytest.fixture
def alarm() -> Iterator[list[str]]:
    """A passive callback that notes every call."""
    mujoco.set_mjcb_passive(None)
    yield []
    mujoco.set_mjcb_passive(None)


def test_drawing_calls_no_physics_and_changes_no_simulation(
    physics: Recording, alarm: list[str]
) -> None:
    def run(draw: bool) -> NDArray[np.float64]:
        simulation = Simulation(build_scene([load_vessel("scout")]))
        simulation.commands[:] = 20.0
        simulation.step(20)
        if draw:
            picture(physics, "chase", 1.0)
        simulation.step(20)
        return np.array(simulation.vessel_pose[0, 0], np.float64)

    np.testing.assert_array_equal(run(draw=True), run(draw=False))
    with HarbourView(physics, "chase", *SIZE) as view:
        mujoco.set_mjcb_passive(None)
        mujoco.set_mjcb_passive(lambda model, data: alarm.append("called"))
        view.picture(1.0)
        mujoco.set_mjcb_passive(None)
    assert alarm == []


def test_hulls_and_items_rock_a_little_around_their_places() -> None:
    hulls = np.array([[1.0, 2.0, 0.5], [3.0, 4.0, -2.0]])
    items = np.array([[5.0, 6.0, 1.0], [7.0, 8.0, 0.0]])
    for t in (0.0, 1.3, 700.0):
        poses, spots = afloat(hulls, t), floating(items, t)
        np.testing.assert_array_equal(poses[:, [0, 1, 5]], hulls)
        np.testing.assert_array_equal(spots[:, [0, 1, 5]], items)
        assert np.abs(poses[:, 2:5]).max() < 0.05
        assert np.abs(spots[:, 2]).max() < 0.05
    np.testing.assert_array_equal(afloat(hulls, 1.3), afloat(hulls, 1.3))
    assert (afloat(hulls, 1.3) != afloat(hulls, 2.0)).any()


def test_two_thousand_items_are_drawn(build: Callable[..., Recording]) -> None:
    """MuJoCo draws at most 1,000 materials: items share theirs."""
    recording = build(np.ones((30, 40), np.bool_), steps=1, items=2000)
    seen = picture(recording, "overview", 0.0, LARGE)
    assert close_to(seen, (250, 219, 56), 40) > 50, "yellow drifters"
