"""The pictures of `metrics.md`, from small made-up missions and the functions of `metrics`.

python docs/concepts/metric_pictures.py [FOLDER]  writes an SVG per group, by default beside this.
"""

import io
import re
import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from mjforage import metrics

HORIZON, ITEMS = 100, 24
SCOUT, FORAGER, MUTED, INK, BELIEF = "#B35900", "#C2255C", "#66727F", "#1F2933", "#3B1F8F"
Array = NDArray[np.float64]


def mission() -> metrics.EventTable:
    """A made-up episode: scouts 0 and 1, foragers 2 and 3; one item is never found."""
    rng = np.random.default_rng(3)
    found = np.concatenate([rng.integers(5, 30, 15), rng.integers(45, 70, 9)]).astype(float)
    found.sort()
    taken = np.minimum(found + rng.integers(6, 30, ITEMS), HORIZON - 3.0)
    finder = rng.integers(0, 2, ITEMS)
    finder[[4, 11, 17]] = 2
    taken[[4, 11, 17]] = found[[4, 11, 17]]
    taker = rng.choice([2, 2, 3], ITEMS)
    taker[[4, 11, 17]] = 2
    found[-1], taken[-1], finder[-1], taker[-1] = np.nan, np.nan, -1, -1
    return metrics.EventTable(found, finder, taken, taker, np.ones(ITEMS, np.bool_))


EVENTS = mission()
PTA_D = metrics.pta_series(EVENTS.discovered_at, EVENTS.exists, HORIZON)
PTA_C = metrics.pta_series(EVENTS.collected_at, EVENTS.exists, HORIZON)
STEPS = np.arange(HORIZON + 1)


def figure(columns: int = 1, width: float = 6.4, height: float = 2.5) -> tuple[Figure, list[Axes]]:
    """An empty figure of some panels side by side."""
    made = Figure(figsize=(width, height), layout="constrained")
    axes = np.atleast_1d(made.subplots(1, columns)).tolist()
    for one in axes:
        one.spines[["top", "right"]].set_visible(False)
    return made, axes


def note(axes: Axes, text: str, at: tuple[float, float], colour: str = INK, **more: object) -> None:
    """Words in a panel, at data coordinates."""
    axes.text(*at, text, color=colour, fontsize=9, **more)  # type: ignore[arg-type]


def arrow(axes: Axes, start: tuple[float, float], end: tuple[float, float], colour: str) -> None:
    """An arrow with two heads."""
    style = {"arrowstyle": "<->", "color": colour, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", end, start, arrowprops=style)


def progress() -> Figure:
    """PTA, NT and length."""
    made, (axes,) = figure()
    axes.step(STEPS, PTA_D, where="post", color=SCOUT)
    axes.step(STEPS, PTA_C, where="post", color=FORAGER)
    for share in (50.0, 90.0):
        at = float(metrics.nt(PTA_C, share)) * HORIZON
        axes.plot([0, at, at], [share, share, 0], color=MUTED, lw=0.8, ls="--")
        note(axes, f"NT$_{{{share:.0f}}}$ = {at / HORIZON:.2f}", (at + 1, 4))
    note(axes, f"PTA$_D$ = {PTA_D[-1]:.1f} %", (38, 97), SCOUT)
    note(axes, f"PTA$_C$ = {PTA_C[-1]:.1f} %", (86, 84), FORAGER)
    axes.set(xlabel="step", ylabel="% of the items", ylim=(0, 108), xlim=(0, HORIZON))
    return made


def lag() -> Figure:
    """ITL by rises and by levels."""
    made, axes = figure(2, 7.2)
    rises = [np.diff(series) for series in (PTA_D, PTA_C)]
    for rise, colour, sign in zip(rises, (SCOUT, FORAGER), (1, -1), strict=True):
        axes[0].bar(STEPS[1:], sign * rise, color=colour, width=1.0)
    first, second = (int(np.argmax(rise > rise.max() - 1e-6)) + 1 for rise in rises)
    arrow(axes[0], (first, 0.0), (second, 0.0), INK)
    itl = float(metrics.itl(PTA_D, PTA_C))
    axes[0].set(title=f"ITL = {itl:.2f}", xlabel="step", ylabel="rise of PTA$_C$, PTA$_D$ [%]")
    for series, colour in ((PTA_D, SCOUT), (PTA_C, FORAGER)):
        axes[1].step(STEPS, series, where="post", color=colour)
        axes[1].plot(int(series.argmax()), series.max(), "o", color=colour)
    arrow(axes[1], (int(PTA_D.argmax()), 102), (int(PTA_C.argmax()), 102), INK)
    level = float(metrics.itl_level(PTA_D, PTA_C))
    axes[1].set(title=f"ITL_level = {level:.2f}", xlabel="step", ylabel="PTA [%]", ylim=(0, 108))
    return made


def service() -> Figure:
    """DSL, CSR and handover: an item is a line from discovery to removal."""
    made, (axes,) = figure(height=2.9)
    scouts = np.isin(EVENTS.discovered_by, [0, 1])
    heard = EVENTS.discovered_at + (EVENTS.collected_at - EVENTS.discovered_at) // 3
    for k in np.flatnonzero(~np.isnan(EVENTS.collected_at)):
        colour = SCOUT if scouts[k] else FORAGER
        axes.plot([EVENTS.discovered_at[k], EVENTS.collected_at[k]], [k, k], color=colour)
        axes.plot(EVENTS.discovered_at[k], k, "o", ms=4, color=colour)
        axes.plot(EVENTS.collected_at[k], k, "s", ms=4, color=FORAGER)
        if scouts[k]:
            axes.plot(heard[k], k, "|", ms=8, color=INK)
    dsl = float(metrics.mean_dsl(EVENTS, [0, 1], HORIZON))
    csr = float(metrics.csr_series(EVENTS, [0, 1], HORIZON)[-1])
    told = float(metrics.handover(EVENTS.discovered_at, heard, HORIZON))
    latency = f"DSL = {dsl:.3f}: mean length of the lines\nof items that a scout found, over T"
    rest = (
        f"CSR = {csr:.2f}: lines that begin with a scout's dot\nHandover = {told:.3f}: dot to tick"
    )
    note(axes, latency, (2, 19))
    note(axes, rest, (56, 1))
    axes.set(xlabel="step (dot: discovered, tick: a forager hears of it, square: removed)")
    axes.set(ylabel="item", xlim=(0, HORIZON), yticks=[])
    return made


def error() -> Figure:
    """RMSE over nodes and by columns."""
    navigable = np.ones((14, 18), np.bool_)
    navigable[5:9, 8:] = False
    truth, belief = np.zeros((2, *navigable.shape), np.int16)
    for row, column, count in ((2, 4, 3), (3, 12, 2), (11, 5, 4), (11, 13, 2), (2, 15, 1)):
        truth[row, column] = count
    for row, column, count in ((2, 5, 3), (3, 12, 2), (11, 5, 2), (10, 13, 2)):
        belief[row, column] = count
    rmse, columns = metrics.model_error(truth[navigable], belief[navigable], navigable)
    made, axes = figure(3, 7.4, 2.6)
    away = np.where(navigable, truth - belief, 0)
    smooth = sum(
        away[r, c] * np.exp(-0.5 * ((np.arange(14) - r)[:, None] ** 2 + (np.arange(18) - c) ** 2))
        for r, c in np.argwhere(away)
    ) / (2 * np.pi)
    panels = (("items", truth, "Oranges"), ("believed", belief, "Purples"))
    for one, (title, values, colours) in zip(axes, panels, strict=False):
        one.imshow(np.where(navigable, values, np.nan), cmap=colours, vmin=0, vmax=4)
        one.set_title(title, fontsize=10)
    axes[2].imshow(np.where(navigable, smooth, np.nan), cmap="PuOr_r", vmin=-0.5, vmax=0.5)
    words = f"smoothed difference\nRMSE {rmse:.3f}, by columns {columns:.3f}"
    axes[2].set_title(words, fontsize=10)
    for one in axes:
        one.set(xticks=[], yticks=[], facecolor="#B9AB94")
    return made


def idleness() -> Figure:
    """Idleness of a node, and the mean over nodes."""
    made, axes = figure(2, 7.2)
    looks = [-1000, 12, 15, 60]
    last = np.array([max(look for look in looks if look <= t) for t in STEPS])
    axes[0].plot(STEPS, np.minimum(1.0, (STEPS - last) / (0.9 * HORIZON)), color=BELIEF)
    axes[0].plot(looks[1:], [0, 0, 0], "^", color=SCOUT, clip_on=False)
    axes[0].set(title="idleness of a node (looked at ▲)", xlabel="step", ylim=(0, 1.05))
    series = 0.35 + 0.63 * np.exp(-STEPS / 30.0) + 0.02 * np.sin(STEPS / 4.0)
    axes[1].plot(STEPS, series, color=BELIEF)
    axes[1].axhline(series.mean(), color=MUTED, lw=0.8, ls="--")
    axes[1].plot([0, HORIZON], series[[0, -1]], color=FORAGER, lw=0.8)
    slope = float(metrics.irr(series).mean())
    note(axes[1], f"MI$_{{mean}}$ = {series.mean():.2f}", (74, series.mean() + 0.03), MUTED)
    note(axes[1], f"MI$_{{final}}$ = {series[-1]:.2f}", (62, series[-1] - 0.14), BELIEF)
    note(axes[1], f"IRR$_{{mean}}$ = {slope:.4f}: fall of this line", (22, 0.92), FORAGER)
    axes[1].set(title="mean over the nodes", xlabel="step", ylim=(0, 1.05))
    return made


def sharing() -> Figure:
    """Gini of contributions, and overlap of views."""
    made, axes = figure(3, 7.4, 2.5)
    for one, shares in zip(axes, ([12, 12, 12], [28, 6, 2]), strict=False):
        one.bar(range(3), shares, color=FORAGER)
        one.set(title=f"Gini = {float(metrics.gini(shares)):.2f}", ylim=(0, 30), xticks=[])
        one.set(xlabel="foragers", ylabel="items removed")
    rows, columns = np.mgrid[0:11, 0:15]
    seen = sum(((rows - 5) ** 2 + (columns - c) ** 2 <= 16).astype(int) for c in (4, 9))
    axes[2].scatter(columns, rows, s=9, c=np.array(["#D8D8D8", "#F08C00", "#7A3E00"])[seen.ravel()])
    overlap = float(metrics.coverage_overlap(seen.ravel()))
    axes[2].set(title=f"CO = {(seen > 1).sum()} / {(seen > 0).sum()} = {overlap:.2f}")
    axes[2].set(aspect="equal", xticks=[], yticks=[], xlabel="nodes seen by one, by two")
    return made


PICTURES = (progress, lag, service, error, idleness, sharing)


def rounded(svg: str) -> str:
    """An SVG with places to a hundredth of a point, which nobody sees, in fewer bytes."""

    def place(number: re.Match[str]) -> str:
        return f"{float(number[0]):.2f}".rstrip("0").rstrip(".")

    def places(found: re.Match[str]) -> str:
        return re.sub(r"-?\d+\.\d{3,}", place, found[0])

    return re.sub(r' (?:d|x|y)="[^"]*"|translate\([^)]*\)', places, svg)


def draw(folder: Path) -> None:
    """Write all pictures; the same bytes every time."""
    with mpl.rc_context({"svg.hashsalt": "mjforage", "font.size": 9, "svg.fonttype": "path"}):
        for make in PICTURES:
            drawn = io.StringIO()
            make().savefig(drawn, format="svg", metadata={"Date": None})
            (folder / f"metrics-{make.__name__}.svg").write_text(rounded(drawn.getvalue()), "utf-8")


if __name__ == "__main__":
    draw(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
