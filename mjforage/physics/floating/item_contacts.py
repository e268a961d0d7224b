"""Contacts between items, with bodies or not: once per tick overlap is undone and approach stopped.

Places are corrected (Mueller et al., "Position based dynamics", 2007), pair by pair in a few sweeps
(Gauss-Seidel). What leans on a quay does not yield to what lies upwind of it, as in the shock
propagation of Guendelman et al., "Nonconvex rigid bodies with stacking" (2003). Items are discs
without friction and do not bounce. Neighbours come from a hash of square cells.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined, kernel
from mjforage.base.device import Launch
from mjforage.base.wholes import floor
from mjforage.controllers.chart import (
    WALL_M,
    framed_is_land,
    grid_shape,
    walls_at,
    way_to_wall,
)
from mjforage.forcing import LEEWAY
from mjforage.physics.floating.drift import Afloat
from mjforage.physics.floating.quays import Quays

SWEEPS = 8  # at most, in a tick
AHEAD_M = 0.05  # gap of pairs that may come to touch in the sweeps
TOUCH_M = 1e-3  # items that near touch: approach is stopped
SMALL = 3e-3  # overlap [m] and approach [m/s] with which sweeps end
SHARE = 0.35  # of a cell's side that the reach is: two or three cells are searched for an item
PAIRS = 16  # room for so many for each item; discs that do not overlap have 3
_LEAST = 1e-12
Float64Array = NDArray[np.float64]
Int64Array = NDArray[np.int64]


class Scratch(NamedTuple):
    """Memory for the contacts of so many items."""

    first: NDArray[np.int32]  # (power of two,) item of a bucket of cells, -1 none
    following: NDArray[np.int32]  # (item,) the next one of its bucket
    cell: Int64Array  # (item, 2)
    pairs: Int64Array  # (2, pair, 2) as found, and as sorted
    order: Int64Array  # (2, pair)
    upwind: Float64Array  # (pair,) see `_sort_from_downwind`
    place: Int64Array  # (item,) of an item among those that meet others, -1 if it is not
    named: Int64Array  # (item,) those that meet others
    state: Float64Array  # (2, item, 4) of these, now and before: x, y [m], velocity [m/s]
    bounds: Float64Array  # (item, 4) see `_find_bounds`
    mass: Float64Array  # (item,) [kg]
    held: NDArray[np.bool_]  # (item,)

    @classmethod
    def of(cls, items: int) -> "Scratch":
        """Memory for so many."""
        size, room = 4, min(PAIRS * items, items * (items - 1) // 2)
        while size < 2 * items:
            size *= 2
        whole: dict[str, tuple[int, ...]] = {
            "cell": (items, 2),
            "pairs": (2, room, 2),
            "order": (2, room),
            "place": (items,),
            "named": (items,),
        }
        others = np.zeros((2, items, 4)), np.zeros((items, 4)), np.zeros(items)
        first, following = np.zeros(size, np.int32), np.zeros(items, np.int32)
        cell, pairs, order, place, named = (np.zeros(shape, np.int64) for shape in whole.values())
        about = first, following, cell, pairs, order, np.zeros(room), place, named
        return cls(*about, *others, np.zeros(items, np.bool_))


@kernel
def near_pairs(afloat: Afloat, e: int, reach_m: float, scratch: Scratch) -> int:
    """Find the pairs j < k of a simulation's items that are nearer to each other than `reach_m`.

    Their order depends on the places alone. Returns: their number; those without room are left.
    """
    q, kind, pairs = afloat.q, afloat.kind, scratch.pairs[0]
    first, following, cell = scratch.first, scratch.following, scratch.cell
    last, per_m, count = len(first) - 1, 0.999 * SHARE / reach_m, 0
    first[:] = -1
    for k in range(kind.shape[1]):
        if kind[e, k] < 0.0:
            continue
        x, y = q[e, k, 0], q[e, k, 1]
        in_x, in_y = x * per_m, y * per_m
        own_i, own_j = floor(in_x), floor(in_y)
        in_x, in_y = in_x - own_i, in_y - own_j  # from 0 to 1
        for i in range(own_i - (in_x < SHARE), own_i + 1 + (in_x > 1.0 - SHARE)):
            for j in range(own_j - (in_y < SHARE), own_j + 1 + (in_y > 1.0 - SHARE)):
                other = first[_bucket(i, j) & last]
                while other >= 0:
                    dx, dy = x - q[e, other, 0], y - q[e, other, 1]
                    here = cell[other, 0] == i and cell[other, 1] == j  # not of another cell
                    near = here and dx * dx + dy * dy < reach_m * reach_m
                    if near and count < len(pairs):
                        pairs[count, 0], pairs[count, 1] = other, k
                        count += 1
                    other = following[other]
        cell[k, 0], cell[k, 1], bucket = own_i, own_j, _bucket(own_i, own_j) & last
        following[k], first[bucket] = first[bucket], k
    return count


@inlined
def _bucket(i: int, j: int) -> int:
    """A number of a cell, for a hash of cells."""
    return i * 73856093 ^ j * 19349663


@kernel
def _find_bounds(quays: Quays, state: Float64Array, bounds: Float64Array) -> None:
    """Write the least x, y and largest x, y that items can be moved to, off quays, in a tick.

    No farther than the diameter of an item. One in a quay is not moved deeper.
    """
    land, pitch, radius = quays.land, quays.pitch_m, quays.radius_m
    far, (columns, rows) = 2.0 * radius, grid_shape(land)
    for k in range(len(state)):
        x, y = state[k, 0], state[k, 1]
        free_x, free_y, side_x, side_y = far, far, 1, 1
        i, j = floor(x / pitch + 0.5), floor(y / pitch + 0.5)
        if 0 <= i < columns - 2 and 0 <= j < rows - 2:
            off_x, off_y = x - i * pitch, y - j * pitch
            i, j = i + 1, j + 1  # of the frame
            side_x, side_y = 1 if off_x > 0.0 else -1, 1 if off_y > 0.0 else -1
            gap_x = min(far, max(0.0, 0.5 * pitch - abs(off_x) - radius))
            gap_y = min(far, max(0.0, 0.5 * pitch - abs(off_y) - radius))
            by_x, by_y = framed_is_land(land, i + side_x, j), framed_is_land(land, i, j + side_y)
            corner = framed_is_land(land, i + side_x, j + side_y)
            if not by_x and not by_y and corner:  # one that stands out
                by_x, by_y = gap_x >= gap_y, gap_y >= gap_x
            free_x, free_y = gap_x if by_x else far, gap_y if by_y else far
            if framed_is_land(land, i, j):
                free_x = free_y = far = 0.0
            for w in walls_at(land, i, j):
                to_x, to_y, _ = way_to_wall(land, w, x, y)
                far = min(far, max(0.0, math.hypot(to_x, to_y) - WALL_M - radius))
                free_x, free_y = min(free_x, far), min(free_y, far)
        bounds[k, 0], bounds[k, 2] = x - far, x + far
        bounds[k, 1], bounds[k, 3] = y - far, y + far
        bounds[k, 1 + side_x], bounds[k, 2 + side_y] = x + side_x * free_x, y + side_y * free_y
        far = 2.0 * radius


@kernel
def _give(
    state: Float64Array, bounds: Float64Array, k: int, at: int, nx: float, ny: float, much: float
) -> float:
    """Move item k by so much along a normal, or change its velocity; how much quays let it.

    `at`: column of `state`: 0 places, 2 velocities.
    """
    given = 0.0
    for axis in range(2):
        along = nx if axis == 0 else ny
        old = state[k, at + axis]
        least, most = bounds[k, axis], bounds[k, 2 + axis]
        if at:
            least = min(0.0, old) if state[k, axis] < least + TOUCH_M else -np.inf
            most = max(0.0, old) if state[k, axis] > most - TOUCH_M else np.inf
        new = min(max(old + much * along, least), most)
        given += (new - old) * along
        state[k, at + axis] = new
    return given


@kernel
def _sweep(
    state: Float64Array,
    bounds: Float64Array,
    mass: Float64Array,
    pairs: Int64Array,
    held: NDArray[np.bool_],
    reach_m: float,
) -> float:
    """Part all pairs once, in their order; the largest overlap [m] or approach [m/s] met.

    One item that a quay holds back is held, and so is what lies upwind of it: b of a pair (a, b).

    `state`: (item, 4) x, y [m], velocity [m/s].
    """
    most = 0.0
    for p in range(len(pairs)):
        a, b = pairs[p, 0], pairs[p, 1]
        nx, ny = state[b, 0] - state[a, 0], state[b, 1] - state[a, 1]
        gap = math.sqrt(nx * nx + ny * ny)
        if gap >= reach_m + TOUCH_M:
            continue
        nx, ny = (nx / gap, ny / gap) if gap > _LEAST else (1.0, 0.0)
        share = mass[b] / (mass[a] + mass[b])
        for at in (0, 2):
            much = reach_m - gap
            if at:
                much = (state[a, 2] - state[b, 2]) * nx + (state[a, 3] - state[b, 3]) * ny
            if much <= 0.0:
                continue
            most = max(most, much)
            wanted = much * (0.0 if held[a] else 1.0 if held[b] else share)
            of_a = -_give(state, bounds, a, at, nx, ny, -wanted)
            held[a] |= of_a < wanted - _LEAST
            of_b = _give(state, bounds, b, at, nx, ny, much - of_a)
            if of_a + of_b < much - _LEAST:
                held[b] = True
                _give(state, bounds, a, at, nx, ny, of_a + of_b - much)
            held[b] |= held[a]
    return most


@kernel
def _merge(keys: Float64Array, order: Int64Array, first: int, middle: int, last: int) -> None:
    """Merge two neighbouring sorted runs of row 0 into row 1; of equal ones, the left comes first.

    `order`: (2, place) indices into `keys`.
    """
    left, right = first, middle
    for at in range(first, last):
        if left < middle and (right >= last or keys[order[0, left]] <= keys[order[0, right]]):
            order[1, at] = order[0, left]
            left += 1
        else:
            order[1, at] = order[0, right]
            right += 1


@kernel
def _sort_from_downwind(count: int, to_x: float, to_y: float, scratch: Scratch) -> None:
    """Sort so many pairs from downwind, by the item that is farther upwind, which comes second.

    A stable merge sort, for a GPU has none.
    """
    state, pairs, order, upwind = scratch.state[0], scratch.pairs, scratch.order, scratch.upwind
    for p in range(count):
        a, b = pairs[0, p, 0], pairs[0, p, 1]
        of_a = state[a, 0] * to_x + state[a, 1] * to_y
        of_b = state[b, 0] * to_x + state[b, 1] * to_y
        if of_a < of_b:
            pairs[0, p, 0], pairs[0, p, 1] = b, a
        upwind[p], order[0, p] = -min(of_a, of_b), p
    long = 1
    while long < count:
        for first in range(0, count, 2 * long):
            middle = min(first + long, count)
            _merge(upwind, order, first, middle, min(middle + long, count))
        for p in range(count):
            order[0, p] = order[1, p]
        long *= 2
    for p in range(count):
        for side in range(2):
            pairs[1, p, side] = pairs[0, order[0, p], side]


@kernel
def _renumber(count: int, scratch: Scratch) -> int:
    """Name the items of so many pairs; the pairs become places in that. Returns: how many."""
    pairs, named, place, items = scratch.pairs[0], scratch.named, scratch.place, 0
    place[:] = -1
    for p in range(count):
        for side in range(2):
            k = pairs[p, side]
            if place[k] < 0:
                place[k], named[items] = items, k
                items += 1
            pairs[p, side] = place[k]
    return items


@kernel
def separate(
    afloat: Afloat, quays: Quays, shift_s: float, scratch: Scratch, ids: Int64Array
) -> None:
    """Part the items of simulations `ids` that overlap, and stop those that touch and approach.

    Each of two items gives way by its share of the inverse masses, so that their momentum stays,
    but for what a quay takes. No item is moved into a quay. Sweeps end when all is small. Pairs
    beyond `PAIRS` for each item come to their turn in the next ticks.

    Parameters
    ----------
    afloat : places and velocities of items that touch are written
    shift_s : time by which places in `afloat` run ahead of velocities [s]
    """
    q, v, wind, water = afloat.q, afloat.v, afloat.wind, afloat.water
    kind, kinds, reach_m = afloat.kind, afloat.kinds, 2.0 * quays.radius_m
    named = scratch.named
    for e in ids:
        count = near_pairs(afloat, e, reach_m + AHEAD_M, scratch)
        if not count:
            continue
        items = _renumber(count, scratch)
        state, before = scratch.state[0, :items], scratch.state[1, :items]
        bounds, mass, held = scratch.bounds[:items], scratch.mass[:items], scratch.held[:items]
        to_x = to_y = 0.0
        for n in range(items):
            k = named[n]
            mass[n], state[n, 2], state[n, 3] = kinds[int(kind[e, k]), 0], v[e, k, 0], v[e, k, 1]
            state[n, 0] = q[e, k, 0] - shift_s * v[e, k, 0]
            state[n, 1] = q[e, k, 1] - shift_s * v[e, k, 1]
            for column in range(4):
                before[n, column] = state[n, column]
            # the usual drift of items, for the order of the pairs only
            to_x += LEEWAY * wind[e, k, 0] + water[e, k, 0]
            to_y += LEEWAY * wind[e, k, 1] + water[e, k, 1]
        _sort_from_downwind(count, to_x, to_y, scratch)
        _find_bounds(quays, state, bounds)
        held[:] = False
        for _ in range(SWEEPS):
            if _sweep(state, bounds, mass, scratch.pairs[1, :count], held, reach_m) < SMALL:
                break
        for n in range(items):
            for axis in range(2):
                k, faster = named[n], state[n, 2 + axis] - before[n, 2 + axis]
                q[e, k, axis] += state[n, axis] - before[n, axis] + shift_s * faster
                v[e, k, axis] = state[n, 2 + axis]


SEPARATE = Launch(separate, shared="kinds quays", memory="scratch")
