"""Figures on the map: true items, believed items, and the tracks of the fleet."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import BoundaryNorm, Colormap, Normalize, to_rgb
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.markers import MarkerStyle
from matplotlib.patches import Patch
from matplotlib.path import Path as DrawnPath
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import Affine2D
from numpy.typing import NDArray

from mjforage.runs.episode_recording import Recording
from mjforage.view.page import style
from mjforage.view.page.figure import WIDE_IN, ReportFigure, canvas
from mjforage.view.report.run_logs import RunLogs

SCOUT_HULL = DrawnPath(
    [(-0.42, -0.9), (-0.42, 0.1), (0, 1.0), (0.42, 0.1), (0.42, -0.9), (0, 0)], [1, 2, 2, 2, 2, 79]
)
FORAGER_HULL = DrawnPath(
    [(-0.7, -0.8), (-0.7, 0.75), (-0.2, 0.35), (0.2, 0.35), (0.7, 0.75), (0.7, -0.8), (0, 0)],
    [1, 2, 2, 2, 2, 2, 79],
)
DISCRETE = 12  # counts up to this many have a colour each
TRAIL = 12  # steps of wake behind a vessel
INSTRUCTIVE = 0.4  # share of the items removed at the step that is shown


def draw_port(axes: Axes, navigable: NDArray[np.bool_]) -> None:
    """Draw water, quays and the quay edge: (row, column), row 0 at the top."""
    axes.imshow(navigable, cmap=style.map_colours(), vmin=0, vmax=1, interpolation="nearest")
    frame_port(axes, navigable)


def frame_port(axes: Axes, navigable: NDArray[np.bool_]) -> None:
    """Draw the quay edge only and remove ticks and frame."""
    padded = np.pad(navigable, 1)
    rows, cols = np.nonzero(padded[:, 1:] != padded[:, :-1])
    upright = [((c - 0.5, r - 1.5), (c - 0.5, r - 0.5)) for r, c in zip(rows, cols, strict=True)]
    rows, cols = np.nonzero(padded[1:, :] != padded[:-1, :])
    level = [((c - 1.5, r - 0.5), (c - 0.5, r - 0.5)) for r, c in zip(rows, cols, strict=True)]
    axes.add_collection(
        LineCollection(upright + level, colors=style.QUAY_EDGE, linewidths=0.7, capstyle="round")
    )
    height, width = navigable.shape
    axes.set(xlim=(-0.5, width - 0.5), ylim=(height - 0.5, -0.5), xticks=[], yticks=[])
    axes.set_aspect("equal")
    axes.grid(visible=False)
    for spine in axes.spines.values():
        spine.set_visible(False)


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


def items_per_node(replay: Recording, step: int) -> NDArray[np.int64]:
    """Discretised distribution Y of the paper: items per node, (row, column)."""
    counts = np.zeros(replay.navigable.shape, dtype=np.int64)
    nodes = np.rint(replay.item_rc[step][replay.item_present[step]]).astype(np.int64)
    np.add.at(counts, (nodes[:, 0], nodes[:, 1]), 1)
    return counts


def _views(axes: Axes, seen: NDArray[np.uint8]) -> None:
    """Tint the nodes that scouts and foragers see."""
    tint = np.zeros((*seen.shape, 4))
    for bit, colour in ((1, style.SCOUT_VIEW), (2, style.FORAGER_VIEW)):
        tint[seen & bit > 0] = (*to_rgb(colour), 1.0)
    axes.imshow(tint, interpolation="nearest")


def heading_degrees(track: NDArray[np.float32]) -> float:
    """Heading of the last move of a track (step, 2) [node], counter-clockwise from up."""
    moves = np.diff(track, axis=0)
    moved = np.flatnonzero(np.abs(moves).sum(axis=1) > 0)
    if not len(moved):
        return 0.0
    row, col = moves[moved[-1]]
    return math.degrees(math.atan2(-float(col), -float(row)))


def _fleet(axes: Axes, replay: Recording, step: int) -> None:
    for agent, collects in enumerate(replay.agent_collects):
        track = replay.agent_rc[max(0, step - TRAIL) : step + 1, agent]
        colour = style.FORAGER if collects else style.SCOUT
        axes.plot(track[:, 1], track[:, 0], color=colour, linewidth=1.6, alpha=0.8, zorder=4)
        turn = Affine2D().rotate_deg(heading_degrees(replay.agent_rc[: step + 1, agent]))
        hull = MarkerStyle(FORAGER_HULL if collects else SCOUT_HULL, transform=turn)
        axes.plot(
            track[-1, 1],
            track[-1, 0],
            marker=hull,
            markersize=13,
            color=colour,
            markeredgecolor="white",
            markeredgewidth=0.9,
            zorder=6,
        )


def draw_items(axes: Axes, replay: Recording, step: int) -> None:
    """Mark the items that are afloat after a step."""
    afloat = replay.item_rc[step][replay.item_present[step]]
    look: dict[str, Any] = {"color": style.ITEM, "edgecolors": style.ITEM_RIM, "linewidths": 0.9}
    axes.scatter(afloat[:, 1], afloat[:, 0], s=13, zorder=3, **look)


def _scene(axes: Axes, replay: Recording, step: int) -> None:
    draw_port(axes, replay.navigable)
    _views(axes, replay.in_view[step])
    draw_items(axes, replay, step)
    _fleet(axes, replay, step)
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


def colour_bar(
    figure: Figure, image: AxesImage, panels: Sequence[Axes], label: str, **place: Any
) -> None:
    """Draw a bar of whole numbers beside panels, or below them."""
    bar = figure.colorbar(image, ax=list(panels), label=label, **place)
    axis = bar.ax.xaxis if place.get("location") == "bottom" else bar.ax.yaxis
    axis.set_major_locator(MaxNLocator(6, integer=True))
    bar.ax.minorticks_off()
    bar.ax.tick_params(length=0)
    bar.outline.set_visible(False)


def _legend(figure: Figure, collects: NDArray[np.bool_]) -> None:
    handles: list[Line2D | Patch] = []
    for role, hull, colour, view, present in (
        ("scout", SCOUT_HULL, style.SCOUT, style.SCOUT_VIEW, bool((~collects).any())),
        ("forager", FORAGER_HULL, style.FORAGER, style.FORAGER_VIEW, bool(collects.any())),
    ):
        if present:
            vessel: dict[str, Any] = {
                "marker": MarkerStyle(hull),
                "markersize": 11,
                "markeredgecolor": "white",
            }
            handles.append(Line2D([], [], color=colour, linewidth=1.6, label=role, **vessel))
            handles.append(Patch(facecolor=view, label=f"seen by a {role}"))
    item: dict[str, Any] = {
        "marker": "o",
        "linestyle": "",
        "markersize": 5,
        "markeredgecolor": style.ITEM_RIM,
    }
    handles.append(Line2D([], [], color=style.ITEM, label="item afloat", **item))
    figure.legend(handles=handles, loc="outside lower left", ncols=len(handles), columnspacing=1.6)


def _layout(shape: tuple[int, int]) -> tuple[int, int, float, float]:
    """Rows and columns of the three panels, and the figure's width and height [in]."""
    tall = shape[0] / shape[1]
    if tall > 0.6:
        height = min(7.5, 3.45 * tall)
        return 1, 3, 3 * max(2.7, height / tall) + WIDE_IN - 3 * 3.45, height + 0.85
    return 3, 1, WIDE_IN, min(12.0, 3 * (WIDE_IN - 1.2) * tall) + 1.6


def scenario_figure(logs: RunLogs, replay: Recording) -> ReportFigure:
    """Draw the paper's scenario figure from a replay at an instructive step."""
    step = instructive_step(replay.item_present)
    counts, belief = items_per_node(replay, step), replay.belief[step].astype(np.int64)
    top = max(3, int(counts.max()), int(belief.max()))
    rows, columns, width, height = _layout((replay.navigable.shape[0], replay.navigable.shape[1]))
    figure = canvas(width, height)
    panels = list(figure.subplots(rows, columns, squeeze=False).flat)
    _scene(panels[0], replay, step)
    for axes, title, shown, colours in (  # the outer bar is drawn first
        (panels[2], "(c) believed items", belief, style.belief_colours()),
        (panels[1], "(b) true items", counts, style.item_colours()),
    ):
        image = draw_counts(axes, replay.navigable, shown, top, colours)
        frame_port(axes, replay.navigable)
        axes.set_title(title)
        place: dict[str, Any] = {"shrink": 0.6, "pad": 0.015, "aspect": 28}
        colour_bar(figure, image, panels, f"{title[4:]} per node", **place)
    _legend(figure, replay.agent_collects)
    return ReportFigure(
        "scenario", "The scenario", _words(logs, replay, step, counts, belief), figure, wide=True
    )


def _words(
    logs: RunLogs,
    replay: Recording,
    step: int,
    counts: NDArray[np.int64],
    belief: NDArray[np.int64],
) -> str:
    total, afloat = replay.item_present.shape[1], int(counts.sum())
    known = int(np.minimum(counts, belief).sum())
    return (
        f"Episode {replay.episode} of {replay.policy} in the {replay.world} world after step "
        f"{step} of {logs.run.horizon}: {total - afloat} of {total} items are removed, and the "
        f"belief has {known} of the {afloat} still afloat in their true node. (a) vessels with "
        f"their wake of {TRAIL} steps, the nodes they see and the items as they drift; (b) the "
        "same items discretised to nodes; (c) the count that the fleet believes, last updated "
        "when a node was seen."
    )
