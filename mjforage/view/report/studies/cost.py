"""What a study's episodes cost, what the whole of the paper's would, and how throughput grows."""

from collections import defaultdict
from collections.abc import Iterator

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from mjforage.metrics import half_width_95, mean
from mjforage.runs.costs import Cost
from mjforage.view.page import style
from mjforage.view.page.figure import WIDTH_IN, Panel, ReportFigure, canvas, house_style
from mjforage.view.page.table import Number, Row, Table
from mjforage.view.report.studies.study_logs import StudyLogs
from mjforage.view.report.text_tables import number, policy_name

PAPER_EPISODES = 4300
"""All of the paper for one policy: the fleet, 2 fleets less one, 2 teams at 20 levels; 100 each."""
LIKE_PAPER = ("ablation", "corruption", "paper")  # studies that play its variants
HOUR_S = 3600.0
STARTED_S = 60.0  # wall time after which loading and compiling no longer rule a throughput

Work = tuple[str, str]  # world and policy: what calls must share to be compared


def works(logs: StudyLogs) -> list[Work]:
    """Worlds of one policy next to one another."""
    found = {(cost.world, cost.policy) for costs in logs.costs.values() for cost in costs}
    policies = style.ordered(policy for _, policy in found)
    return [(w, policy) for policy in policies for w in logs.worlds if (w, policy) in found]


def _head(logs: StudyLogs, work: Work) -> str:
    return policy_name(work[1], logs.bounds) + logs.suffix(work[0])


def _warm(logs: StudyLogs, work: Work) -> list[list[Cost]]:
    """Chunks per variant without each worker's first one, which also loads and compiles.

    If there are no others, those.
    """
    variants = [
        [cost for cost in costs if (cost.world, cost.policy) == work]
        for costs in logs.costs.values()
    ]
    first: dict[tuple[str, str], float] = {}
    for cost in (one for costs in variants for one in costs):
        worker = (cost.started, cost.worker)
        first[worker] = min(cost.began_s, first.get(worker, cost.began_s))
    warm = [
        [cost for cost in costs if cost.began_s > first[cost.started, cost.worker]]
        for costs in variants
    ]
    return [costs for costs in (warm if any(warm) else variants) if costs]


def cost_table(logs: StudyLogs) -> Table:
    """CPU time per episode of every world and policy, and of all of the paper's episodes."""
    rows, told = [], logs.kind in LIKE_PAPER
    for work in works(logs):
        warm = _warm(logs, work)
        chunks = [cost for costs in warm for cost in costs]
        episodes = sum(cost.episodes for cost in chunks)
        per_episode = np.array(
            [sum(c.cpu_s for c in costs) / sum(c.episodes for c in costs) for costs in warm]
        )
        cpu_s, half = float(mean(per_episode)), float(half_width_95(per_episode))
        steps = sum(cost.steps for cost in chunks)
        hours = PAPER_EPISODES / HOUR_S
        cells = (
            str(len(warm)),
            str(episodes),
            number(episodes / len(chunks), 1),
            _with_half(cpu_s, half),
            _with_half(1000 * sum(cost.cpu_s for cost in chunks) / steps, float("nan")),
            *((_with_half(cpu_s * hours, half * hours),) if told else ()),
        )
        values = (
            *map(Number, (len(warm), episodes, episodes / len(chunks))),
            Number(cpu_s, cpu_s - half, cpu_s + half),
            Number(1000 * sum(cost.cpu_s for cost in chunks) / steps),
            *((Number(*(hours * one for one in (cpu_s, cpu_s - half, cpu_s + half))),) * told),
        )
        rows.append(Row(_head(logs, work), cells, style.policy_colour(work[1]), values=values))
    notes = [
        "CPU time of one core: mean of the variants' means ± 1.96 SEM over the variants, whose "
        "real differences are in it. A worker's first chunk of a row also loads and compiles, and "
        "is left out unless there is no other. Not in it: starting workers, writing, the episodes "
        "played again to keep their replays, merging and drawing."
    ]
    if told:
        notes.append(
            f"All of the paper: {PAPER_EPISODES} episodes of the policy in that world (43 variants "
            "of 100), extrapolated in proportion; divide by the number of cores. An episode of a "
            "small chunk costs more than one of a full chunk, so that small samples say too much "
            "rather than too little."
        )
    labels = ("variants", "episodes", "episodes", "CPU time", "CPU time", "all of the paper")
    units = ("", "", "per chunk", "s per episode", "ms per decision", "CPU hours")
    size = len(labels) if told else len(labels) - 1
    return Table("cost", "Cost", labels[:size], tuple(rows), tuple(notes), units[:size])


def _with_half(value: float, half: float) -> str:
    """A number with two digits of its half width, or three of its own where that is undefined."""
    size = half if np.isfinite(half) and half > 0 else value / 10
    digits = max(0, 1 - int(np.floor(np.log10(size)))) if size > 0 else 0
    text = number(value, digits)
    return f"{text} ± {number(half, digits)}" if np.isfinite(half) else text


def _by_call(logs: StudyLogs) -> dict[str, list[Cost]]:
    """Chunks of every call, the calls in their order."""
    calls: dict[str, list[Cost]] = defaultdict(list)
    for costs in logs.costs.values():
        for cost in costs:
            calls[cost.started].append(cost)
    return dict(sorted(calls.items()))


class Share:
    """What one call computed of one world and policy.

    The time between the call's first and last moment of computing is shared out among its works
    in proportion to the time that workers spent on them, so that waiting workers count.
    """

    def __init__(self, call: list[Cost], work: Work) -> None:
        own = [cost for cost in call if (cost.world, cost.policy) == work]
        begin, end = min(c.began_s for c in call), max(c.began_s + c.wall_s for c in call)
        part = sum(c.wall_s for c in own) / sum(c.wall_s for c in call)
        self.how, self.workers, self.started = own[0].how, own[0].workers, own[0].started
        self.episodes, self.wall_s = sum(c.episodes for c in own), (end - begin) * part
        self.cpu_s = sum(c.cpu_s for c in own)

    @property
    def rate(self) -> float:
        """Episodes per second of wall time."""
        return self.episodes / self.wall_s

    @property
    def figures(self) -> tuple[float, ...]:
        """Workers, episodes, wall time [s], episodes per s, CPU time [s per episode], busy [%]."""
        busy = 100 * self.cpu_s / (self.wall_s * self.workers)
        per_episode = self.cpu_s / self.episodes
        return self.workers, self.episodes, self.wall_s, self.rate, per_episode, busy


def _shares(logs: StudyLogs, work: Work) -> Iterator[Share]:
    for call in _by_call(logs).values():
        if any((cost.world, cost.policy) == work for cost in call):
            yield Share(call, work)


def throughput_table(logs: StudyLogs) -> Table:
    """A row per call, under the world and policy that make rows comparable."""
    rows = [
        Row(
            f"{share.started[:19]} UTC",
            (
                share.how,
                *map(number, share.figures, (0, 0, 1, 2, 4, 0)),
            ),
            style.policy_colour(work[1]),
            group=_head(logs, work),
            values=(None, *map(Number, share.figures)),
        )
        for work in works(logs)
        for share in _shares(logs, work)
    ]
    notes = (
        "A row per call and what it computed, also of calls that were stopped or killed: finished "
        "chunks keep their own times. Only rows of one heading are alike. Wall: from the call's "
        "first to its last moment of computing, shared out among the headings in proportion to the "
        "time that workers spent; busy: CPU time over wall time times workers. Calls of less "
        "than a minute mostly load and compile.",
    )
    labels = ("computed by", "workers", "episodes", "wall", "episodes", "CPU time", "busy")
    units = ("", "", "", "s", "per s", "s per episode", "%")
    return Table("throughput", "Throughput", labels, tuple(rows), notes, units, head="call")


def throughput_picture(logs: StudyLogs) -> ReportFigure | None:
    """Throughput against workers; None unless long calls of several numbers did the same work."""
    drawn: dict[Work, list[tuple[int, float]]] = {}
    for work in works(logs):
        long = [share for share in _shares(logs, work) if share.wall_s >= STARTED_S]
        points = sorted((share.workers, share.rate) for share in long)
        few = points[0][0] if points else 0
        if points and points[-1][0] > few:
            each = float(np.mean([rate / few for count, rate in points if count == few]))
            drawn[work] = [(count, rate / each) for count, rate in points]
    if not drawn:
        return None
    panel = Panel(tuple(dict.fromkeys(policy for _, policy in drawn)), logs.worlds)
    most = max(points[-1][0] for points in drawn.values())
    with house_style():
        figure = canvas(WIDTH_IN, 3.6)
        axes = figure.subplots()
        axes.add_line(Line2D([0, most], [0, most], color=style.MUTED, linestyle="--"))
        looks, lines = panel.styles(), panel.lines()
        for (world, policy), points in drawn.items():
            look = looks[policy]
            axes.plot(*zip(*points, strict=True), **look.dots, markersize=5)
            counts = sorted({count for count, _ in points})
            means = [np.mean([rate for count, rate in points if count == x]) for x in counts]
            axes.plot(counts, means, color=look.colour, linestyle=lines[world])
        axes.set(xlabel="workers", ylabel="relative throughput")
        axes.set(xlim=(0, most + 0.5), ylim=(0, None))
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
        panel.legend(figure)
    words = (
        "Episodes per second over those per worker of the call with the fewest workers on the same "
        "world and policy; a dot per call, lines through their "
        f"means. Calls of less than {STARTED_S:g} s of it are left out. Dashed grey: in proportion."
    )
    return ReportFigure("throughput", "Throughput against workers", words, figure)
