"""Sheets of maps: many small ones on a page, all to one scale, to compare at a glance."""

from collections.abc import Sequence
from math import ceil
from pathlib import Path
from typing import Any, cast

from matplotlib import rc_context
from matplotlib.figure import Figure

from mjforage.base.errors import UserError
from mjforage.scenario.maps import GridMap
from mjforage.view.figures.map_pictures import draw_quays, draw_water, save_figure
from mjforage.view.page import style

ACROSS = 5  # maps in a row
MOST = 100  # maps on a sheet
INCH = 1.9  # for each map
DPI = 100
QUAY_POINTS = 0.6


def map_sheet(grids: Sequence[GridMap]) -> Figure:
    """Draw maps from left to right, north up, each with its name, all to the scale of the largest.

    Parameters
    ----------
    grids : the maps, in order
    """
    side = max(max(grid.navigable.shape) for grid in grids)
    across, down = min(ACROSS, len(grids)), ceil(len(grids) / ACROSS)
    with rc_context(cast(Any, style.RC)):
        figure = Figure(figsize=(across * INCH, down * (INCH + 0.2)), layout="constrained")
        every = figure.subplots(down, across, squeeze=False).ravel()
        for axes in every:
            axes.set_axis_off()
        for axes, grid in zip(every, grids, strict=False):
            rows, columns = grid.navigable.shape
            draw_water(axes, grid.navigable)
            draw_quays(axes, grid.navigable, QUAY_POINTS)
            middle = columns / 2 - 0.5, rows / 2 - 0.5
            axes.set(
                xlim=(middle[0] - side / 2, middle[0] + side / 2),
                ylim=(middle[1] + side / 2, middle[1] - side / 2),
            )
            axes.set_aspect("equal")
            axes.set_title(grid.name.partition(":")[2] or grid.name, fontsize=8)
    return figure


def save_map_sheet(grids: Sequence[GridMap], path: Path) -> None:
    """Write a sheet of maps; the suffix chooses the format (PNG, SVG, PDF).

    Parameters
    ----------
    grids : the maps
    path : file to write; its folder must exist

    Raises
    ------
    UserError
        If there are too many maps, the file cannot be written or its suffix is no picture format.
    """
    if len(grids) > MOST:
        raise UserError(f"picture {path}: {len(grids)} maps; give at most {MOST} of them")
    save_figure(map_sheet(grids), path, DPI)
