"""How a frame is shared between the picture and the panel beside it."""

from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

_FULL_HEIGHT, _FULL_WIDTH = 720.0, 1080.0  # of a frame in which a unit is a pixel
_LEAST_UNIT = 0.74
_LINE_WIDTH, _LINE_HEIGHT = 560, 340  # smaller frames have room for one line of words only
_COLUMN, _ROW = 286, 200  # [unit]
_LINE = 23  # [pixel]


class Box(NamedTuple):
    """A rectangle of a frame [pixel]."""

    left: float
    top: float
    right: float
    bottom: float

    @property
    def width(self) -> float:
        """From left to right."""
        return self.right - self.left

    @property
    def height(self) -> float:
        """From top to bottom."""
        return self.bottom - self.top

    def shrunk(self, by: float) -> "Box":
        """Without a margin all around."""
        return Box(self.left + by, self.top + by, self.right - by, self.bottom - by)

    def lower(self, by: float) -> "Box":
        """Without what is at the top."""
        return self._replace(top=self.top + by)


class Kind(Enum):
    """Where the panel is."""

    COLUMN = "left of the picture"
    ROW = "below the picture"
    LINE = "one line above the picture"


@dataclass(frozen=True)
class Split:
    """Panel and picture of a frame; `unit` is the pixel size of everything in the panel."""

    kind: Kind
    unit: float
    panel: Box
    view: Box  # whole pixels

    @property
    def view_size(self) -> tuple[int, int]:
        """Width and height of the picture [pixel]."""
        return round(self.view.width), round(self.view.height)


def unit_of(width: int, height: int) -> float:
    """Pixels per unit in a frame of that size."""
    return max(_LEAST_UNIT, min(height / _FULL_HEIGHT, width / _FULL_WIDTH))


def is_brief(width: int, height: int) -> bool:
    """Whether a frame is so small that a line of words is all that it has room for."""
    return width < _LINE_WIDTH or height < _LINE_HEIGHT


def split_frame(width: int, height: int, shape: float | None) -> Split:
    """Share a frame so that the picture shows most.

    Parameters
    ----------
    width, height : of the frame [pixel]
    shape : width by height of what the picture has to show; None if it fills any picture
    """
    unit = unit_of(width, height)
    if is_brief(width, height):
        line = min(_LINE, height // 3)
        return Split(Kind.LINE, unit, Box(0, 0, width, line), Box(0, line, width, height))
    column, row = 2 * round(0.5 * _COLUMN * unit), 2 * round(0.5 * _ROW * unit)
    beside, below = (width - column, height), (width, height - row)
    if shape is None:
        wide = width >= height
    else:
        wide = min(beside[0] / shape, beside[1]) >= min(below[0] / shape, below[1])
    if wide:
        return Split(Kind.COLUMN, unit, Box(0, 0, column, height), Box(column, 0, width, height))
    middle = height - row
    return Split(Kind.ROW, unit, Box(0, middle, width, height), Box(0, 0, width, middle))
