"""Pictures of maps: one with rows and columns, or many small ones on a sheet, to one scale."""

from collections.abc import Sequence
from math import ceil
from pathlib import Path
from typing import Any, cast

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray
from scipy import ndimage

from mjforage.base.atomic_files import atomic_write
from mjforage.base.errors import UserError
from mjforage.scenario.maps import GridMap, Starts
from mjforage.view.page import style
from mjforage.view.page.figure import Picture, literal

ACROSS = 5  # maps in a row of a sheet
MOST = 100  # maps on a sheet
ALONE_IN, SHEET_IN = 7.0, 1.9  # longer side of the largest map, alone and on a sheet [inch]
DPI = 120
DEEP = "#A9D0E6"  # water far from the quay; next to it `style.WATER`
DEPTH_NODES = 5.0  # distance from the quay at which water is as dark as it gets [node]


def map_figure(grids: Sequence[GridMap], starts: Starts = ()) -> Figure:
    """Draw maps from left to right, north up, each with its name, all to the scale of the largest.

    One map alone has its size, number of nodes, rows and columns beside it, and `starts` (row,
    column) marked.
    """
    alone = len(grids) == 1
    tall, wide = np.max([grid.navigable.shape for grid in grids], axis=0)
    inch = (ALONE_IN if alone else SHEET_IN) / max(tall, wide)
    across, down = min(ACROSS, len(grids)), ceil(len(grids) / ACROSS)
    size = across * (max(wide * inch, 1.0) + 0.6 * alone), down * (max(tall * inch, 1.0) + 0.4)
    with rc_context(cast(Any, style.RC)):
        figure = Picture(figsize=size, layout="constrained")
        every = figure.subplots(down, across, squeeze=False).ravel()
        for axes in every:
            axes.set_axis_off()
        for axes, grid in zip(every, grids, strict=False):
            rows, columns = grid.navigable.shape
            _draw_water(axes, grid.navigable)
            draw_quays(axes, grid.navigable, float(np.clip(12.0 * inch, 0.2, 1.6)))
            axes.set_aspect("equal")
            if alone:
                _name(axes, grid)
                axes.plot([c for _, c in starts], [r for r, _ in starts], "o", color=style.INK)
                continue
            middle = columns / 2 - 0.5, rows / 2 - 0.5
            axes.set_xlim(middle[0] - wide / 2, middle[0] + wide / 2)
            axes.set_ylim(middle[1] + tall / 2, middle[1] - tall / 2)
            axes.set_title(grid.name.partition(":")[2] or grid.name, fontsize=8)
    return figure


def save_map_picture(grids: Sequence[GridMap], path: Path) -> None:
    """Write the picture of maps; the suffix chooses the format (PNG, SVG, PDF).

    Raises `UserError` if there are too many maps, the file cannot be written or its suffix is no
    picture format.

    Parameters
    ----------
    grids : one map, or up to 100 for a sheet
    path : file to write; its folder must exist
    """
    if len(grids) > MOST:
        raise UserError(f"picture {path}: {len(grids)} maps; give at most {MOST} of them")
    figure = map_figure(grids)
    kinds = sorted(figure.canvas.get_supported_filetypes())
    kind = path.suffix.lower()[1:]
    if kind not in kinds:
        raise UserError(f"picture {path}: unknown kind; give .{', .'.join(kinds)}")
    literal(figure)
    with atomic_write(path) as beside:
        figure.savefig(beside, dpi=DPI, format=kind)


def _draw_water(axes: Axes, navigable: NDArray[np.bool_]) -> None:
    """Water, darker towards the open, and land, of (row, column)."""
    depth = ndimage.distance_transform_edt(np.pad(navigable, 1, mode="edge"))[1:-1, 1:-1]
    shades = LinearSegmentedColormap.from_list("depth", [style.WATER, DEEP])
    colours: NDArray[Any] = shades(np.minimum((depth - 1.0) / (DEPTH_NODES - 1.0), 1.0))
    land = LinearSegmentedColormap.from_list("land", [style.LAND, style.LAND])
    colours[~navigable] = land(0.0)
    axes.imshow(colours, interpolation="nearest")


def draw_quays(axes: Axes, navigable: NDArray[np.bool_], points: float) -> None:
    """Line so wide between each water cell and the land beside it; the array's own edge is open."""
    rows, cols = np.nonzero(navigable[:, 1:] != navigable[:, :-1])
    lines = [((c + 0.5, r - 0.5), (c + 0.5, r + 0.5)) for r, c in zip(rows, cols, strict=True)]
    rows, cols = np.nonzero(navigable[1:] != navigable[:-1])
    lines += [((c - 0.5, r + 0.5), (c + 0.5, r + 0.5)) for r, c in zip(rows, cols, strict=True)]
    quays = LineCollection(lines, colors=style.QUAY_EDGE, linewidths=points, capstyle="round")
    axes.add_collection(quays)


def _name(axes: Axes, grid: GridMap) -> None:
    rows, columns = grid.navigable.shape
    axes.set_axis_on()
    axes.set(xlim=(-0.5, columns - 0.5), ylim=(rows - 0.5, -0.5), xlabel="column", ylabel="row")
    axes.xaxis.set_major_locator(MaxNLocator(nbins=8, integer=True))
    axes.yaxis.set_major_locator(MaxNLocator(nbins=10, integer=True))
    axes.set_title(f"{grid.name}: {rows} x {columns} cells, {grid.nodes} nodes")
    axes.grid(visible=False)
