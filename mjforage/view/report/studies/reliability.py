"""Reliability diagrams: how often what was forecast with a chance came true (Murphy 1973)."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import cycle

import numpy as np
from matplotlib.ticker import PercentFormatter
from numpy.typing import NDArray

from mjforage.view.page import style
from mjforage.view.page.figure import WIDTH_IN, ReportFigure, canvas, house_style

SHADES = ("#009E73", "#D55E00", "#0072B2", "#B5308A", "#5E5E5E")


@dataclass(frozen=True)
class Bins:
    """Forecasts of one kind, put together by their size. NaN in bins without any."""

    forecast: NDArray[np.float64]  # (bin,) mean of the chances forecast, in [0, 1]
    observed: NDArray[np.float64]  # (bin,) share of them that came true, in [0, 1]
    count: NDArray[np.int64]  # (bin,) how many


def reliability_picture(
    name: str, title: str, caption: str, kinds: Mapping[str, Bins]
) -> ReportFigure:
    """Draw observed share over forecast, and below it how many forecasts there were.

    Parameters
    ----------
    kinds : what the legend calls them -> their bins; after the fifth, colours come again
    """
    with house_style():
        figure = canvas(WIDTH_IN, 6.6)
        above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3.4, 1.0))
        above.axline((0.0, 0.0), slope=1.0, color=style.MUTED, linestyle="--", linewidth=1.0)
        looks = zip(cycle(SHADES), cycle(style.MARKERS), kinds.items(), strict=False)
        for colour, marker, (label, bins) in looks:
            held = bins.count > 0
            x, y, count = bins.forecast[held], bins.observed[held], bins.count[held]
            dots = {"color": colour, "marker": marker, "markersize": 5.5}
            above.plot(x, y, label=label, linewidth=1.5, **dots)
            below.plot(x, count, linewidth=1.2, **dots)
        above.set(xlim=(-0.03, 1.03), ylim=(-0.03, 1.03), ylabel="observed share of nodes  [%]")
        above.yaxis.set_major_formatter(PercentFormatter(1.0, symbol=""))
        below.xaxis.set_major_formatter(PercentFormatter(1.0, symbol=""))
        below.set(yscale="log", ylabel="forecasts")
        below.set_xlabel("forecast chance that a node holds an item  [%]")
        figure.legend(*above.get_legend_handles_labels(), loc="outside upper left", ncols=2)
    words = (
        f"{caption} On the dashed line forecasts come true as often as they say; below it the "
        "planner expects too much, above it too little. Below: how many forecasts a dot stands for."
    )
    return ReportFigure(name, title, words, figure)
