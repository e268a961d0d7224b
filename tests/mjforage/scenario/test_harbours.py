"""Generated harbours: the same everywhere, one roomy part, as they are called; their names."""

import hashlib
from collections import deque

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.graph_planner.graph.navigation import TABLE_LIMIT
from mjforage.mission.setup import Setup
from mjforage.scenario.harbour_shapes import KINDS
from mjforage.scenario.harbours import family, harbour, harbour_cells, is_harbour
from mjforage.scenario.maps import load_map, load_starts
from mjforage.scenario.scenario_file import load_scenario

Cells = NDArray[np.bool_]
SIZES = ("", "", ":30x30", ":30x120", ":44x61", ":120x120")
MANY = [f"harbour:{kind}:{seed}{SIZES[seed % 6]}" for kind in KINDS for seed in range(24)]

SHARES = {
    "combs": (0.5, 0.8),
    "basins": (0.3, 0.85),
    "channels": (0.15, 0.6),
    "islands": (0.55, 0.9),
    "bays": (0.3, 0.75),
}  # of water, as `docs/maps` says


def cells_of(reference: str) -> Cells:
    return harbour_cells(harbour(reference))


def digest(cells: Cells) -> str:
    return hashlib.sha256(cells.tobytes()).hexdigest()[:16]


@pytest.mark.parametrize(
    ("kind", "expected"),
    [
        ("combs", "d861cd3c21f89276"),
        ("basins", "ee05f6f4ca61cd7d"),
        ("channels", "85b9e1b18112ff3e"),
        ("islands", "83fec59d92d2b97d"),
        ("bays", "bed12a6e9b9b3f3f"),
    ],
)
def test_a_harbour_is_the_same_everywhere(kind: str, expected: str) -> None:
    """No map is stored: a change of a single cell would change runs of the same name."""
    assert digest(cells_of(f"harbour:{kind}:7:30x31")) == expected


def roomy(cells: Cells) -> bool:
    """Whether a square of 2 x 2 that is pushed along rows and columns comes over all water."""
    squares = {
        (int(r), int(c))
        for r, c in np.argwhere(cells[:-1, :-1])
        if cells[r : r + 2, c : c + 2].all()
    }
    queue = deque([min(squares)])
    seen, swept = {queue[0]}, np.zeros_like(cells)
    while queue:
        r, c = queue.popleft()
        swept[r : r + 2, c : c + 2] = True
        for there in ((r + 1, c), (r - 1, c), (r, c + 1), (r, c - 1)):
            if there in squares and there not in seen:
                seen.add(there)
                queue.append(there)
    return bool((swept == cells).all())


@pytest.mark.parametrize("reference", MANY)
def test_all_water_is_one_part_with_room_for_two_abreast(reference: str) -> None:
    which = harbour(reference)
    cells = harbour_cells(which)
    assert cells.shape == (which.rows, which.columns)
    assert roomy(cells)
    least, most = SHARES[which.kind]
    assert least <= cells.mean() <= most and cells.sum() >= 200
    assert not cells.flags.writeable


def test_drawn_sizes_are_within_bounds_and_differ() -> None:
    found = [harbour(f"harbour:{kind}:{seed}") for kind in KINDS for seed in range(200)]
    for which in found:
        assert 30 <= which.rows <= 120 and 30 <= which.columns <= 120
        assert which.rows * which.columns <= 7200
    assert len({(which.rows, which.columns) for which in found}) > 800
    for axis in ("rows", "columns"):
        sides = [getattr(which, axis) for which in found]
        assert min(sides) < 33 and max(sides) > 110
    nodes = max(int(harbour_cells(which).sum()) for which in found[::7])
    assert nodes <= TABLE_LIMIT


def runs(line: Cells) -> int:
    """How many stretches of land a line of cells has."""
    return int((line[1:] < line[:-1]).sum()) + int(not line[0])


def drawn_kind(kind: str, seed: int, rows: int, columns: int) -> Cells:
    """A harbour as it is drawn, before it is turned."""
    return KINDS[kind](np.uint64(seed), rows, columns)


@pytest.mark.parametrize("seed", range(8))
def test_combs_have_a_fairway_and_piers_side_by_side(seed: int) -> None:
    cells = drawn_kind("combs", seed, 36, 60)
    fairway = np.flatnonzero(cells[:, 2:].all(axis=1))
    assert 4 <= fairway.size <= 6 and (np.diff(fairway) == 1).all()
    for row in (fairway[0] - 8, fairway[-1] + 8):  # across the piers of either side
        assert runs(cells[row]) >= 7  # every 5 to 10 columns, in 55
    assert not cells[[0, -1]].any()  # quays behind them
    assert (drawn_kind("combs", seed, 90, 60)[:, 2:].all(axis=1)).sum() >= 8  # two fairways


@pytest.mark.parametrize("seed", range(8))
def test_basins_are_rectangles_behind_walls_with_gaps(seed: int) -> None:
    cells = drawn_kind("basins", seed, 60, 60)
    walls = [i for i in range(1, 59) if cells[i].mean() < 0.5]
    assert len(walls) >= 4  # inner walls of two rows each, some of it gaps
    assert all(runs(~cells[i]) >= 1 for i in walls)
    assert cells.mean() > 0.4
    assert cells[0].sum() in (0, 3)  # the way in, if it meets a dock


@pytest.mark.parametrize("seed", range(8))
def test_channels_are_narrow_and_wind(seed: int) -> None:
    cells = drawn_kind("channels", seed, 60, 60)
    wide = np.lib.stride_tricks.sliding_window_view(cells, (10, 10)).all(axis=(2, 3))
    assert not wide.any()
    straight = max(int(np.diff(np.flatnonzero(~line)).max()) for line in cells if line.sum() < 60)
    assert straight < 50  # none goes from side to side
    assert 0.2 < cells.mean() < 0.6


@pytest.mark.parametrize("seed", range(8))
def test_islands_have_water_all_around(seed: int) -> None:
    cells = drawn_kind("islands", seed, 60, 60)
    frame = np.ones_like(cells)
    frame[2:-2, 2:-2] = False
    assert cells[frame].all()
    middle = cells[20:40, 20:40]
    assert (~cells).sum() > 0 and not middle.all() and middle.any()


@pytest.mark.parametrize("seed", range(8))
def test_bays_have_sea_coast_and_coves(seed: int) -> None:
    cells = drawn_kind("bays", seed, 60, 60)
    assert cells[:15].all() and not cells[-2:].any()  # a quarter at least is sea
    coast = cells.cumprod(axis=0).sum(axis=0)
    assert coast.max() > coast.min() + 3
    behind = cells & (np.arange(60)[:, None] > coast)
    assert behind.sum() > 20  # water with land to the north of it


def test_kind_seed_and_size_each_make_another_map() -> None:
    one = cells_of("harbour:combs:7:40x40")
    assert digest(one) != digest(cells_of("harbour:combs:8:40x40"))
    assert digest(one) != digest(cells_of("harbour:basins:7:40x40"))
    turned = {digest(cells_of(f"harbour:combs:{seed}:40x40")) for seed in range(40)}
    assert len(turned) == 40
    openings = {
        side
        for seed in range(40)
        for side, line in enumerate(
            (lambda c: (c[0], c[-1], c[:, 0], c[:, -1]))(cells_of(f"harbour:combs:{seed}:40x40"))
        )
        if line.any()
    }
    assert openings == {0, 1, 2, 3}  # the way in is on any side


def test_a_name_without_a_size_is_the_name_with_its_own() -> None:
    short = load_map("harbour:islands:3")
    assert short.name == "harbour:islands:3:82x48"
    np.testing.assert_array_equal(short.navigable, load_map(short.name).navigable)
    assert load_starts("harbour:islands:3") is None
    assert is_harbour("harbour:no:such") and not is_harbour("harbour.csv")


def test_a_family_has_each_kind_in_turn_by_the_seed_alone() -> None:
    kinds = list(KINDS)
    found = family("harbours:3-12")
    assert found == [f"harbour:{kinds[seed % 5]}:{seed}" for seed in range(3, 13)]
    assert family("harbours:7-7") == ["harbour:channels:7"]
    assert family("harbours:islands:5-6") == ["harbour:islands:5", "harbour:islands:6"]


@pytest.mark.parametrize(
    ("reference", "words"),
    [
        ("harbour:comb:7", "no kind 'comb'; give harbour:KIND:SEED or .*bays.* 30 to 120"),
        ("harbour:", "no kind ''"),
        ("harbour:combs", "seed '' is not"),
        ("harbour:combs:-1", "seed '-1' is not"),
        ("harbour:combs:1.5", "seed '1.5' is not"),
        ("harbour:combs:9223372036854775808", "seed '9223372036854775808' is not"),
        ("harbour:combs:\u0667", "seed '\u0667' is not"),
        ("harbour:combs:7:", "size ''"),
        ("harbour:combs:7:29x40", "size '29x40'; give .*30 to 120"),
        ("harbour:combs:7:40x121", "size '40x121'"),
        ("harbour:combs:7:40", "size '40'"),
        ("harbour:combs:7:40x40x40", "size '40x40x40'"),
        ("harbour:combs:7:40x40:1", "too many parts"),
        ("harbours:0-39", "several maps, .* give one, such as harbour:combs:0"),
        ("harbours:9-3", "expected harbours:FIRST-LAST"),
        ("harbours:0-1000", "at most 1000 of them"),
        ("harbours:5", "expected harbours:FIRST-LAST"),
        ("harbours:fjords:0-3", "no kind 'fjords'; give one of combs"),
        ("harbours:combs:3", "expected harbours:FIRST-LAST"),
    ],
)
def test_a_bad_name_is_one_line_with_the_remedy(reference: str, words: str) -> None:
    with pytest.raises(UserError, match=words) as caught:
        load_map(reference)
    assert "\n" not in str(caught.value) and repr(reference) in str(caught.value)


def test_starts_of_another_map_do_not_hold_but_those_told_do() -> None:
    reference = "harbour:islands:3:40x40"
    assert Setup.of(load_scenario("comb-port", (), reference)).start_cells == ()
    told = load_scenario("comb-port", ("map.starts=[[0,0]]",), reference)
    assert Setup.of(told).start_cells == ((0, 0),)
