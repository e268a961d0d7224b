"""One figure of a manoeuvre: track with hulls, speeds, heading and yaw rate, commands."""

import math
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from mjforage.core.errors import UserError
from mjforage.physics.manoeuvre.trajectory import Trajectory, check_file
from mjforage.view.page import style
from mjforage.view.page.picture import house_style

HULLS = 12  # outlines along the track
PICTURES = (".png", ".svg", ".pdf", ".jpg")
PORT, STARBOARD = "#C2255C", "#0072B2"


def check_plot(path: Path) -> None:
    """Check before a run that its figure can be drawn into a file of that name.

    Raises
    ------
    UserError
        If no picture has that ending, or the file cannot be written.
    """
    if path.suffix.lower() not in PICTURES:
        raise UserError(f"--plot {path}: unknown kind of picture; give {', '.join(PICTURES)}")
    check_file(path, "--plot")


def manoeuvre_figure(trajectory: Trajectory) -> Figure:
    """Draw a trajectory; the caller writes it with `Figure.savefig`."""
    with house_style():
        figure = Figure(figsize=(11.2, 7.0), layout="constrained")
        FigureCanvasAgg(figure)
        grid = figure.add_gridspec(3, 2)
        _track(figure.add_subplot(grid[:, 0]), trajectory)
        _speeds(figure.add_subplot(grid[0, 1]), trajectory)
        _heading(figure.add_subplot(grid[1, 1]), trajectory)
        _commands(figure.add_subplot(grid[2, 1]), trajectory)
        figure.suptitle(f"{trajectory.vessel.name}: {trajectory.test}", fontweight="bold")
    return figure


def _track(axes: Axes, t: Trajectory) -> None:
    axes.plot(t.states[:, 0], t.states[:, 1], color=style.INK)
    for row in np.linspace(0, t.times_s.size - 1, HULLS).astype(int):
        axes.fill(*_outline(t, int(row)).T, facecolor="none", edgecolor=style.SCOUT, lw=1.2)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel="x, east (m)", ylabel="y, north (m)", title="Track over ground")


def _outline(t: Trajectory, row: int) -> NDArray[np.float64]:
    """(corners, 2) of a pointed hull in true size."""
    half, side = 0.5 * t.vessel.length_m, 0.5 * t.vessel.beam_m
    body = np.array(
        [[-half, -side], [0.5 * half, -side], [half, 0.0], [0.5 * half, side], [-half, side]]
    )
    x, y, yaw = t.states[row, :3]
    c, s = math.cos(yaw), math.sin(yaw)
    return np.asarray(body @ np.array([[c, s], [-s, c]]) + (x, y))


def _speeds(axes: Axes, t: Trajectory) -> None:
    axes.plot(t.times_s, t.states[:, 3], color=style.INK, label="surge")
    axes.plot(t.times_s, t.states[:, 4], color=style.FORAGER, ls="--", label="sway, to port")
    axes.set(ylabel="m/s", title="Velocity over ground")
    _legend(axes)


def _heading(axes: Axes, t: Trajectory) -> None:
    axes.plot(t.times_s, np.degrees(t.states[:, 2]), color=style.INK, label="heading (deg)")
    right = axes.twinx()
    right.grid(visible=False)
    right.plot(t.times_s, np.degrees(t.states[:, 5]), color=style.SCOUT, ls="--")
    right.set_ylabel("yaw rate (deg/s), dashed", color=style.SCOUT)
    axes.set(ylabel="heading (deg)", title="Heading and yaw rate, counter-clockwise")


def _commands(axes: Axes, t: Trajectory) -> None:
    unit = t.vessel.thruster.command_unit
    for i, (name, colour) in enumerate((("port", PORT), ("starboard", STARBOARD))):
        axes.step(
            t.times_s, t.commands[:, i], where="post", color=colour, ls="-" if i else "--",
            label=name,
        )  # fmt: skip
    axes.set(xlabel="time (s)", ylabel=unit, title="Commands")
    _legend(axes)


def _legend(axes: Axes) -> None:
    """Above the axes, right of the title, where it hides no line."""
    axes.legend(ncols=2, loc="lower right", bbox_to_anchor=(1.0, 0.98), borderaxespad=0.0)
