"""A finding's curves as one figure in the house style."""

import math
from typing import Any

from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from mjforage.physics.validation.finding import Finding, Line, Panel
from mjforage.view.page import style
from mjforage.view.page.picture import WIDE_IN, WIDTH_IN, Picture, canvas, house_style

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#B5308A", "#7A6A00")
MARKERS = ("o", "s", "^", "D", "v")
DASHES = ((4.0, 2.0), (1.2, 1.8), (6.0, 2.0, 1.2, 2.0))  # of expected lines that are told apart
MARKS = 9  # along a measured line, where there are several
BAND = "#BFE3D0"  # of published ranges
BAND_HALF = 0.28  # half width of one
HEIGHT_IN = 3.7


def draw(finding: Finding) -> Picture:
    """Draw all panels of a finding side by side."""
    panels = finding.panels
    with house_style():
        wide = len(panels) > 1
        figure = canvas(WIDE_IN if wide else WIDTH_IN, HEIGHT_IN)
        row = figure.subplots(1, len(panels), squeeze=False)[0]
        for axes, panel in zip(row, panels, strict=True):
            _panel(axes, panel)
    return Picture(finding.name, finding.title, finding.shows, figure, wide=wide)


def _panel(axes: Axes, panel: Panel) -> None:
    for span in panel.spans:
        left, right = span.x - BAND_HALF, span.x + BAND_HALF
        axes.fill_between([left, right], span.low, span.high, color=BAND, linewidth=1.5)
    expected = list(dict.fromkeys(line.label for line in panel.lines if line.expected))
    named = [label for label in expected if label]
    several = len({line.colour for line in panel.lines if not line.expected}) > 1
    for line in panel.lines:
        if line.expected:
            _expected(axes, line, expected.index(line.label), alone=len(named) < 2)
        else:
            _measured(axes, line, marked=several)
    axes.set(xlabel=panel.x_label, ylabel=panel.y_label, title=panel.title)
    if panel.log_x:
        axes.set_xscale("log")
    if panel.log_y:
        axes.set_yscale("log")
    else:
        axes.yaxis.set_major_locator(MaxNLocator(6))
    if panel.equal:
        axes.set_aspect("equal", adjustable="datalim")
    if panel.x_names:
        axes.set_xticks(range(len(panel.x_names)), panel.x_names)
        axes.set_ylim(bottom=0.0)
    _legend(axes, panel)


def _expected(axes: Axes, line: Line, number: int, *, alone: bool) -> None:
    """Dashed: in ink if alone, else each in the colour of what it belongs to, dashes of its own."""
    colour = style.INK if alone else COLOURS[line.colour % len(COLOURS)]
    dashes = (0.0, DASHES[0 if alone else number % len(DASHES)])
    axes.plot(line.x, line.y, color=colour, linestyle=dashes, linewidth=1.5, zorder=4)


def _measured(axes: Axes, line: Line, *, marked: bool) -> None:
    place = line.colour % len(COLOURS)
    look: dict[str, Any] = {"color": COLOURS[place], "linestyle": "" if line.points else "-"}
    if line.points or marked:
        look |= {"marker": MARKERS[place], "markersize": 4.5 if line.points else 3.8}
    if not line.points:
        look["markevery"] = max(1, len(line.x) // MARKS)
    axes.plot(line.x, line.y, **look)


def _legend(axes: Axes, panel: Panel) -> None:
    """Each label once, below the axes, where it hides nothing."""
    handles: dict[str, Line2D] = {}
    for line, drawn in zip(panel.lines, axes.lines, strict=True):
        if line.label:
            handles.setdefault(line.label, drawn)
    named = [(drawn, label) for label, drawn in handles.items()]
    if panel.span_label:
        named.append((Line2D([], [], color=BAND, linewidth=8.0), panel.span_label))
    if len(named) < 2:
        return
    longest = max(len(label) for _, label in named)
    columns = min(len(named), max(1, int(WIDTH_IN / (0.55 + 0.09 * longest))))
    columns = math.ceil(len(named) / math.ceil(len(named) / columns))  # rows of like length
    axes.legend(
        *zip(*named, strict=True),
        ncols=columns,
        loc="upper center",
        bbox_to_anchor=(0.5, -0.2),
        borderaxespad=0.0,
        handlelength=2.4,
        columnspacing=1.4,
    )
