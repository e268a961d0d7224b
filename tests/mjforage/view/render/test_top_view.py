from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.runs.episode_recording import Recording
from mjforage.view.render import TopView, palette

Build = Callable[..., Recording]
Image = NDArray[np.uint8]
LONG_SIDE = 640  # of the small map; a frame of the full size takes four times as long


def drawn(replay: Recording) -> TopView:
    return TopView(replay, LONG_SIDE)


def around(image: Image, view: TopView, rc: tuple[float, float], reach: int) -> Image:
    """Square of pixels around a map position."""
    x, y = (int(value) for value in view.place(np.array(rc)))
    return image[y - reach : y + reach + 1, x - reach : x + reach + 1]


def holds(image: Image, colour: palette.Colour, tolerance: float = 12.0) -> bool:
    """Whether any pixel is of the colour."""
    return bool((np.abs(image.astype(float) - np.array(colour)).max(axis=2) < tolerance).any())


@pytest.fixture
def still(build: Build) -> Recording:
    """A scout at (2, 2), a forager at (2, 9), one item at (8, 8), all unseen and unmoved."""
    replay = build(np.ones((12, 12), np.bool_), steps=4, items=1, agents=(1, 1))
    nothing = np.zeros_like(replay.in_view)
    return replace(
        replay,
        agent_rc=np.tile(np.array([[2.0, 2.0], [2.0, 9.0]], np.float32), (5, 1, 1)),
        item_rc=np.full((5, 1, 2), 8.0, np.float32),
        item_present=np.ones((5, 1), np.bool_),
        belief=nothing.astype(np.int16),
        idleness=np.ones_like(replay.idleness),
        in_view=nothing,
        t_discovered=np.full(1, -1, np.int16),
    )


@pytest.mark.parametrize("shape", [(62, 46), (14, 100), (100, 9), (5, 5), (1, 1)])
def test_frames_have_even_sizes_and_stay_within_the_long_side(
    build: Build, shape: tuple[int, int]
) -> None:
    view = TopView(build(np.ones(shape, np.bool_), steps=2, items=2))
    frame = view.frame(1.5)
    assert frame.shape == (*view.size, 3)
    assert frame.dtype == np.uint8
    assert view.size[0] % 2 == view.size[1] % 2 == 0
    assert max(view.size) <= 1280


def test_large_maps_shrink_to_the_frame(build: Build) -> None:
    navigable = np.zeros((1000, 1000), np.bool_)
    navigable[450:470, 100:900] = True
    view = TopView(build(navigable, steps=1, items=2))
    assert max(view.size) <= 1600
    assert view.frame(0.5).shape == (*view.size, 3)


def test_frames_are_deterministic(build: Build, comb: NDArray[np.bool_]) -> None:
    replay = build(comb, steps=3)
    first, second = drawn(replay), drawn(replay)
    second.frame(0.2)
    assert first.frame(1.7).tobytes() == second.frame(1.7).tobytes()


def test_time_outside_the_episode_is_refused(still: Recording) -> None:
    view = drawn(still)
    for time in (-0.1, 4.1):
        with pytest.raises(ValueError, match="outside the episode"):
            view.frame(time)


def test_vessels_are_drawn_at_their_nodes_in_agent_colours(still: Recording) -> None:
    view = drawn(still)
    frame = view.frame(0.0)
    scout, forager = palette.agent_colours([False, True])
    for rc, own, other in (((2, 2), scout, forager), ((2, 9), forager, scout)):
        hull = around(frame, view, rc, 14)
        assert holds(hull, own)
        assert not holds(hull, other)
    assert not holds(around(frame, view, (5, 5), 14), scout)


def test_vessels_move_between_steps(still: Recording) -> None:
    route = still.agent_rc.copy()
    route[1:, 0] = (2.0, 4.0)
    view = drawn(replace(still, agent_rc=route))
    scout = palette.agent_colours([False])[0]
    assert holds(around(view.frame(0.5), view, (2, 3), 8), scout)
    assert not holds(around(view.frame(0.0), view, (2, 3.5), 8), scout)


def test_hull_points_along_the_motion(still: Recording) -> None:
    """Seen from above, the slender bow leaves more water beside it than the stern does."""
    east, west = still.agent_rc.copy(), still.agent_rc.copy()
    east[:, 0, 1] = np.arange(5) + 2
    west[:, 0, 1] = 4 - np.arange(5) + 2
    scout = np.array(palette.agent_colours([False])[0])
    heavier = []
    for route in (east, west):
        view = drawn(replace(still, agent_rc=route))
        hull = around(view.frame(2.0), view, (2, 4), 20).astype(float)
        cover = np.abs(hull - scout).max(axis=2) < 12.0
        heavier.append(cover[:, :20].sum() > cover[:, 21:].sum())
    assert heavier == [True, False]


def test_removed_item_disappears(still: Recording) -> None:
    present = still.item_present.copy()
    present[2:] = False
    found = np.zeros(1, np.int16)
    view = drawn(replace(still, item_present=present, t_discovered=found))
    assert holds(around(view.frame(1.0), view, (8, 8), 6), palette.ITEM, 40.0)
    assert not holds(around(view.frame(3.0), view, (8, 8), 6), palette.ITEM, 40.0)


def test_undiscovered_items_are_dimmer(still: Recording) -> None:
    view = drawn(replace(still, t_discovered=np.ones(1, np.int16)))
    before, after = (around(view.frame(time), view, (8, 8), 1) for time in (0.0, 1.0))
    assert after.astype(float).mean() > before.astype(float).mean() + 10.0


def test_a_node_is_filled_only_where_items_are_believed(still: Recording) -> None:
    belief = still.belief.copy()
    belief[1:3, 5, 5] = 2
    view = drawn(replace(still, belief=belief))
    red, green, blue = palette.belief_shades(np.array([2]), 4)[0].tolist()
    shade = red, green, blue
    for time, expected in ((0.0, False), (1.0, True), (2.0, True), (3.0, False)):
        frame = view.frame(time)
        assert holds(around(frame, view, (5, 5), 3), shade, 30.0) is expected
        assert not holds(around(frame, view, (8, 8), 3), shade, 30.0)


def test_idle_water_is_darker_and_quays_stay(still: Recording) -> None:
    navigable = still.navigable.copy()
    navigable[10:, :] = False
    hazy = drawn(replace(still, navigable=navigable))
    clear = drawn(replace(still, navigable=navigable, idleness=0 * still.idleness))
    water = [around(view.frame(0.0), view, (5, 5), 5).mean() for view in (hazy, clear)]
    quay = [around(view.frame(0.0), view, (11, 5), 5) for view in (hazy, clear)]
    assert water[1] > water[0] + 20.0
    np.testing.assert_array_equal(quay[0], quay[1])


@pytest.mark.parametrize("bit", [1, 2])
def test_view_is_tinted_and_outlined(still: Recording, bit: int) -> None:
    seen = still.in_view.copy()
    seen[:, 4:8, 4:8] = bit
    view = TopView(replace(still, in_view=seen))
    frame, plain = view.frame(0.0), TopView(still).frame(0.0)
    colour = np.array(palette.agent_colours([False, True])[bit - 1])
    edge, before = (around(f, view, (5.5, 3.5), 14).astype(float) for f in (frame, plain))
    distance = [np.abs(part - colour).max(axis=2).min() for part in (edge, before)]
    assert distance[0] < 40.0 < distance[1]
    assert (around(frame, view, (5.5, 5.5), 3) != around(plain, view, (5.5, 5.5), 3)).any()


def test_zero_scouts_and_zero_items(build: Build) -> None:
    replay = build(np.ones((8, 8), np.bool_), steps=2, items=0, agents=(0, 1))
    view = drawn(replay)
    assert view.frame(1.0).shape == (*view.size, 3)


def test_an_episode_without_a_step_has_one_picture(still: Recording) -> None:
    series = ("agent_rc", "item_rc", "item_present", "belief", "idleness", "in_view")
    view = drawn(replace(still, **{name: getattr(still, name)[:1] for name in series}))
    assert view.length == 0
    np.testing.assert_array_equal(view.frame(0.0), drawn(still).frame(0.0))
