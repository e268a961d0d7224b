"""Figure of a manoeuvre: the main curve in large, the others beside it, key figures below."""

import math
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyArrowPatch
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.physics.manoeuvre.key_figures import KeyFigure, key_figures
from mjforage.physics.manoeuvre.standard import AHEAD_S, APPROACH_S
from mjforage.physics.manoeuvre.trajectory import Trajectory, check_file
from mjforage.view.page import style
from mjforage.view.page.figure import WIDE_IN, house_style, literal

HULLS = 12  # outlines along the track, at most
LARGER = (1, 2, 5, 10, 20, 50, 100)  # how much larger than life hulls are drawn
LEAST_HULL = 0.04  # of the track's longer side
APART = 1.2  # length of a drawn hull between two of them, at least
DRIFTS = 0.05  # of its diameter, from which on a turn's way over ground in a turn is no circle
ROOMY = 0.6  # of the track's longer side that a circle takes that has its diameter written inside
BEHIND_WORDS: dict[str, Any] = {
    "facecolor": "white", "alpha": 0.85, "edgecolor": "none", "pad": 1.0,
}  # fmt: skip
PICTURES = (".png", ".svg", ".pdf", ".jpg")
PORT, STARBOARD, HULL, SECOND = "#B5308A", "#0072B2", "#D55E00", "#D55E00"
WIND, CURRENT = "#5E5E5E", "#0072B2"
FIGURES_A_ROW, ROW_IN = 5, 0.52  # key figures in a row, and its height [inch]
NOTHING = 1e-5  # below this a key figure is 0
OVERSHOOTS = 2  # that are written at their peaks: the two that standards limit


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


Draw = Callable[[Axes, Trajectory], None]


def manoeuvre_figure(trajectory: Trajectory) -> Figure:
    """Draw a trajectory; the caller writes it with `Figure.savefig`.

    Large is what the test is about: heading and helm over time of a zigzag, speed over time of a
    run straight ahead, otherwise the track.
    """
    figures = key_figures(trajectory)
    large, small = _PANELS.get(trajectory.test, (_track, (_speeds, _heading, _commands)))
    rows = math.ceil(len(figures) / FIGURES_A_ROW)
    with house_style():
        strip_in = 0.2 + ROW_IN * rows
        figure = Figure(figsize=(WIDE_IN, 6.8 + strip_in), layout="constrained")
        FigureCanvasAgg(figure)
        halves = figure.add_gridspec(2, 1, height_ratios=(6.8, strip_in))
        above, below = (figure.add_subfigure(halves[row]) for row in (0, 1))
        grid = above.add_gridspec(len(small), 2, width_ratios=(1.15, 1.0))
        large(above.add_subplot(grid[:, 0]), trajectory)
        for row, draw in enumerate(small):
            axes = above.add_subplot(grid[row, 1])
            draw(axes, trajectory)
            if draw is not _track:
                axes.set_xlabel("time (s)" if row == len(small) - 1 else "")
        flows = trajectory.conditions.wind_mps, trajectory.conditions.current_mps
        _figures(below.add_axes((0.0, 0.0, 1.0, 1.0)), figures, flows)
        figure.suptitle(f"{trajectory.vessel.name}: {trajectory.test}", fontweight="bold")
    literal(figure)
    return figure


def _track(axes: Axes, t: Trajectory) -> None:
    x, y = t.states[:, 0], t.states[:, 1]
    times = _hulls_times_larger(t)
    axes.plot(x, y, color=style.INK, label="midships")
    for row in hull_rows(t.states[:, :2], APART * times * t.vessel.length_m):
        outline = _outline(t, row, times)
        axes.fill(*outline.T, facecolor="none", edgecolor=HULL, lw=1.3, zorder=3)
    _circle(axes, t)
    axes.set_aspect("equal", adjustable="datalim")
    scale = "at scale" if times == 1 else f"{times} x life size"
    axes.set(xlabel="x, east (m)", ylabel="y, north (m)", title=f"Track over ground, hulls {scale}")


def _hulls_times_larger(t: Trajectory) -> int:
    """Scale at which hulls are drawn: the least that makes them visible."""
    span = float(np.ptp(t.states[:, :2], axis=0).max())
    least = LEAST_HULL * span / t.vessel.length_m
    return next((times for times in LARGER if times >= least), LARGER[-1])


def hull_rows(places: NDArray[np.float64], apart_m: float) -> list[int]:
    """Rows of places (row, 2) at which hulls are drawn, `HULLS` at most: ends first, then between.

    All are further apart than `apart_m`, however often a track comes by the same place.
    """
    while True:
        rows = [0]
        for row in (len(places) - 1, *range(1, len(places) - 1)):
            if np.hypot(*(places[rows] - places[row]).T).min() > apart_m:
                rows.append(row)
            if len(rows) > HULLS:
                break
        if len(rows) <= HULLS:
            return sorted(rows)
        apart_m *= 1.15


def _outline(t: Trajectory, row: int, times: float) -> NDArray[np.float64]:
    """(corners, 2) of a pointed hull, so many times its true size."""
    half, side = 0.5 * times * t.vessel.length_m, 0.5 * times * t.vessel.beam_m
    body = np.array(
        [[-half, -side], [0.5 * half, -side], [half, 0.0], [0.5 * half, side], [-half, side]]
    )
    x, y, yaw = t.states[row, :3]
    c, s = math.cos(yaw), math.sin(yaw)
    return np.asarray(body @ np.array([[c, s], [-s, c]]) + (x, y))


def _circle(axes: Axes, t: Trajectory) -> None:
    """The diameter of the steady turn, where there was one: across the track, unless that drifts.

    A track that drifts over ground is no circle; the one in the water is dashed around its middle.
    """
    figures = key_figures(t)
    if "turning_diameter" not in figures:
        return
    diameter, rate = figures["turning_diameter"].value, figures["turning_rate"].value
    turn = t.states[np.abs(t.states[-1, 2] - t.states[:, 2]) <= 2.0 * math.pi, :2]
    middle, reach = 0.5 * (turn.min(axis=0) + turn.max(axis=0)), 0.5 * diameter
    drifts = figures["centre_drift"].value * 2.0 * math.pi / rate > DRIFTS * diameter
    words = f"diameter {diameter:.3g} m"
    if drifts:
        words += " in the water"
        dashed: dict[str, Any] = {"ls": "--", "lw": 1.5, "zorder": 4}
        axes.add_patch(Circle((middle[0], middle[1]), reach, fill=False, ec=CURRENT, **dashed))
    else:
        arrow = {"arrowstyle": "<->", "color": CURRENT, "lw": 1.5, "shrinkA": 0, "shrinkB": 0}
        ends = (middle[0] - reach, middle[1]), (middle[0] + reach, middle[1])
        axes.annotate("", *ends, arrowprops=arrow, zorder=4)
    low, high = t.states[:, :2].min(axis=0), t.states[:, :2].max(axis=0)
    if diameter > ROOMY * float((high - low).max()):
        place, side, align = (middle[0], middle[1]), (0.0, 5.0), "center"
    else:  # beside it, towards the middle of the panel
        sign = 1.0 if middle[0] <= 0.5 * (low[0] + high[0]) else -1.0
        place, side = (middle[0] + sign * reach, middle[1]), (8.0 * sign, 0.0)
        align = "left" if sign > 0.0 else "right"
    axes.annotate(
        words, place, side, textcoords="offset points", color=CURRENT, zorder=5,
        ha=align, va="center" if side[0] else "bottom", bbox=BEHIND_WORDS,
    )  # fmt: skip


def _speeds(axes: Axes, t: Trajectory) -> None:
    surge, sway = t.through_water.T
    axes.plot(t.times_s, surge, color=style.INK, label="surge")
    axes.plot(t.times_s, sway, color=SECOND, ls="--", label="sway, to port")
    axes.set(xlabel="time (s)", ylabel="m/s", title="Speed in the water")
    if t.test in ("straight", "stop") and t.times_s[-1] > AHEAD_S:
        word = "thrusters stopped" if t.test == "straight" else "full astern"
        _mark(axes, AHEAD_S, word)
    _legend(axes)


def _way(axes: Axes, t: Trajectory) -> None:
    """Way over ground; of a stop, since full astern."""
    way = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(t.states[:, :2], axis=0).T))))
    axes.plot(t.times_s, way, color=style.INK)
    axes.set(ylabel="m", title="Way over ground")
    if t.times_s[-1] > AHEAD_S:
        _mark(axes, AHEAD_S, "")


def _mark(axes: Axes, time_s: float, words: str) -> None:
    """Mark the time of an order."""
    axes.axvline(time_s, color=style.MUTED, lw=1.0, ls=":")
    top = axes.get_xaxis_transform()
    axes.text(time_s, 0.02, f" {words}", transform=top, color=style.MUTED, fontsize=10, va="bottom")


def wrapped(heading_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    """Headings (rows,) in degrees from -180 to 180, not a number where they jump to the other end.

    A line through them has a gap there.
    """
    degrees = (np.degrees(heading_rad) + 180.0) % 360.0 - 180.0
    jumps = np.flatnonzero(np.abs(np.diff(degrees)) > 180.0)
    degrees[jumps] = np.nan
    return np.asarray(degrees)


def _heading(axes: Axes, t: Trajectory) -> None:
    degrees = wrapped(t.states[:, 2])
    axes.plot(t.times_s, degrees, color=style.INK)
    axes.set(ylabel="deg", title="Heading, counter-clockwise from east")
    if np.nanmax(degrees) - np.nanmin(degrees) > 180.0:
        axes.set(ylim=(-190.0, 190.0), yticks=(-180, -90, 0, 90, 180))


def _yaw_rate(axes: Axes, t: Trajectory) -> None:
    axes.plot(t.times_s, np.degrees(t.states[:, 5]), color=style.INK)
    axes.set(ylabel="deg/s", title="Yaw rate, to port")


def _zigzag(axes: Axes, t: Trajectory) -> None:
    """Heading from the first execute on, and the helm that answers it: a zigzag as it is drawn."""
    angle = 20.0 if t.test == "zigzag-20" else 10.0
    start = float(np.interp(APPROACH_S, t.times_s, t.states[:, 2]))
    heading = np.degrees(t.states[:, 2] - start)
    unit = t.vessel.thruster.command_unit
    helm = t.commands[:, 1] - t.commands[:, 0]
    right = axes.twinx()
    right.step(t.times_s, helm, where="post", color=SECOND, lw=1.4, ls="--")
    most = 1.6 * max(float(np.abs(helm).max()), 1e-9)
    right.set(ylim=(-most, most))
    right.set_ylabel(f"helm: starboard minus port ({unit}), dashed", color=SECOND)
    right.grid(visible=False)
    axes.set_zorder(right.get_zorder() + 1)  # words over the helm
    axes.patch.set_visible(False)
    axes.plot(t.times_s, heading, color=style.INK, zorder=3)
    for side in (-angle, angle):
        axes.axhline(side, color=style.MUTED, lw=1.0, ls=":")
    after = t.times_s >= APPROACH_S
    _overshoots(axes, t.times_s[after], heading[after], angle)
    reach = 1.25 * max(float(np.abs(heading[after]).max(initial=0.0)), angle)
    axes.set(
        ylim=(-reach, reach),
        xlabel="time (s)",
        ylabel="heading, to port of that at the first helm (deg)",
    )
    axes.set_title(f"Heading and helm: reversed at ±{angle:g} deg")


def _overshoots(
    axes: Axes, times: NDArray[np.float64], heading: NDArray[np.float64], angle: float
) -> None:
    """Write the overshoot of every swing beyond the angle at its peak."""
    edges = np.concatenate(([0], np.flatnonzero(heading[1:] * heading[:-1] < 0.0) + 1))
    swings = (slice(*pair) for pair in pairwise(edges.tolist()))
    peaks = [swing.start + int(np.abs(heading[swing]).argmax()) for swing in swings]
    for peak in [p for p in peaks if abs(heading[p]) >= angle][:OVERSHOOTS]:
        up = heading[peak] > 0.0
        axes.annotate(
            f"+{abs(heading[peak]) - angle:.1f}°",
            (times[peak], heading[peak]),
            xytext=(0, 4 if up else -4),
            textcoords="offset points",
            ha="center",
            va="bottom" if up else "top",
            fontsize=10,
            bbox=BEHIND_WORDS,
        )


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
    axes.legend(
        ncols=2, loc="lower right", bbox_to_anchor=(1.0, 0.98), borderaxespad=0.0,
        handlelength=1.3, columnspacing=1.2,
    )  # fmt: skip


def _figures(
    axes: Axes, figures: dict[str, KeyFigure], flows: tuple[tuple[float, float], ...]
) -> None:
    """Wind and current as arrows, north up, and the key figures in rows beside them."""
    axes.axis("off")
    rows = math.ceil(len(figures) / FIGURES_A_ROW)
    height = 0.2 + ROW_IN * rows
    axes.set(xlim=(0.0, WIDE_IN), ylim=(0.0, height))  # inches
    left, middle = 0.3, 0.2 + 0.5 * ROW_IN * rows
    for name, colour, flow in zip(("wind", "current"), (WIND, CURRENT), flows, strict=True):
        speed = math.hypot(*flow)
        if speed > 0.0:
            _arrow(axes, left + 0.3, middle, flow, colour)
            words = f"{name}\n{speed:.2g} m/s"
            axes.text(left + 0.7, middle, words, color=colour, va="center")
            left += 1.7
    wide = (WIDE_IN - 0.1 - left) / FIGURES_A_ROW
    for number, (name, figure) in enumerate(figures.items()):
        x, top = left + number % FIGURES_A_ROW * wide, height - number // FIGURES_A_ROW * ROW_IN
        axes.text(x, top, name.replace("_", " "), color=style.MUTED, va="top", fontsize=10)
        words = f"{shown_value(figure.value)} {figure.unit}"
        axes.text(x, top - 0.2, words, va="top", fontweight="bold")


def shown_value(value: float) -> str:
    """Number with three digits, and 0 for rounding errors."""
    return f"{value:.3g}" if abs(value) >= NOTHING else "0"


def _arrow(axes: Axes, x: float, y: float, flow: tuple[float, float], colour: str) -> None:
    """An arrow of fixed length on the screen, the way a flow goes."""
    along = 0.25 * np.array(flow) / math.hypot(*flow)  # [inch]
    ends = (x - along[0], y - along[1]), (x + along[0], y + along[1])
    look: dict[str, Any] = {"arrowstyle": "-|>", "mutation_scale": 14.0, "lw": 2.0}
    axes.add_patch(FancyArrowPatch(*ends, color=colour, clip_on=False, **look))


_ALONG: tuple[Draw, tuple[Draw, ...]] = (_speeds, (_way, _track, _commands))
_PANELS: dict[str, tuple[Draw, tuple[Draw, ...]]] = {
    "zigzag": (_zigzag, (_track, _yaw_rate, _speeds)),
    "zigzag-20": (_zigzag, (_track, _yaw_rate, _speeds)),
    "straight": _ALONG,
    "stop": _ALONG,
    "drift": (_track, (_speeds, _heading)),
}
"""The large panel of a test and the small ones beside it; others show the track."""
