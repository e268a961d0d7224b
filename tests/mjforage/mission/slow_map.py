"""Water as a list of cells, in plain Python: nodes, edges, straight lines and what is in view."""

import math
from functools import cache

import numpy as np
from numpy.typing import NDArray

COMPASS = ((-1, 0), (-1, 1), (0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1))
"""(row, column) of a move to N, NE, E, SE, S, SW, W, NW."""
Cell = tuple[int, int]


def line(start: Cell, end: Cell) -> list[Cell]:
    """Cells of the straight line, both ends included; halves round away from its start."""
    points = max(abs(end[0] - start[0]), abs(end[1] - start[1]))

    def along(axis: int, k: int) -> int:
        off = (end[axis] - start[axis]) * k / points
        return start[axis] + int(math.copysign(math.floor(abs(off) + 0.5), off))

    return [(along(0, k), along(1, k)) for k in range(points + 1)] if points else [start]


class SlowMap:
    """Nodes are water cells, numbered row by row."""

    def __init__(
        self, water: NDArray[np.bool_], corner_cutting: bool, across_land: bool = False
    ) -> None:
        height, width = water.shape
        self.height, self.width, self.corner_cutting = height, width, corner_cutting
        self.across_land = across_land
        self.cells = [(r, c) for r in range(height) for c in range(width) if water[r, c]]
        self.number = {cell: i for i, cell in enumerate(self.cells)}
        self.seen_from = cache(self._seen_from)

    def beside(self, node: int, direction: int) -> int:
        """The next node in a direction, -1 where there is no edge."""
        (row, col), (down, right) = self.cells[node], COMPASS[direction]
        sides = (row + down, col) in self.number and (row, col + right) in self.number
        if down and right and not sides and not self.corner_cutting:
            return -1
        return self.number.get((row + down, col + right), -1)

    def jumped(self, node: int, direction: int, nodes: int) -> int:
        """The node that lies so many cells away, whatever is between; -1 if it is none."""
        (row, col), (down, right) = self.cells[node], COMPASS[direction]
        return self.number.get((row + nodes * down, col + nodes * right), -1)

    def _seen_from(self, node: int, radius: float) -> list[int]:
        """Nodes no farther than a radius whose straight line is all water, or is not asked for."""
        row, col = self.cells[node]
        reach = int(radius) + 1
        near = (
            (row + down, col + right)
            for down in range(-reach, reach + 1)
            for right in range(-reach, reach + 1)
            if math.hypot(down, right) <= radius + 1e-9
        )
        return [
            self.number[cell]
            for cell in near
            if cell in self.number
            and (self.across_land or all(one in self.number for one in line((row, col), cell)))
        ]

    def apart(self, one: int, other: int) -> float:
        """Distance between two nodes as the crow flies [node]."""
        return math.dist(self.cells[one], self.cells[other])

    def walls(self, one: int, other: int) -> int:
        """Land cells on the straight line, drawn from the northern (or western) of its ends."""
        ends = sorted((self.cells[one], self.cells[other]))
        return sum(cell not in self.number for cell in line(*ends))

    def node_of(self, place: tuple[float, float]) -> int:
        """Node to which a place rounds, -1 on land."""
        return self.number.get((math.floor(place[0] + 0.5), math.floor(place[1] + 0.5)), -1)

    def pushed_into_water(self, place: tuple[float, float], walls: str) -> tuple[float, float]:
        """Where an item comes to lie (definitions, section 1, `walls`)."""
        if self.node_of(place) >= 0:
            return place
        row = min(max(place[0], 0.0), self.height - 1.0)
        col = min(max(place[1], 0.0), self.width - 1.0)
        r, c = min(self.cells, key=lambda cell: (cell[0] - row) ** 2 + (cell[1] - col) ** 2)
        down, right = row - r, col - c
        largest = max(abs(down), abs(right))
        if walls == "clip" or largest <= 0.49:
            return r + min(max(down, -0.49), 0.49), c + min(max(right, -0.49), 0.49)
        down, right = down * 0.49 / largest, right * 0.49 / largest
        if walls == "published":
            sign = float(np.sign(min(row - r, col - c)))
            if abs(down) < abs(right):
                down = abs(down) * sign
            else:
                right = abs(right) * sign
        return r + down, c + right
