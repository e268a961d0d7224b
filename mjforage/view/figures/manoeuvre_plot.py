"""Figure of a manoeuvre: track, heading, speeds and commands."""

import math
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from mjforage.base.errors import UserError
from mjforage.physics.manoeuvre.trajectory import Trajectory, check_file
from mjforage.view.page.figure import WIDE_IN, canvas, house_style, literal

PICTURES = (".png", ".svg", ".pdf", ".jpg")


def check_plot(path: Path) -> None:
    """Check before a run that its figure can be drawn into a file of that name.

    Raises `UserError` if no picture has that ending, or the file cannot be written.
    """
    if path.suffix.lower() not in PICTURES:
        raise UserError(f"--plot {path}: unknown kind of picture; give {', '.join(PICTURES)}")
    check_file(path, "--plot")


def manoeuvre_figure(trajectory: Trajectory) -> Figure:
    """Draw a trajectory; the caller writes it with `Figure.savefig`."""
    (surge, sway), (port, starboard) = trajectory.through_water.T, trajectory.commands.T
    x, y, yaw = trajectory.states[:, :3].T
    panels = (
        ("Heading, counter-clockwise from east", "deg", {"": np.degrees(yaw)}),
        ("Speed in the water", "m/s", {"surge": surge, "sway, to port": sway}),
        (
            "Commands",
            trajectory.vessel.thruster.command_unit,
            {"starboard": starboard, "port": port},
        ),
    )
    with house_style():
        figure = canvas(WIDE_IN, 6.8)
        grid = figure.add_gridspec(len(panels), 2)
        track = figure.add_subplot(grid[:, 0])
        track.plot(x, y)
        track.plot(x[:1], y[:1], "o")
        track.set_aspect("equal", adjustable="datalim")
        track.set(xlabel="x, east (m)", ylabel="y, north (m)", title="Track, from the dot on")
        for row, (title, unit, lines) in enumerate(panels):
            axes = figure.add_subplot(grid[row, 1])
            for name, values in lines.items():
                axes.plot(trajectory.times_s, values, label=name)
            axes.set(ylabel=unit, title=title)
            if len(lines) > 1:
                axes.legend(ncols=2, loc="lower right", bbox_to_anchor=(1.0, 0.98))
        axes.set_xlabel("time (s)")
        figure.suptitle(f"{trajectory.vessel.name}: {trajectory.test}{_flows(trajectory)}")
    literal(figure)
    return figure


def _flows(t: Trajectory) -> str:
    """Wind and current as they were asked for: speed, and direction that each flows to."""
    flows = {"wind": t.conditions.wind_mps, "current": t.conditions.current_mps}
    return "".join(
        f", {name} {math.hypot(x, y):.2g} m/s towards {math.degrees(math.atan2(y, x)):.0f} deg"
        for name, (x, y) in flows.items()
        if math.hypot(x, y) > 0.0
    )
