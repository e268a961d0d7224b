"""Pictures of maps: water shaded by its distance to the quay, quay edges, starts and a scale."""

from pathlib import Path
from typing import Any, cast

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import ScaledTranslation
from numpy.typing import NDArray
from scipy import ndimage

from mjforage.base.atomic_files import atomic_write
from mjforage.base.errors import UserError
from mjforage.scenario.maps import GridMap, Starts
from mjforage.view.page import style
from mjforage.view.page.figure import literal

LONG_SIDE_IN = 7.0  # of the map itself [inch]
MARGIN_IN = (0.6, 0.75)  # across, up: for ticks and title [inch]
DEEP = "#A9D0E6"  # water far from the quay; next to it `style.WATER`
DEPTH_NODES = 5.0  # distance from the quay at which water is as dark as it gets [node]
BELOW_POINTS = 24.0  # from the map down to the scale bar [point]


def map_figure(
    grid: GridMap,
    starts: Starts | None = None,
    title: str | None = None,
    pitch_m: float | None = None,
) -> Figure:
    """Draw a map, north up.

    Parameters
    ----------
    grid : the map
    starts : (row, column) of the starts to mark
    title : by default the map's name, size and number of nodes
    pitch_m : distance between neighbouring nodes [m]; with it a scale bar is drawn
    """
    rows, columns = grid.navigable.shape
    inch = LONG_SIDE_IN / max(rows, columns)
    size = (max(columns * inch, 2.0) + MARGIN_IN[0], max(rows * inch, 1.0) + MARGIN_IN[1])
    if title is None:
        title = f"{grid.name}: {rows} x {columns} cells, {grid.nodes} nodes"
    with rc_context(cast(Any, style.RC)):
        figure = Figure(figsize=size, layout="constrained")
        axes = figure.add_subplot()
        draw_water(axes, grid.navigable)
        draw_quays(axes, grid.navigable, float(np.clip(90.0 / max(rows, columns), 0.2, 1.6)))
        _draw_starts(axes, starts or ())
        if pitch_m is not None:
            _draw_scale(figure, axes, columns * pitch_m)
        _frame(axes, (rows, columns), title)
    return figure


def save_map_picture(
    grid: GridMap,
    path: Path,
    starts: Starts | None = None,
    title: str | None = None,
    pitch_m: float | None = None,
    dpi: int = 120,
) -> None:
    """Write the picture of a map; the suffix chooses the format (PNG, SVG, PDF).

    Parameters
    ----------
    grid, starts, title, pitch_m : as for `map_figure`
    path : file to write; its folder must exist
    dpi : pixels per inch of a PNG

    Raises
    ------
    UserError
        If the file cannot be written or its suffix is no picture format.
    """
    save_figure(map_figure(grid, starts, title, pitch_m), path, dpi)


def save_figure(figure: Figure, path: Path, dpi: int) -> None:
    """Write a picture; the suffix chooses the format.

    Raises
    ------
    UserError
        As `save_map_picture`.
    """
    kinds = sorted(figure.canvas.get_supported_filetypes())
    kind = path.suffix.lower()[1:]
    if kind not in kinds:
        raise UserError(f"picture {path}: unknown kind; give .{', .'.join(kinds)}")
    literal(figure)
    with atomic_write(path) as beside:
        figure.savefig(beside, dpi=dpi, format=kind)


def draw_water(axes: Axes, navigable: NDArray[np.bool_]) -> None:
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


def _draw_starts(axes: Axes, starts: Starts) -> None:
    for row, column in starts:
        axes.plot(
            column, row, "o", ms=7, mfc=style.INK, mec="white", mew=1.2, zorder=4, gid="start"
        )
    if starts:
        row, column = starts[0]
        axes.annotate(
            "start" if len(starts) == 1 else "starts",
            *((column, row), (8, 6)),
            textcoords="offset points",
            fontsize=9,
            color=style.INK,
        )


def scale_length(width_m: float) -> float:
    """Longest round length (1, 2 or 5 times a power of ten) within a quarter of the width [m]."""
    quarter = width_m / 4.0
    decade = 10.0 ** np.floor(np.log10(quarter))
    return float(max(step * decade for step in (1.0, 2.0, 5.0) if step * decade <= quarter))


def _draw_scale(figure: Figure, axes: Axes, width_m: float) -> None:
    """Bar below the map, so that it covers no node."""
    length = scale_length(width_m)
    left = 1.0 - length / width_m
    below = ScaledTranslation(0.0, -BELOW_POINTS / 72.0, figure.dpi_scale_trans)
    bar = Line2D([left, 1.0], [0.0, 0.0], color=style.INK, linewidth=3, solid_capstyle="butt")
    bar.set(transform=axes.transAxes + below, clip_on=False, gid="scale")
    axes.add_line(bar)
    axes.annotate(
        f"{length:g} m",
        (0.5 * (1.0 + left), 0.0),
        xycoords="axes fraction",
        xytext=(0, -BELOW_POINTS - 4),
        textcoords="offset points",
        ha="center",
        va="top",
        fontsize=9,
    )


def _frame(axes: Axes, shape: tuple[int, int], title: str) -> None:
    rows, columns = shape
    axes.set(xlim=(-0.5, columns - 0.5), ylim=(rows - 0.5, -0.5), xlabel="column", ylabel="row")
    axes.set_aspect("equal")
    axes.xaxis.set_major_locator(MaxNLocator(nbins=8, steps=[1, 2, 5, 10], integer=True))
    axes.yaxis.set_major_locator(MaxNLocator(nbins=10, steps=[1, 2, 5, 10], integer=True))
    axes.set_title(title)
    axes.grid(visible=False)
    axes.tick_params(length=3)
    for spine in axes.spines.values():
        spine.set(visible=True, linewidth=0.8, color=style.QUAY_EDGE)
