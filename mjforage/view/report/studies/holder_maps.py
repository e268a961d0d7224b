"""What two holders know at the same moment: their maps and how old these are, side by side."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.markers import MarkerStyle
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from mjforage.runs.episode_recording import Recording
from mjforage.runs.holders_seen import UNSEEN, HoldersMaps
from mjforage.view.page import style
from mjforage.view.page.figure import WIDE_IN, ReportFigure, canvas, house_style
from mjforage.view.report.map_figures import (
    FORAGER_HULL,
    SCOUT_HULL,
    draw_counts,
    draw_items,
    frame_port,
)

AGES = ("#F2F8FC", "#9CC5E0", "#3F83B5", "#12406A")  # from new to old
NEVER_SEEN = "#B4B4BC"
HULL = 11  # size of a vessel
OWN: dict[str, Any] = {"markeredgecolor": "white", "markeredgewidth": 0.9}
OTHERS: dict[str, Any] = {"markerfacecolor": "white", "markeredgewidth": 1.4}
TALL = 0.6  # height over width of maps that stand beside one another


def _vessels(axes: Axes, replay: Recording, maps: HoldersMaps, agent: int) -> None:
    """Where a holder takes all vessels to be, and a thread to where those are that it has lost."""
    known, truth = maps.agent_rc[maps.owner_of[agent]], replay.agent_rc[maps.step]
    for other, collects in enumerate(replay.agent_collects):
        colour = style.FORAGER if collects else style.SCOUT
        (row, col), (true_row, true_col) = known[other], truth[other]
        if (row, col) != (true_row, true_col):
            axes.plot([col, true_col], [row, true_row], color=colour, linewidth=1.0, zorder=4)
            axes.plot(true_col, true_row, "x", color=colour, markersize=5.5, zorder=5)
        look: dict[str, Any] = {
            "color": colour,
            "markersize": HULL,
            "zorder": 7 if other == agent else 6,
        }
        look |= OWN if other == agent else OTHERS
        hull = MarkerStyle(FORAGER_HULL if collects else SCOUT_HULL)
        axes.plot(col, row, marker=hull, **look)


def _belief(
    axes: Axes, replay: Recording, belief: NDArray[np.int16], top: int, step: int
) -> AxesImage:
    """Items that a holder believes in, and where items are."""
    draw_items(axes, replay, step)
    return draw_counts(axes, replay.navigable, belief, top, style.belief_colours())


def _age(axes: Axes, replay: Recording, age: NDArray[np.int32], top: int) -> AxesImage:
    """Steps since a look that a holder knows of saw a node."""
    plain = LinearSegmentedColormap.from_list("ages", AGES)
    colours = plain.with_extremes(bad=style.LAND, under=NEVER_SEEN)
    shown = np.ma.masked_where(~replay.navigable, age)
    return axes.imshow(shown, cmap=colours, norm=Normalize(0, top), interpolation="nearest")


def _bar(figure: Figure, image: AxesImage, panels: Sequence[Axes], label: str) -> None:
    bar = figure.colorbar(
        image, ax=list(panels), location="bottom", shrink=0.7, pad=0.02, aspect=30, label=label
    )
    bar.ax.xaxis.set_major_locator(MaxNLocator(6, integer=True))
    bar.ax.minorticks_off()
    bar.ax.tick_params(length=0)
    bar.outline.set_visible(False)


def _legend(figure: Figure) -> None:
    def mark(label: str, marker: Any, colour: str, **look: Any) -> Line2D:
        size: dict[str, Any] = {"markersize": HULL} | look
        return Line2D([], [], linestyle="", marker=marker, color=colour, label=label, **size)

    figure.legend(
        handles=[
            mark("itself", MarkerStyle(SCOUT_HULL), style.SCOUT, **OWN),
            mark("scout, as last heard", MarkerStyle(SCOUT_HULL), style.SCOUT, **OTHERS),
            mark("forager, as last heard", MarkerStyle(FORAGER_HULL), style.FORAGER, **OTHERS),
            mark("where it is", "x", style.MUTED, markersize=5.5),
            mark("item afloat", "o", style.ITEM, markeredgecolor=style.ITEM_RIM, markersize=4.5),
            Patch(facecolor=NEVER_SEEN, label="never seen"),
        ],
        loc="outside upper left",
        ncols=6,
        columnspacing=1.4,
        handletextpad=0.4,
    )


def pair_of(maps: HoldersMaps, collects: NDArray[np.bool_]) -> tuple[int, int]:
    """The scout and the forager whose maps are least alike; of agents of one kind, any two."""
    scouts, foragers = np.flatnonzero(~collects), np.flatnonzero(collects)
    one, other = (scouts, foragers) if scouts.size and foragers.size else (scouts, scouts)
    one, other = (one, other) if one.size else (foragers, foragers)
    belief = maps.belief[maps.owner_of].astype(np.float64)
    unlike = ((belief[one][:, None] - belief[other][None]) ** 2).sum(axis=(-2, -1))
    first, second = np.unravel_index(np.argmax(unlike), unlike.shape)
    return int(one[first]), int(other[second])


def holders_picture(name: str, title: str, replay: Recording, maps: HoldersMaps) -> ReportFigure:
    """Draw the belief of two agents, then the age of their maps."""
    pair = pair_of(maps, replay.agent_collects)
    beliefs, ages = ([part[maps.owner_of[a]] for a in pair] for part in (maps.belief, maps.age))
    high, wide = replay.navigable.shape
    columns = 4 if high / wide > TALL else 2
    width = WIDE_IN / columns
    with house_style():
        height = (4 // columns) * (min(6.0, width * high / wide) + 0.3) + 0.95
        figure = canvas(WIDE_IN, height)
        panels = list(figure.subplots(4 // columns, columns, squeeze=False).flat)
        top = max(3, *(int(belief.max()) for belief in beliefs))
        for axes, agent, belief, letter in zip(panels[:2], pair, beliefs, "ab", strict=True):
            image = _belief(axes, replay, belief, top, maps.step)
            axes.set_title(f"({letter}) {maps.names[agent]} believes")
        _bar(figure, image, panels[:2], "items per node, as last seen")
        for axes, agent, age, letter in zip(panels[2:], pair, ages, "cd", strict=True):
            image = _age(axes, replay, age, max(1, maps.step))
            axes.set_title(f"({letter}) {maps.names[agent]}: age")
        _bar(figure, image, panels[2:], "age of the last look heard of  [decisions]")
        for axes, agent in zip(panels, (*pair, *pair), strict=True):
            frame_port(axes, replay.navigable)
            _vessels(axes, replay, maps, agent)
        _legend(figure)
    return ReportFigure(name, title, _words(replay, maps, pair, beliefs, ages), figure, wide=True)


def _words(
    replay: Recording,
    maps: HoldersMaps,
    pair: tuple[int, int],
    beliefs: list[NDArray[np.int16]],
    ages: list[NDArray[np.int32]],
) -> str:
    """What is shown, with numbers."""
    afloat, water = int(replay.item_present[maps.step].sum()), int(replay.navigable.sum())
    told = [
        f"{maps.names[agent]} believes in {int(belief.sum())} items and has heard of no look at "
        f"{100 * np.count_nonzero((age == UNSEEN) & replay.navigable) / water:.0f} % of the nodes"
        for agent, belief, age in zip(pair, beliefs, ages, strict=True)
    ]
    return (
        f"Episode {replay.episode} of {replay.policy} in the {replay.world} world after step "
        f"{maps.step}, played again: {afloat} items are afloat (dots); {told[0]}; {told[1]}. "
        "Filled: the vessel whose map it is; hollow: the others where it heard of them last, with "
        "a line to where they are."
    )
