"""The drawing from above: what is where, in which colours."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.runs.episode_recording import Recording
from mjforage.view.render import palette
from mjforage.view.render.chart import Chart
from tests.mjforage.view.render.conftest import placed

Build = Callable[..., Recording]
Image = NDArray[np.uint8]
SCOUT, FORAGER = palette.agent_colours([False, True])


def drawn(recording: Recording) -> Chart:
    return Chart(recording, (460, 460))


def around(image: Image, chart: Chart, rc: tuple[float, float], reach: int) -> Image:
    """Square of pixels around a map position of a map of 12 rows."""
    ((x, y),) = chart.place(np.array([[4.0 * rc[1], 4.0 * (11 - rc[0])]])).astype(int)
    return image[y - reach : y + reach + 1, x - reach : x + reach + 1]


def holds(image: Image, colour: palette.Colour, tolerance: float = 12.0) -> bool:
    """True if any pixel is of the colour."""
    return bool((np.abs(image.astype(float) - np.array(colour)).max(axis=2) < tolerance).any())


@pytest.fixture
def still(build: Build) -> Recording:
    """A scout at (2, 2), a forager at (2, 9), one item at (8, 8), all unseen and unmoved."""
    recording = build(np.ones((12, 12), np.bool_), steps=4, items=1, agents=(1, 1))
    nothing = np.zeros_like(recording.in_view)
    places = np.tile(np.array([[2.0, 2.0], [2.0, 9.0]]), (5, 1, 1))
    return replace(
        placed(recording, places, np.full((5, 1, 2), 8.0)),
        item_present=np.ones((5, 1), np.bool_),
        belief=nothing.astype(np.int16),
        idleness=np.ones_like(recording.idleness),
        in_view=nothing,
        t_discovered=np.full(1, -1, np.int16),
    )


@pytest.mark.parametrize("shape", [(62, 46), (14, 100), (100, 9), (5, 5), (1, 1)])
def test_charts_fill_their_room_and_repeat_to_the_bit(build: Build, shape: tuple[int, int]) -> None:
    recording = build(np.ones(shape, np.bool_), steps=2, items=2)
    chart, again = (Chart(recording, (300.0, 200.0)) for _ in range(2))
    again.picture(0.2)
    picture = chart.picture(1.5)
    assert picture.shape == (chart.height, chart.width, 3)
    assert chart.width in (299, 300) or chart.height in (199, 200)
    assert picture.tobytes() == again.picture(1.5).tobytes()


def test_a_chart_is_of_the_water(build: Build) -> None:
    navigable = np.zeros((1000, 1000), np.bool_)
    navigable[450:470, 100:900] = True
    chart = Chart(build(navigable, steps=1, items=2), (802.0, 802.0))
    assert (chart.width, chart.height) == (802, 22)


def test_time_outside_the_episode_is_refused(still: Recording) -> None:
    for time in (-0.1, 4.1):
        with pytest.raises(ValueError, match="outside the episode"):
            drawn(still).picture(time)


def test_vessels_are_at_their_nodes_in_their_colours_and_move_between_steps(
    still: Recording,
) -> None:
    route = still.agent_rc.copy()
    route[1:, 0] = (2.0, 4.0)
    chart = drawn(placed(still, route))
    first, later = chart.picture(0.0), chart.picture(0.5)
    for rc, own, other in (((2, 2), SCOUT, FORAGER), ((2, 9), FORAGER, SCOUT)):
        hull = around(first, chart, rc, 14)
        assert holds(hull, own) and not holds(hull, other)
    assert holds(around(later, chart, (2, 3), 8), SCOUT)
    assert not holds(around(first, chart, (2, 3.5), 8), SCOUT)


def test_hull_points_along_the_motion(still: Recording) -> None:
    """The slender bow leaves more water beside it than the stern does."""
    east, west = still.agent_rc.copy(), still.agent_rc.copy()
    east[:, 0, 1] = np.arange(5) + 2
    west[:, 0, 1] = 4 - np.arange(5) + 2
    heavier = []
    for route in (east, west):
        chart = drawn(placed(still, route))
        hull = around(chart.picture(2.0), chart, (2, 4), 20).astype(float)
        cover = np.abs(hull - np.array(SCOUT)).max(axis=2) < 12.0
        heavier.append(cover[:, :20].sum() > cover[:, 21:].sum())
    assert heavier == [True, False]


def test_items_are_dim_until_discovered_and_vanish_when_removed(still: Recording) -> None:
    present = still.item_present.copy()
    present[2:] = False
    chart = drawn(replace(still, item_present=present, t_discovered=np.ones(1, np.int16)))
    before, after = (around(chart.picture(time), chart, (8, 8), 1) for time in (0.0, 1.0))
    assert after.astype(float).mean() > before.astype(float).mean() + 10.0
    assert not holds(around(chart.picture(3.0), chart, (8, 8), 6), palette.ITEM, 40.0)
    small = Chart(still, (460, 460), detailed=False)
    assert not holds(around(small.picture(0.0), small, (8, 8), 6), palette.ITEM_RIM, 40.0)


def test_a_node_is_filled_only_where_items_are_believed(still: Recording) -> None:
    belief = still.belief.copy()
    belief[1:3, 5, 5] = 2
    chart = drawn(replace(still, belief=belief))
    red, green, blue = palette.belief_shades(np.array([2]), 4)[0].tolist()
    for time, expected in ((0.0, False), (1.0, True), (2.0, True), (3.0, False)):
        picture = chart.picture(time)
        assert holds(around(picture, chart, (5, 5), 3), (red, green, blue), 30.0) is expected
        assert not holds(around(picture, chart, (8, 8), 3), (red, green, blue), 30.0)


def test_idle_water_is_darker_between_steps_too_and_quays_stay(still: Recording) -> None:
    navigable, idleness = still.navigable.copy(), still.idleness.copy()
    navigable[10:, :], idleness[1:] = False, 0.0
    chart = drawn(replace(still, navigable=navigable, idleness=idleness))
    pictures = [chart.picture(time) for time in (0.0, 0.25, 1.0)]
    hazy, between, clear = (around(one, chart, (6, 5), 5).mean() for one in pictures)
    assert clear > hazy + 20.0
    assert between == pytest.approx(hazy + 0.25 * (clear - hazy), abs=1.0)
    quays = [around(one, chart, (10.3, 5), 5) for one in pictures]
    np.testing.assert_array_equal(quays[0], quays[2])


@pytest.mark.parametrize("bit", [1, 2])
def test_view_is_tinted_and_outlined(still: Recording, bit: int) -> None:
    seen = still.in_view.copy()
    seen[:, 4:8, 4:8] = bit
    chart = drawn(replace(still, in_view=seen))
    picture, plain = chart.picture(0.0), drawn(still).picture(0.0)
    own, other = (SCOUT, FORAGER)[:: 1 if bit == 1 else -1]
    edge = around(picture, chart, (5.5, 3.5), 14).astype(float)
    away = [np.abs(edge - np.array(colour)).max(axis=2).min() for colour in (own, other)]
    assert away[0] < 40.0 < away[1]
    assert (around(picture, chart, (5.5, 5.5), 3) != around(plain, chart, (5.5, 5.5), 3)).any()


def test_the_followed_vessel_has_a_ring(still: Recording) -> None:
    plain, marked = (Chart(still, (460, 460), followed=one) for one in (None, 0))
    changed = np.argwhere((plain.picture(0.0) != marked.picture(0.0)).any(axis=2))
    ((x, y),) = plain.place(np.array([[8.0, 36.0]]))
    assert len(changed) > 20 and np.abs(changed - (y, x)).max() < 80.0, "around that vessel only"


def test_no_scout_no_item_and_no_step(build: Build, still: Recording) -> None:
    recording = build(np.ones((8, 8), np.bool_), steps=2, items=0, agents=(0, 1))
    assert drawn(recording).picture(1.0).any()
    series = ("agent_rc", "item_rc", "item_present", "belief", "idleness", "in_view")
    single = drawn(replace(still, **{name: getattr(still, name)[:1] for name in series}))
    np.testing.assert_array_equal(single.picture(0.0), drawn(still).picture(0.0))
