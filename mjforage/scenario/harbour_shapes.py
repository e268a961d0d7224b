"""Five kinds of generated harbours, each a drawing of rectangles and discs in whole numbers.

All randomness is `bits` of (key, index, step): the step says what is drawn and the index of which,
so a harbour is the same to the bit on every machine. Every kind is drawn one way round, and turned
by the caller. Shapes and sizes are our own choice, after the maps that ship (`docs/maps`).
"""

from collections.abc import Callable, Iterator
from enum import IntEnum
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import bits

Cells = NDArray[np.bool_]
Cell = tuple[int, int]
Link = tuple[Cell, Cell]  # neighbours in a lattice of docks or junctions

LAND = 2  # cells of land between what is apart, and at edges that are closed
SEA = 2  # cells of water at the edges around islands


class Draw(IntEnum):
    """Random draws of a harbour: the step of their random numbers."""

    SIZE = 0
    TURN = 1
    PLACE = 2
    WIDTH = 3
    LENGTH = 4
    SHAPE = 5
    ORDER = 6
    EXTRA = 7
    MOUTH = 8


def drawn(key: np.uint64, what: Draw, index: int, low: int, high: int) -> int:
    """A whole number of low, ..., high, all as likely."""
    return low + int(bits(key, index, int(what))) % (high - low + 1)


def combs(key: np.uint64, rows: int, columns: int) -> Cells:
    """Fairways from west to east, open at the east edge, with parallel piers on both sides."""
    water = np.zeros((rows, columns), np.bool_)
    bands = max(1, rows // 40)
    quays = [rows * band // bands for band in range(bands + 1)]
    middles = []
    for band in range(bands):
        top, bottom = quays[band] + 1, quays[band + 1] - 1
        middle = (top + bottom) // 2 + drawn(key, Draw.PLACE, band, -3, 3)
        width = drawn(key, Draw.WIDTH, band, 4, 6)
        north, south = middle - width // 2, middle - width // 2 + width
        water[top:bottom, LAND:-LAND] = True
        _piers(water[top:north], key, 2 * band)
        _piers(water[south:bottom][::-1], key, 2 * band + 1)
        water[north:south, LAND:] = True
        middles.append(middle)
    for band in range(1, bands):
        column = drawn(key, Draw.MOUTH, band, LAND, columns - LAND - 4)
        water[middles[band - 1] : middles[band], column : column + 4] = True
    return water


def _piers(basin: Cells, key: np.uint64, side: int) -> None:
    """Draw piers into the water (row, column) beside a fairway, from row 0 on."""
    length, columns = basin.shape
    slip = drawn(key, Draw.WIDTH, 1000 * (side + 1), 3, 5)
    pier = drawn(key, Draw.WIDTH, 1000 * (side + 1) + 1, 2, 4)
    left, number = LAND + slip, 1000 * (side + 1)
    while left + pier <= columns - LAND - 3:
        head = length * drawn(key, Draw.LENGTH, number, 75, 100) // 100
        basin[:head, left : left + pier] = False
        left, number = left + pier + slip + drawn(key, Draw.EXTRA, number, 0, 1), number + 1


def basins(key: np.uint64, rows: int, columns: int) -> Cells:
    """Rectangular docks behind walls with gaps; some docks that lead nowhere are filled in."""
    water = np.zeros((rows, columns), np.bool_)
    lines = [_walls(key, axis, length) for axis, length in enumerate((rows, columns))]
    shape = len(lines[0]) - 1, len(lines[1]) - 1

    def spans(dock: Cell) -> tuple[slice, slice]:
        down, across = (
            slice(line[i] + 1, line[i + 1] - 1) for line, i in zip(lines, dock, strict=True)
        )
        return down, across

    tree, others = _tree(key, shape)
    others = [link for link in others if drawn(key, Draw.EXTRA, _number(link), 0, 3) == 0]
    ends = [dock for link in tree + others for dock in link]
    for number, dock in enumerate(np.ndindex(shape)):
        filled = ends.count(dock) == 1 and drawn(key, Draw.SHAPE, number, 0, 2) == 0
        water[spans(dock)] = not filled
    for link in tree + others:
        axis = 0 if link[0][1] == link[1][1] else 1
        if water[spans(link[0])].all() and water[spans(link[1])].all():
            _gap(water, key, _number(link), axis, lines[axis][link[1][axis]], spans(link[0]))
    _gate(water, key)
    return water


def _walls(key: np.uint64, axis: int, length: int) -> list[int]:
    """Middle lines of the walls, each two cells wide, both edges included."""
    docks = max(2, length // drawn(key, Draw.WIDTH, axis, 8, 13))
    inner = [
        length * i // docks + drawn(key, Draw.PLACE, 1000 * axis + i, -1, 1)
        for i in range(1, docks)
    ]
    return [0, *inner, length]


def _gap(
    water: Cells, key: np.uint64, number: int, axis: int, wall: int, spans: tuple[slice, slice]
) -> None:
    """Open a wall between two docks over 2 to 4 cells."""
    along = spans[1 - axis]
    width = drawn(key, Draw.LENGTH, number, 2, 4)
    first = drawn(key, Draw.MOUTH, number, along.start, along.stop - width)
    view = water if axis == 0 else water.T
    view[wall - 1 : wall + 1, first : first + width] = True


def _gate(water: Cells, key: np.uint64) -> None:
    """Join the north edge to water: a passage 3 cells wide, straight down to the first."""
    column = drawn(key, Draw.MOUTH, 0, LAND, water.shape[1] - LAND - 3)
    deep = int((~water[:, column : column + 3]).any(axis=1).cumprod().sum())
    if deep < water.shape[0]:
        water[: deep + 1, column : column + 3] = True


def channels(key: np.uint64, rows: int, columns: int) -> Cells:
    """Corridors 2 to 4 cells wide that wind between junctions, all joined, with some loops."""
    water = np.zeros((rows, columns), np.bool_)
    pitch = drawn(key, Draw.LENGTH, 0, 8, 11)
    shape = max(3, rows // pitch), max(3, columns // pitch)

    def place(junction: Cell) -> Cell:
        number = 1000 * junction[0] + junction[1]
        down, across = (
            min(max(1, (2 * i + 1) * length // (2 * n) + shift), length - 5)
            for i, length, n, shift in zip(
                junction,
                (rows, columns),
                shape,
                (drawn(key, Draw.PLACE, 2 * number + axis, -4, 1) for axis in (0, 1)),
                strict=True,
            )
        )
        return down, across

    tree, others = _tree(key, shape)
    others = [link for link in others if drawn(key, Draw.EXTRA, _number(link), 0, 2) == 0]
    for link in tree + others:
        number = _number(link)
        width = drawn(key, Draw.WIDTH, number, 2, 4)
        ends = place(link[0]), place(link[1])
        _corridor(water, *(ends if drawn(key, Draw.SHAPE, number, 0, 1) else ends[::-1]), width)
    _gate(water, key)
    return water


def _corridor(water: Cells, start: Cell, end: Cell, width: int) -> None:
    """Draw a corridor that goes along the start's row, then along the end's column."""
    left, right = sorted((start[1], end[1]))
    top, bottom = sorted((start[0], end[0]))
    water[start[0] : start[0] + width, left : right + width] = True
    water[top : bottom + width, end[1] : end[1] + width] = True


def islands(key: np.uint64, rows: int, columns: int) -> Cells:
    """Open water, at all edges too, with blocks and round islands scattered over it."""
    water = np.ones((rows, columns), np.bool_)
    for i in range(rows * columns // 90):
        row, column = (
            drawn(key, Draw.PLACE, 2 * i + axis, 0, length - 1)
            for axis, length in enumerate((rows, columns))
        )
        if drawn(key, Draw.SHAPE, i, 0, 1):
            _disc(water, row, column, drawn(key, Draw.LENGTH, i, 2, 4), False)
            continue
        down, across = (drawn(key, Draw.WIDTH, 2 * i + axis, 3, 8) for axis in (0, 1))
        water[row : row + down, column : column + across] = False
    sea = np.ones_like(water)
    sea[SEA:-SEA, SEA:-SEA] = water[SEA:-SEA, SEA:-SEA]
    return sea


def bays(key: np.uint64, rows: int, columns: int) -> Cells:
    """Open water in the north, a coast that bends, and round coves behind narrow mouths."""
    row = np.arange(rows)[:, None]
    coast = _coast(key, rows, columns)
    water = row < coast
    coves = columns // 13
    for i in range(coves):
        column = columns * (2 * i + 1) // (2 * coves) + drawn(key, Draw.PLACE, i, -2, 2)
        shore = int(coast[column])
        for depth in range(drawn(key, Draw.ORDER, i, 1, 4)):
            number = 10 * i + depth
            radius = drawn(key, Draw.LENGTH, number, 3, 5)
            middle = shore + radius + drawn(key, Draw.EXTRA, number, 1, 4)
            if middle + radius > rows - 1 - LAND:
                break
            width = drawn(key, Draw.WIDTH, number, 2, 4)
            first = column - width // 2
            water[shore - 2 : middle, first : first + width] = True
            _disc(water, middle, column, radius, True)
            shore = middle + radius
    return water


def _coast(key: np.uint64, rows: int, columns: int) -> NDArray[np.int64]:
    """(column,) first row of land: straight lines between points 8 columns apart."""
    step = 8
    knots = [rows * drawn(key, Draw.SHAPE, i, 25, 60) // 100 for i in range(columns // step + 2)]
    return np.array(
        [
            knots[c // step] + (knots[c // step + 1] - knots[c // step]) * (c % step) // step
            for c in range(columns)
        ],
        np.int64,
    )


def _disc(water: Cells, row: int, column: int, radius: int, value: bool) -> None:
    """Set the cells within radius + 1/2 of a cell, those outside the map excepted."""
    r, c = np.ogrid[: water.shape[0], : water.shape[1]]
    water[(r - row) ** 2 + (c - column) ** 2 <= radius * (radius + 1)] = value


def _number(link: Link) -> int:
    """A number for a link that no other has, in lattices of up to 100 x 100."""
    (row, column), (below, _) = link
    return 1 + 2 * (100 * row + column) + (below - row)


def _links(shape: Cell) -> Iterator[Link]:
    """Neighbours in a lattice: the one to the south and the one to the east of each."""
    for row, column in np.ndindex(shape):
        if row + 1 < shape[0]:
            yield (row, column), (row + 1, column)
        if column + 1 < shape[1]:
            yield (row, column), (row, column + 1)


def _tree(key: np.uint64, shape: Cell) -> tuple[list[Link], list[Link]]:
    """Links in random order that join all of a lattice without a loop, and the others.

    Kruskal, "On the shortest spanning subtree of a graph", Proc. AMS 7, 1956, by random lengths.
    """
    part = {cell: cell for cell in np.ndindex(shape)}

    def root(cell: Cell) -> Cell:
        while part[cell] != cell:
            cell = part[cell]
        return cell

    tree: list[Link] = []
    others: list[Link] = []
    for link in sorted(_links(shape), key=lambda k: int(bits(key, _number(k), int(Draw.ORDER)))):
        one, other = root(link[0]), root(link[1])
        (others if one == other else tree).append(link)
        part[one] = other
    return tree, others


KINDS = MappingProxyType[str, Callable[[np.uint64, int, int], Cells]](
    {f.__name__: f for f in (combs, basins, channels, islands, bays)}
)
"""Name of a kind -> function of (key, rows, columns) that draws one: (row, column), water True."""
