"""Where map and panel lie in a frame, for any map shape."""

import math
from dataclasses import dataclass

DEFAULT_LONG_SIDE = 1280
LARGE_LONG_SIDE = 1600  # for maps with more than LARGE_MAP nodes along a side
LARGE_MAP = 200
TITLE_HEIGHT, PROGRESS_HEIGHT, LEGEND_ROW = 158, 276, 26  # [unit]
LEGEND_ROWS = 6  # without those of the teams
LINK_ROWS = 3  # more over a link
PANEL_WIDTH, COLUMN_GAP, MARGIN, BORDER = 330, 36, 28, 10  # [unit]
MOST_PIXELS_PER_NODE = 100  # [unit]


@dataclass(frozen=True)
class Layout:
    """Sizes in pixels; `unit` is the pixel size of everything that is not map."""

    width: int
    height: int
    unit: float
    scale: float  # [pixel/node]
    border: float  # water or quay drawn on beyond the outermost nodes [node]
    map_left: int
    map_top: int
    map_width: int
    map_height: int
    panel_left: int
    panel_top: int
    panel_height: int  # beside the map: from its top to its bottom
    stacked: bool  # panel blocks below each other, beside the map; else side by side below it

    def size(self, units: float) -> int:
        """Return a font size or length in whole pixels, at least 1."""
        return max(1, round(units * self.unit))


def legend_height(teams: int, linked: bool) -> int:
    """Return the height of the legend [unit]: two rows per team and the rows all maps have."""
    return LEGEND_ROW * (2 * teams + LEGEND_ROWS + linked * LINK_ROWS)


def _fitting_scale(rows: int, columns: int, room: tuple[float, float], unit: float) -> float:
    """Pixels per node so that map and border fit into `room` (width, height) [pixel]."""
    scales = [MOST_PIXELS_PER_NODE * unit]
    for nodes, pixels in ((columns, room[0]), (rows, room[1])):
        scales += [pixels / (nodes + 1), (pixels - 2 * BORDER * unit) / nodes]
    return min(scales)


def plan_layout(
    rows: int, columns: int, teams: int, long_side: int | None = None, *, linked: bool = False
) -> Layout:
    """Choose the arrangement in which the map is drawn larger.

    Frames are at most `long_side` pixels wide and 3/4 of it high (a little more when the panel
    needs it), with even sizes as video encoders ask for. `long_side` defaults to 1280, to 1600
    for maps of more than 200 nodes along a side. `linked`: the legend has signs for links too.
    """
    if long_side is None:
        long_side = LARGE_LONG_SIDE if max(rows, columns) > LARGE_MAP else DEFAULT_LONG_SIDE
    unit = long_side / DEFAULT_LONG_SIDE
    margin = round(MARGIN * unit)
    most_high = 0.75 * long_side
    legend = legend_height(teams, linked)
    below_height = max(TITLE_HEIGHT, PROGRESS_HEIGHT, legend) * unit
    beside = (long_side - 3 * margin - PANEL_WIDTH * unit, most_high - 2 * margin)
    below = (long_side - 2 * margin, most_high - 3 * margin - below_height)
    scale_beside = _fitting_scale(rows, columns, beside, unit)
    scale_below = _fitting_scale(rows, columns, below, unit)
    stacked = scale_beside >= scale_below
    scale = max(scale_beside, scale_below)
    border = max(0.5, BORDER * unit / scale)
    map_width, map_height = (int((n + 2 * border) * scale + 1e-6) for n in (columns, rows))
    if stacked:
        least = (TITLE_HEIGHT + PROGRESS_HEIGHT + legend) * unit
        panel_height = max(map_height, least)
        width = map_width + 3 * margin + PANEL_WIDTH * unit
        height = panel_height + 2 * margin
        map_left, map_top = margin, round((height - map_height) / 2)
        panel_left, panel_top = map_width + 2 * margin, margin
    else:
        panel_height = below_height
        panel_width = (3 * PANEL_WIDTH + 2 * COLUMN_GAP) * unit
        width = max(map_width, panel_width) + 2 * margin
        height = map_height + 3 * margin + below_height
        map_left, map_top = round((width - map_width) / 2), margin
        panel_left, panel_top = round((width - panel_width) / 2), map_height + 2 * margin
    return Layout(
        width=2 * math.ceil(width / 2),
        height=2 * math.ceil(height / 2),
        unit=unit,
        scale=scale,
        border=border,
        map_left=map_left,
        map_top=map_top,
        map_width=map_width,
        map_height=map_height,
        panel_left=panel_left,
        panel_top=panel_top,
        panel_height=round(panel_height),
        stacked=stacked,
    )


def bare_layout(rows: int, columns: int, width: int, height: int) -> Layout:
    """Place a map alone in the middle of a frame of that size."""
    unit = min(width, height) / (0.75 * DEFAULT_LONG_SIDE)
    scale = _fitting_scale(rows, columns, (width, height), unit)
    border = max(0.5, BORDER * unit / scale)
    map_width, map_height = (int((n + 2 * border) * scale + 1e-6) for n in (columns, rows))
    return Layout(
        width=width,
        height=height,
        unit=unit,
        scale=scale,
        border=border,
        map_left=(width - map_width) // 2,
        map_top=(height - map_height) // 2,
        map_width=map_width,
        map_height=map_height,
        panel_left=width,
        panel_top=0,
        panel_height=0,
        stacked=True,
    )
