"""What every call of a study computed, how fast, and with how many workers."""

from collections.abc import Mapping
from typing import Any

from matplotlib.ticker import MaxNLocator

from mjforage.report import style
from mjforage.report.figures import house_style
from mjforage.report.picture import WIDTH_IN, Picture, canvas
from mjforage.report.studies.logs import StudyLogs
from mjforage.report.tables import Row, Table, number


def _rate(session: Mapping[str, Any]) -> float:
    """Episodes per second of wall time."""
    return float(session["episodes"]) / float(session["wall_s"])


def cost_table(logs: StudyLogs) -> Table | None:
    """A row per call; None where nothing was logged."""
    rows = []
    for session in logs.sessions:
        wall, count = float(session["wall_s"]), int(session["workers"])
        cells = (
            str(session["how"]),
            str(count),
            str(session["episodes"]),
            number(wall, 1),
            number(_rate(session), 2),
            number(float(session["steps"]) / wall, 0),
            number(100 * float(session["cpu_s"]) / (wall * count), 0),
        )
        rows.append(Row(str(session["started"]), cells))
    if not rows:
        return None
    notes = (
        "A row per call that computed something; a study that was stopped and resumed has several. "
        "The wall time includes starting workers and merging tables; busy: CPU time of the "
        "episodes over wall time times workers.",
    )
    labels = ("computed by", "workers", "episodes", "wall", "episodes", "decisions", "busy")
    units = ("", "", "", "s", "per s", "per s", "%")
    return Table("cost", "Throughput", labels, tuple(rows), notes, units)


def cost_picture(logs: StudyLogs) -> Picture | None:
    """Throughput against the number of workers; None unless there were several numbers."""
    points = sorted((int(session["workers"]), _rate(session)) for session in logs.sessions)
    if len({count for count, _ in points}) < 2:
        return None
    with house_style():
        figure = canvas(WIDTH_IN, 3.2)
        axes = figure.subplots()
        few, rate = points[0]
        most = points[-1][0]
        axes.plot([0, most], [0, rate / few * most], color=style.MUTED, linestyle="--")
        axes.plot(*zip(*points, strict=True), "o", color=style.POLICY_COLOURS["greedy"])
        axes.set(xlabel="workers", ylabel="episodes per second", xlim=(0, most + 0.5))
        axes.set_ylim(bottom=0)
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    words = "Dots: one per call; dashed: in proportion to the call with the fewest workers."
    return Picture("throughput", "Throughput against workers", words, figure)
