"""Episodes as one vessel knows them: its map, where it last heard of others, who is in contact."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.runs.episode_recording import Recording
from mjforage.runs.knowledge_record import KnowledgeRecord
from mjforage.view.render import palette, render_recording
from mjforage.view.render.chart import Chart
from mjforage.view.render.layout import Box
from mjforage.view.render.panel import paint_signs
from mjforage.view.render.seen_by import age_of, last_received, seen_by, shown_name
from mjforage.view.render.timeline import Timeline
from tests.mjforage.view.render.conftest import placed

Build = Callable[..., Recording]
Image = NDArray[np.uint8]
SCOUT, FORAGER = palette.agent_colours([False, True])
STEPS = 4


def in_turn(values: list[int]) -> NDArray[np.int16]:
    return np.array(values, np.int16)


@pytest.fixture
def apart(build: Build) -> Recording:
    """A scout goes from (2, 2) to (2, 10) and is last heard by the forager at (10, 2) in step 1.

    The forager has seen its own node in every step, and of node (5, 5) in step 3 what was there in
    step 1: two items, of which one lies there; the other, at (10, 10), is known to the scout only.
    The last contact, in step 1, lost three looks from the scout and none to it.
    """
    recording = build(np.ones((13, 13), np.bool_), steps=STEPS, items=2, agents=(1, 1))
    way = np.tile(np.array([[2.0, 2.0], [10.0, 2.0]], np.float32), (STEPS + 1, 1, 1))
    way[:, 0, 1] += 2.0 * np.arange(STEPS + 1)
    nothing, own = np.zeros_like(recording.in_view), 10 * 13 + 2
    view = nothing.copy()
    view[:, 10, 2], view[:, 5:8, 9] = 2, 1
    heard = np.tile(np.arange(STEPS + 1, dtype=np.int16)[:, None, None], (1, 2, 2))
    heard[:, 0, 1], heard[:, 1, 0] = (0, 1, 2, 2, 2), (0, 1, 1, 1, 1)
    pairs = np.zeros((STEPS + 1, 2, 2), np.int16)
    linked, pairs[1, 0, 1] = np.zeros(pairs.shape, np.bool_), 3
    linked[1, 0, 1] = linked[1, 1, 0] = True
    held = KnowledgeRecord(
        forgetting=0.1,
        changes=np.array([1, 1, 1, 2, 1], np.int32),
        agent=in_turn([1] * 6),
        cell=np.array([own, own, own, own, 5 * 13 + 5, own], np.int32),
        seen=in_turn([0, 1, 2, 3, 1, 4]),
        items=in_turn([0, 0, 0, 0, 2, 0]),
        received=heard,
        known_from=np.array([[0, 0], [3, -1]], np.int16),
        linked=linked,
        lost=pairs,
    )
    items = np.tile(np.array([[5.0, 5.0], [10.0, 10.0]]), (STEPS + 1, 1, 1))
    return replace(
        placed(recording, way, items),
        item_present=np.ones((STEPS + 1, 2), np.bool_),
        belief=nothing.astype(np.int16),
        idleness=np.zeros_like(recording.idleness),
        in_view=view,
        t_discovered=in_turn([1, 1]),
        knowledge=held,
    )


def drawn(recording: Recording) -> Chart:
    return Chart(recording, (455.0, 455.0))


def around(image: Image, chart: Chart, rc: tuple[float, float], reach: int) -> Image:
    ((x, y),) = chart.place(np.array([[4.0 * rc[1], 4.0 * (12 - rc[0])]])).astype(int)
    return image[y - reach : y + reach + 1, x - reach : x + reach + 1]


def share(image: Image, colour: palette.Colour, tolerance: float = 12.0) -> float:
    """Share of the pixels that are of a colour."""
    off = np.abs(image.astype(float) - np.array(colour)).max(axis=2)
    return float((off < tolerance).mean())


def test_the_map_of_a_vessel_takes_the_place_of_the_fleets(apart: Recording) -> None:
    seen = seen_by(apart, "foragers_0")
    assert (shown_name(apart), shown_name(seen)) == ("all", "foragers_0")
    assert seen.belief[:, 5, 5].tolist() == [0, 0, 0, 2, 2] and seen.belief[3:].sum() == 4
    np.testing.assert_allclose(seen.idleness[:, 5, 5], [1.0, 1.0, 1.0, 0.2, 0.3], atol=1e-3)
    assert (seen.idleness[:, 10, 2] == 0.0).all() and (seen.idleness[:, 0, 0] == 1.0).all()
    assert (seen.in_view[:, 10, 2] == 2).all(), "its own view"
    assert not seen.in_view[:, 5:8, 9].any(), "and not what the scout sees"
    assert seen_by(apart, "all") is apart
    blind = seen_by(apart, "scouts_0")
    assert not blind.belief.any() and (blind.idleness == 1.0).all()


def test_land_is_not_idle(apart: Recording) -> None:
    water = apart.navigable.copy()
    water[0, 0] = False
    assert not seen_by(replace(apart, navigable=water), "scouts_0").idleness[:, 0, 0].any()


def test_items_are_known_by_the_map_and_discovered_by_the_truth(apart: Recording) -> None:
    never = np.iinfo(np.int64).max
    alone, fleet = Timeline.of(seen_by(apart, "foragers_0")), Timeline.of(apart)
    assert alone.known.tolist() == [3, never] and fleet.known.tolist() == [1, 1]
    assert alone.discovered.tolist() == [1, 1]
    np.testing.assert_array_equal(alone.pta_d, fleet.pta_d)


def test_who_was_last_heard_when(apart: Recording) -> None:
    assert last_received(apart, 3).tolist() == [3, 3]
    assert last_received(seen_by(apart, "foragers_0"), 3).tolist() == [1, 3]
    assert last_received(seen_by(apart, "scouts_0"), 3).tolist() == [3, 2]


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("scouts_1", "seen by scouts_1: no such vessel; choose all, scouts_0, foragers_0"),
        ("", "seen by : no such vessel"),
    ],
)
def test_unknown_vessels_are_named(
    apart: Recording, tmp_path: Path, name: str, message: str
) -> None:
    with pytest.raises(UserError, match=message):
        render_recording(apart, tmp_path / "a.png", seen_by=name)
    assert list(tmp_path.iterdir()) == []


def test_without_a_link_nobody_sees_alone(apart: Recording) -> None:
    plain = replace(apart, knowledge=None)
    assert seen_by(plain, "all") is plain
    with pytest.raises(UserError, match="seen by scouts_0: without a link all know the same"):
        seen_by(plain, "scouts_0")


def test_a_vessel_is_faded_where_it_was_last_heard_of(apart: Recording) -> None:
    """At step 4 the scout is at (2, 10); the forager heard of it at (2, 4)."""
    views = {name: drawn(seen_by(apart, name)) for name in ("all", "foragers_0")}
    frames = {name: view.picture(4.0) for name, view in views.items()}
    for name, truly in (("all", True), ("foragers_0", False)):
        hull = around(frames[name], views[name], (2, 10), 9)
        assert (share(hull, SCOUT) > 0.2) == truly, "full, or an outline only"
        assert share(around(frames[name], views[name], (10, 2), 9), FORAGER) > 0.2
    there = [around(frames[name], views[name], (2, 4), 9).astype(float) for name in frames]
    assert np.abs(there[0] - there[1]).mean() > 20.0, "its ghost"
    assert share(there[1].astype(np.uint8), SCOUT) == 0.0, "which is faded"
    ago = around(frames["foragers_0"], views["foragers_0"], (3, 4), 14)
    assert share(ago, palette.INK, 40.0) > 0.02, "30 s ago"


def test_contacts_are_lines_and_broken_red_ones_where_looks_were_lost(apart: Recording) -> None:
    assert apart.knowledge is not None
    nothing = np.zeros_like(apart.knowledge.lost)
    kept = replace(apart, knowledge=replace(apart.knowledge, lost=nothing))
    none = replace(apart, knowledge=replace(apart.knowledge, lost=nothing, linked=nothing > 0))
    reds, changed = [], []
    for recording in (apart, kept, none):
        view = drawn(recording)
        frame = view.picture(1.0)
        across = around(frame, view, (6, 3), 20)
        reds.append(share(across, palette.LOST, 40.0))
        changed.append(across.astype(float))
    assert reds[0] > 0.01 and reds[1] == reds[2] == 0.0
    assert np.abs(changed[1] - changed[2]).max() > 60.0, "a dark line"


def test_the_age_of_a_look_is_told_in_seconds(apart: Recording) -> None:
    """Two and a half steps of 10 s."""
    assert apart.period_s == 10.0 and age_of(apart, 3.5, 1) == "25 s"


def test_the_panel_has_a_sign_for_contacts_and_one_for_losses(apart: Recording) -> None:
    image = np.zeros((180, 260, 3), np.uint8)
    paint_signs(image, Box(0, 0, 260, 180), 1.0, apart, 4, drawn=True)
    rows = [image[22 * n : 22 * n + 22, :36].astype(float) for n in (4, 5)]
    away = [np.abs(row - palette.LOST).max(axis=2).min() for row in rows]
    assert away[1] < 30.0 < away[0], "in contact, then lost, in red"
