"""Figures on the map: true items, believed items, and the tracks of the fleet."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, Colormap, Normalize, to_rgb
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from mjforage.runs.episode_recording import Recording
from mjforage.view.figures.map_pictures import draw_quays
from mjforage.view.page import style
from mjforage.view.page.figure import WIDE_IN, ReportFigure, canvas
from mjforage.view.report.run_logs import RunLogs

ENDS = {False: "^", True: "D"}  # marker of a vessel by whether it collects
DISCRETE = 12  # counts up to this many have a colour each
TRAIL = 12  # steps of wake behind a vessel
INSTRUCTIVE = 0.4  # share of the items removed at the step that is shown


def draw_port(axes: Axes, navigable: NDArray[np.bool_]) -> None:
    """Draw water, quays and the quay edge: (row, column), row 0 at the top."""
    axes.imshow(navigable, cmap=style.map_colours(), vmin=0, vmax=1, interpolation="nearest")
    frame_port(axes, navigable)


def frame_port(axes: Axes, navigable: NDArray[np.bool_]) -> None:
    """Draw the quay edge only and remove ticks and frame."""
    draw_quays(axes, navigable, 0.7)
    height, width = navigable.shape
    axes.set(xlim=(-0.5, width - 0.5), ylim=(height - 0.5, -0.5), xticks=[], yticks=[])
    axes.set_aspect("equal")
    axes.grid(visible=False)
    axes.spines[:].set_visible(False)


def instructive_step(present: NDArray[np.bool_], share: float = INSTRUCTIVE) -> int:
    """First step with that share of the items removed; else a third of the episode.

    Parameters
    ----------
    present
        (step, item), False once removed.
    """
    removed = 1.0 - present.mean(axis=1) if present.shape[1] else np.zeros(len(present))
    reached = np.flatnonzero(removed >= share)
    return int(reached[0]) if len(reached) else len(present) // 3


def items_per_node(recording: Recording, step: int) -> NDArray[np.int64]:
    """Discretised distribution Y of the paper: items per node, (row, column)."""
    counts = np.zeros(recording.navigable.shape, dtype=np.int64)
    nodes = np.rint(recording.item_rc[step][recording.item_present[step]]).astype(np.int64)
    np.add.at(counts, (nodes[:, 0], nodes[:, 1]), 1)
    return counts


def draw_track(
    axes: Axes, track: NDArray[np.floating], colour: str, collects: bool, size: float = 5.5
) -> None:
    """Draw a track, (step, 2) of rows and columns, with a vessel's marker at its end."""
    axes.plot(track[:, 1], track[:, 0], color=colour, linewidth=1.2, alpha=0.85, zorder=4)
    end: dict[str, Any] = {"markeredgecolor": "white", "markeredgewidth": 0.6, "zorder": 6}
    axes.plot(track[-1, 1], track[-1, 0], ENDS[collects], color=colour, markersize=size, **end)


def _scene(axes: Axes, recording: Recording, step: int) -> None:
    """Draw the nodes that scouts and foragers see, the items afloat, and the vessels."""
    draw_port(axes, recording.navigable)
    seen = recording.in_view[step]
    tint = np.zeros((*seen.shape, 4))
    for bit, colour in ((1, style.SCOUT_VIEW), (2, style.FORAGER_VIEW)):
        tint[seen & bit > 0] = (*to_rgb(colour), 1.0)
    axes.imshow(tint, interpolation="nearest")
    afloat = recording.item_rc[step][recording.item_present[step]]
    look: dict[str, Any] = {"color": style.ITEM, "edgecolors": style.ITEM_RIM, "linewidths": 0.9}
    axes.scatter(afloat[:, 1], afloat[:, 0], s=13, zorder=3, **look)
    for agent, collects in enumerate(recording.agent_collects.tolist()):
        track = recording.agent_rc[max(0, step - TRAIL) : step + 1, agent]
        draw_track(axes, track, style.FORAGER if collects else style.SCOUT, collects, 8.0)
    axes.set_title("(a) fleet and items")


def draw_counts(
    axes: Axes,
    navigable: NDArray[np.bool_],
    counts: NDArray[np.integer],
    top: int,
    colours: Colormap,
) -> AxesImage:
    """Colour every node by a count from 0 to `top`, land as land."""
    shown = np.ma.masked_where(~navigable, counts)
    norm: Normalize = Normalize(0, top)
    if top <= DISCRETE:
        norm = BoundaryNorm(np.arange(-0.5, top + 1), colours.N)
    shades = colours.with_extremes(bad=style.LAND)
    return axes.imshow(shown, cmap=shades, norm=norm, interpolation="nearest")


def _legend(figure: Figure, collects: NDArray[np.bool_]) -> None:
    handles: list[Line2D | Patch] = []
    for forager in sorted(set(collects.tolist())):
        role = style.role(forager)
        colour = style.FORAGER if forager else style.SCOUT
        view = style.FORAGER_VIEW if forager else style.SCOUT_VIEW
        handles.append(Line2D([], [], color=colour, marker=ENDS[forager], label=role))
        handles.append(Patch(facecolor=view, label=f"seen by a {role}"))
    item: dict[str, Any] = {"linestyle": "", "markersize": 5, "markeredgecolor": style.ITEM_RIM}
    handles.append(Line2D([], [], color=style.ITEM, marker="o", label="item afloat", **item))
    figure.legend(handles=handles, loc="outside lower left", ncols=len(handles), columnspacing=1.6)


def _layout(shape: tuple[int, ...]) -> tuple[int, int, float, float]:
    """Rows and columns of the three panels, and the figure's width and height [in]."""
    tall = shape[0] / shape[1]
    if tall > 0.6:
        height = min(7.5, 3.45 * tall)
        return 1, 3, 3 * max(2.7, height / tall) + WIDE_IN - 3 * 3.45, height + 0.85
    return 3, 1, WIDE_IN, min(12.0, 3 * (WIDE_IN - 1.2) * tall) + 1.6


def scenario_figure(logs: RunLogs, recording: Recording) -> ReportFigure:
    """Draw the paper's scenario figure from a recorded episode at an instructive step."""
    step = instructive_step(recording.item_present)
    counts, belief = items_per_node(recording, step), recording.belief[step].astype(np.int64)
    top = max(3, int(counts.max()), int(belief.max()))
    rows, columns, width, height = _layout(recording.navigable.shape)
    figure = canvas(width, height)
    panels = list(figure.subplots(rows, columns, squeeze=False).flat)
    _scene(panels[0], recording, step)
    for axes, title, shown, colours in (  # the outer bar is drawn first
        (panels[2], "(c) believed items", belief, style.belief_colours()),
        (panels[1], "(b) true items", counts, style.item_colours()),
    ):
        image = draw_counts(axes, recording.navigable, shown, top, colours)
        frame_port(axes, recording.navigable)
        axes.set_title(title)
        place: dict[str, Any] = {"shrink": 0.6, "pad": 0.015, "aspect": 28}
        bar = figure.colorbar(image, ax=panels, label=f"{title[4:]} per node", **place)
        bar.ax.yaxis.set_major_locator(MaxNLocator(6, integer=True))
        bar.ax.minorticks_off()
        bar.ax.tick_params(length=0)
        bar.outline.set_visible(False)
    _legend(figure, recording.agent_collects)
    total, afloat = recording.item_present.shape[1], int(counts.sum())
    known = int(np.minimum(counts, belief).sum())
    words = (
        f"Episode {recording.episode} of {recording.policy} in the {recording.world} world after "
        f"step {step} of {logs.run.horizon}: {total - afloat} of {total} items are removed, and "
        f"the belief has {known} of the {afloat} still afloat in their true node. (a) vessels with "
        f"their wake of {TRAIL} steps, the nodes they see and the items as they drift; (b) the "
        "same items discretised to nodes; (c) the count that the fleet believes, last updated "
        "when a node was seen."
    )
    return ReportFigure("scenario", "The scenario", words, figure, wide=True)
