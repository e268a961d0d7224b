"""Figure of a manoeuvre: track, heading, speeds and commands, with the key figures below them."""

import math
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.physics.manoeuvre.key_figures import key_figures
from mjforage.physics.manoeuvre.trajectory import Trajectory, check_file
from mjforage.view.page import style
from mjforage.view.page.figure import WIDE_IN, house_style, literal

VESSELS = 9  # outlines along the track
LEAST_LENGTH = 0.04  # of a drawn vessel, in parts of the track's longer side
PICTURES = (".png", ".svg", ".pdf", ".jpg")
PORT, STARBOARD, VESSEL = "#B5308A", "#0072B2", "#D55E00"
FIGURES_A_ROW = 5  # key figures
ROW_IN = 0.52  # height of a row of key figures [inch]
NOTHING = 1e-5  # below this a key figure is 0


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
    figures = key_figures(trajectory)
    strip_in = ROW_IN * math.ceil(len(figures) / FIGURES_A_ROW)
    with house_style():
        figure = Figure(figsize=(WIDE_IN, 6.8 + strip_in), layout="constrained")
        FigureCanvasAgg(figure)
        grid = figure.add_gridspec(4, 2, height_ratios=(2.2, 2.2, 2.2, strip_in))
        _track(figure.add_subplot(grid[:3, 0]), trajectory)
        for row, draw in enumerate((_heading, _speeds, _commands)):
            draw(figure.add_subplot(grid[row, 1]), trajectory)
        figure.axes[-1].set_xlabel("time (s)")
        strip = figure.add_subplot(grid[3, :])
        strip.axis("off")
        for number, (name, one) in enumerate(figures.items()):
            row, column = divmod(number, FIGURES_A_ROW)
            place = column / FIGURES_A_ROW, 1.0 - row * ROW_IN / strip_in
            words = f"{name.replace('_', ' ')}\n{shown_value(one.value)} {one.unit}"
            strip.text(*place, words, transform=strip.transAxes, va="top", fontsize=10)
        figure.suptitle(f"{trajectory.vessel.name}: {trajectory.test}{_flows(trajectory)}")
    literal(figure)
    return figure


def shown_value(value: float) -> str:
    """Number with three digits, and 0 for rounding errors."""
    return f"{value:.3g}" if abs(value) >= NOTHING else "0"


def _flows(t: Trajectory) -> str:
    """Wind and current as they were asked for: speed, and direction that each flows to."""
    flows = {"wind": t.conditions.wind_mps, "current": t.conditions.current_mps}
    return "".join(
        f", {name} {math.hypot(x, y):.2g} m/s towards {math.degrees(math.atan2(y, x)):.0f} deg"
        for name, (x, y) in flows.items()
        if math.hypot(x, y) > 0.0
    )


def _track(axes: Axes, t: Trajectory) -> None:
    """The way over ground, with vessels large enough to be seen at even times."""
    axes.plot(t.states[:, 0], t.states[:, 1], color=style.INK)
    span = float(np.ptp(t.states[:, :2], axis=0).max())
    times = max(1, math.ceil(LEAST_LENGTH * span / t.vessel.length_m))
    length, beam = times * t.vessel.length_m, times * t.vessel.beam_m
    outline = np.array([[-0.5, -0.5], [0.25, -0.5], [0.5, 0.0], [0.25, 0.5], [-0.5, 0.5]])
    for row in np.linspace(0, len(t.states) - 1, VESSELS).astype(int):
        x, y, yaw = t.states[row, :3]
        c, s = math.cos(yaw), math.sin(yaw)
        corners = outline * (length, beam) @ np.array([[c, s], [-s, c]]) + (x, y)
        axes.fill(*corners.T, facecolor="none", edgecolor=VESSEL, lw=1.3, zorder=3)
    axes.set_aspect("equal", adjustable="datalim")
    scale = "at scale" if times == 1 else f"{times} x life size"
    axes.set(xlabel="x, east (m)", ylabel="y, north (m)", title=f"Track, vessels {scale}")


def wrapped(heading_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    """Headings (rows,) in degrees from -180 to 180, not a number where they jump to the other end.

    A line through them has a gap there.
    """
    degrees = (np.degrees(heading_rad) + 180.0) % 360.0 - 180.0
    jumps = np.flatnonzero(np.abs(np.diff(degrees)) > 180.0)
    degrees[jumps] = np.nan
    return np.asarray(degrees)


def _heading(axes: Axes, t: Trajectory) -> None:
    axes.plot(t.times_s, wrapped(t.states[:, 2]), color=style.INK)
    axes.set(ylabel="deg", title="Heading, counter-clockwise from east")


def _speeds(axes: Axes, t: Trajectory) -> None:
    surge, sway = t.through_water.T
    axes.plot(t.times_s, surge, color=style.INK, label="surge")
    axes.plot(t.times_s, sway, color=VESSEL, ls="--", label="sway, to port")
    axes.set(ylabel="m/s", title="Speed in the water")
    _legend(axes)


def _commands(axes: Axes, t: Trajectory) -> None:
    port, starboard = t.commands.T
    axes.step(t.times_s, port, where="post", color=PORT, ls="--", label="port")
    axes.step(t.times_s, starboard, where="post", color=STARBOARD, label="starboard")
    axes.set(ylabel=t.vessel.thruster.command_unit, title="Commands")
    _legend(axes)


def _legend(axes: Axes) -> None:
    """Above the axes, right of the title, where it hides no line."""
    axes.legend(ncols=2, loc="lower right", bbox_to_anchor=(1.0, 0.98), borderaxespad=0.0)
