"""Figures of the board: performance profiles, and quality against the time of a decision."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter

from mjforage.metrics import pareto_front, performance_profile
from mjforage.mission.scoring import Description, describe
from mjforage.view.page import style
from mjforage.view.page.figure import WIDE_IN, ReportFigure, canvas, house_style, joined
from mjforage.view.report.curves import axis_label
from mjforage.view.report.differences import SEED
from mjforage.view.report.run_logs import FloatArray
from mjforage.view.report.studies.board_scores import SCORES, Board, Standing

COLUMNS = 3  # panels beside one another
THRESHOLDS = 101
TAIL = 0.1  # of the runs, the worst, that lie beyond the axis of thresholds
MARKS = 5  # on a line
SHOWN = ("pta_c", "nt90")  # scores of the frontier, beside the normalised one


def _legend(figure: Figure, board: Board) -> None:
    """All policies in one block above the panels."""
    looks = style.policy_styles(board.policies)
    handles = [
        Line2D(
            [], [], color=look.colour, marker=look.marker, markersize=5.5, label=board.head(name)
        )
        for name, look in looks.items()
    ]
    figure.legend(
        handles=handles, loc="outside upper left", ncols=7, columnspacing=1.3, handlelength=1.8
    )


def _pooled(board: Board, policy: str, score: str) -> tuple[FloatArray, FloatArray]:
    """(run,) a score in every run of the tasks that all play, and the number of its task."""
    found = [board.case(task, policy).values(score) for task in board.shared]
    labels = [np.full(len(one), place, float) for place, one in enumerate(found)]
    return np.concatenate(found), np.concatenate(labels)


def _thresholds(runs: Sequence[FloatArray], better: int) -> FloatArray:
    """(threshold,) upwards over all runs that have a value, but for the tail of the worst."""
    known = np.concatenate(runs)
    low, high = np.nanquantile(known, [TAIL, 1.0] if better > 0 else [0.0, 1 - TAIL])
    aside = 0.0 if high > low else 0.5
    return np.linspace(low - aside, high + aside, THRESHOLDS)


def _profiles(axes: Axes, board: Board, metric: Description) -> None:
    playing = [one for one in board.policies if all(one in board.players(c) for c in board.shared)]
    runs = {policy: _pooled(board, policy, metric.key) for policy in playing}
    axes.set_ylim(-0.02, 1.02)
    axes.set_xlabel(f"{axis_label(metric)} {'≥' if metric.better > 0 else '≤'} τ")
    if all(np.isnan(values).all() for values, _ in runs.values()):
        return
    tau = _thresholds([values for values, _ in runs.values()], metric.better)
    for number, (policy, look) in enumerate(style.policy_styles(playing).items()):
        values, tasks = runs[policy]
        found = performance_profile(values, tau, metric.better, SEED, strata=tasks)
        axes.fill_between(tau, found.low, found.high, color=look.colour, alpha=0.12, linewidth=0)
        stride = THRESHOLDS // MARKS
        places = (number * stride // len(playing), stride)
        line: dict[str, Any] = {"marker": look.marker, "markersize": 4.5, "markevery": places}
        axes.plot(tau, found.value, color=look.colour, linewidth=1.5, **line)
    axes.set_xlim(tau[0], tau[-1])


def profiles_picture(board: Board) -> ReportFigure | None:
    """A panel per score, a line per policy; None where no task is played by all."""
    if not board.shared:
        return None
    lines = -(-len(SCORES) // COLUMNS)
    with house_style():
        figure = canvas(WIDE_IN, 0.9 + 2.9 * lines)
        grid = figure.subplots(lines, COLUMNS, sharey=True, squeeze=False)
        for axes, metric in zip(grid.flat, board.metrics, strict=True):
            _profiles(axes, board, metric)
        for axes in grid[:, 0]:
            axes.set_ylabel("share of runs")
        _legend(figure, board)
    caption = (
        "Share of the runs (every episode of the tasks that all policies play) whose score is "
        "at least as good as τ; a line that lies above another is better at that τ. Bands: "
        "pointwise bootstrap 95 % intervals, episodes resampled within tasks (Agarwal et al., "
        "NeurIPS 2021). A run without a score counts as worse than every τ. The axes leave out "
        f"the worst {100 * TAIL:g} % of all runs."
    )
    return ReportFigure("profiles", "Performance profiles", caption, figure, wide=True)


def _frontier(axes: Axes, standing: Standing, key: str) -> list[str]:
    """Draw a panel of a score, or of all for ""; return its front, the cheapest first."""
    board = standing.board
    cost = np.array([board.mean_decision(policy).ms for policy in board.policies])
    quality = standing.raw[:, SCORES.index(key)] if key else standing.overall
    found = [standing.number(row) for row in quality]
    better = describe(key).better if key else 1
    worth = better * np.array([one.value for one in found])
    competing = np.array([policy in board.ranked for policy in board.policies])
    front = np.zeros(len(cost), np.bool_)
    front[competing] = pareto_front(cost[competing], worth[competing])
    order = [place for place in np.argsort(cost) if front[place]]
    heights = [found[place].value for place in order]
    dashes: dict[str, Any] = {"color": style.MUTED, "linestyle": "--", "linewidth": 1.0}
    axes.step(cost[order], heights, where="post", zorder=1, **dashes)
    for place, look in enumerate(style.policy_styles(board.policies).values()):
        one, at = found[place], cost[place]
        if np.isnan([at, one.value]).any():
            continue
        axes.plot([at] * 2, [one.low, one.high], color=look.colour, linewidth=1.4)
        face = look.colour if competing[place] else "white"
        axes.plot(at, one.value, **look.dots, markerfacecolor=face, markersize=7, zorder=3)
        if front[place]:
            ring: dict[str, Any] = {"markerfacecolor": "none", "markeredgecolor": style.INK}
            axes.plot(at, one.value, "o", markersize=13, zorder=2, **ring)
    axes.set_xscale("log")
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.set_xlabel("CPU time of a fleet decision  [ms]")
    axes.set_ylabel(axis_label(describe(key)) if key else "normalised score")
    if better < 0:
        axes.invert_yaxis()
    return [board.policies[place] for place in order]


def frontier_picture(standing: Standing) -> ReportFigure | None:
    """Quality against the time of a decision; None where none was measured."""
    board = standing.board
    if not any(np.isfinite(board.mean_decision(policy).ms) for policy in board.ranked):
        return None
    keys = ("", *SHOWN) if standing.used else SHOWN
    with house_style():
        figure = canvas(WIDE_IN, 4.3)
        grid = figure.subplots(1, len(keys), squeeze=False)[0]
        fronts = {key: _frontier(axes, standing, key) for axes, key in zip(grid, keys, strict=True)}
        _legend(figure, board)
    named = "; ".join(
        f"{describe(key).label if key else 'normalised score'}: {joined(front)}"
        for key, front in fronts.items()
    )
    caption = (
        "Means over the tasks that all policies play, of the time the geometric mean; up is "
        "better in every panel. Bars: bootstrap 95 % intervals, episodes resampled within tasks. "
        "Ringed and joined: the Pareto front, those that no policy beats in both; bounds (hollow) "
        f"aside. On it, the fastest first: {named}."
    )
    return ReportFigure(
        "frontier", "Quality against the time of a decision", caption, figure, wide=True
    )
