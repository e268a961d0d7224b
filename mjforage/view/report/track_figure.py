"""Figure of the fleet's tracks: one episode per policy and world, from `agents.parquet`."""

import math
from typing import Any

import numpy as np
import polars as pl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from mjforage.view.page import style
from mjforage.view.page.figure import WIDE_IN, WIDTH_IN, ReportFigure, canvas
from mjforage.view.report.map_figures import ENDS, draw_port, draw_track
from mjforage.view.report.run_logs import TRACK_STEPS, Case, RunLogs

SPREAD = 0.34  # node; tracks over the same nodes are drawn side by side within this width
LEGEND_AGENTS = 10  # more agents than this are named by team only


def _draw(axes: Axes, case: Case) -> None:
    logs, port, collects = case.logs, case.logs.run.map, case.logs.collects()
    rows = case.select(logs.tracks).sort("agent", "step")
    spread = SPREAD / 2 if case.world == "graph" else 0.0  # hulls keep apart by themselves
    offsets = np.linspace(-spread, spread, max(2, len(collects)))
    draw_port(axes, port.cells)
    for agent, colour in enumerate(style.agent_colours(map(style.role, collects))):
        xy = rows.filter(agent=agent).select("x_m", "y_m").to_numpy() / port.pitch_m
        if len(xy):
            track = np.column_stack((port.rows - 1 - xy[:, 1], xy[:, 0]))
            track += offsets[agent]
            begin: dict[str, Any] = {"color": "white", "markeredgecolor": colour}
            axes.plot(track[0, 1], track[0, 0], "o", markersize=4.5, **begin)
            draw_track(axes, track, colour, collects[agent])
    world = f" · {case.world}" if len(logs.run.worlds) > 1 else ""
    axes.set_title(f"{case.policy}{world}")


def _legend(figure: Figure, logs: RunLogs) -> None:
    names = {i: agent.name for i, agent in enumerate(logs.run.agents)}
    if len(names) > LEGEND_AGENTS:
        first = {agent.team: i for i, agent in reversed(list(enumerate(logs.run.agents)))}
        names = {i: team for team, i in first.items()}
    colours = style.agent_colours(map(style.role, logs.collects()))
    handles = [Line2D([], [], color=colours[i], label=name) for i, name in names.items()]
    mark: dict[str, Any] = {"linestyle": "", "markersize": 5.5, "markeredgecolor": style.MUTED}
    handles.append(Line2D([], [], marker="o", color="white", label="start", **mark))
    for role, collects in (("scout", False), ("forager", True)):
        if collects in logs.collects():
            label = f"end, {role}"
            handles.append(
                Line2D([], [], marker=ENDS[collects], color=style.MUTED, label=label, **mark)
            )
    longest = max(len(str(handle.get_label())) for handle in handles)
    columns = max(1, min(len(handles), int(figure.get_figwidth() / (0.6 + 0.09 * longest))))
    figure.legend(handles=handles, loc="outside lower left", ncols=columns)


def _panels(logs: RunLogs) -> tuple[Figure, list[Axes]]:
    """Figure with a panel per world and policy; rows are worlds where the policies fit in one."""
    height, width = logs.run.map.cells.shape
    tall = height / width
    wanted = 5 if tall > 1 else 3 if tall > 0.6 else 2
    by_world = len(logs.run.worlds) > 1 and 1 < len(logs.policies) <= wanted
    columns = len(logs.policies) if by_world else min(wanted, len(logs.cases))
    rows = math.ceil(len(logs.cases) / columns)
    columns = math.ceil(len(logs.cases) / rows)
    panel_in = WIDE_IN / min(wanted, max(3, columns))
    height_in = rows * (min(8.0, max(1.5, panel_in * tall)) + 0.35) + 0.5
    figure = canvas(max(WIDTH_IN, columns * panel_in), height_in)
    panels = list(figure.subplots(rows, columns, squeeze=False).flat)
    for axes in panels[len(logs.cases) :]:
        axes.set_visible(False)
    return figure, panels[: len(logs.cases)]


def tracks_figure(logs: RunLogs) -> ReportFigure:
    """Draw the tracks of the lowest episode, a panel per policy and world."""
    figure, panels = _panels(logs)
    for axes, case in zip(panels, logs.cases, strict=True):
        _draw(axes, case)
    words = "No vessel took part."
    if logs.run.agents:
        _legend(figure, logs)
        lowest = logs.tracks.select(pl.col("episode").min()).item()
        words = (
            f"Tracks of episode {lowest}, the same items and starts for every policy and world. At "
            "graph level, tracks over the same nodes are drawn side by side; elsewhere they join "
            "the positions of midships after each decision. An episode ends once no item is left."
        )
        if logs.run.horizon > TRACK_STEPS:
            words += f" Drawn are the first {TRACK_STEPS} steps."
    return ReportFigure("tracks", "Tracks of the fleet", words, figure, wide=True)
