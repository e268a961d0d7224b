"""The cost of information: what NT90 falls by per range, from each range to the next."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from math import isfinite
from typing import Any

from matplotlib.axes import Axes

from mjforage.metrics import cost_of_information, paired_p
from mjforage.mission.mission_metrics import describe
from mjforage.runs.axes import Axis, Point
from mjforage.view.page import style
from mjforage.view.page.figure import WIDTH_IN, Panel, ReportFigure, canvas, house_style
from mjforage.view.page.table import Row, Table
from mjforage.view.report.differences import FEWEST, SEED, Estimate, family_note, set_apart
from mjforage.view.report.studies.study_logs import Player, StudyLogs
from mjforage.view.report.text_tables import NOTHING, policy_name

KEY = "nt90"
KILOMETRE = 1000.0  # [m]: costs are per kilometre of range
DIGITS = 2
DODGE = 0.1  # between policies, of the distance of two steps


@dataclass(frozen=True)
class Step:
    """From one range to the next, on one line of an axis."""

    line: str
    near: Point
    far: Point

    @property
    def name(self) -> str:
        """Its two ranges."""
        return f"{self.near.value:g} to {self.far.value:g} m"


def steps(logs: StudyLogs, axis: Axis) -> Iterator[Step]:
    """Neighbouring ranges that were both played and end somewhere, line by line."""
    for line, points in axis.lines.items():
        played = [one for one in points if isfinite(one.value) and one.variant in logs.runs]
        for near, far in pairwise(played):
            yield Step(line, near, far)


class Costs:
    """C_R of every step of an axis in one world, by policy; each is bold or filled as a family."""

    def __init__(self, logs: StudyLogs, axis: Axis, world: str) -> None:
        self._logs, self._world = logs, world
        self.policies, self.steps = style.ordered(logs.base.policies), list(steps(logs, axis))
        self.of = {
            (policy, step): self._cost(policy, step)
            for policy in self.policies
            for step in self.steps
        }
        apart = set_apart(list(self.of.values()))
        self.apart = dict(zip(self.of, apart, strict=True))

    @property
    def names(self) -> tuple[str, ...]:
        """The steps' names, each once."""
        return tuple(dict.fromkeys(step.name for step in self.steps))

    @property
    def lines(self) -> dict[str, dict[str, Step]]:
        """Line of the axis -> its steps by name; lines without any left out."""
        found: dict[str, dict[str, Step]] = {}
        for step in self.steps:
            found.setdefault(step.line, {})[step.name] = step
        return found

    def _cost(self, policy: str, step: Step) -> Estimate:
        near, far = (
            self._logs.values(Player(one.variant, self._world, policy), KEY)
            for one in (step.near, step.far)
        )
        ends = step.near.value / KILOMETRE, step.far.value / KILOMETRE
        found = cost_of_information(near, far, *ends, SEED)
        return Estimate(found, float(paired_p(far, near)), DIGITS)


def cost_table(logs: StudyLogs, world: str, costs: Costs) -> Table:
    """C_R by policy, from range to range."""
    rows = []
    for line, along in costs.lines.items():
        for policy in costs.policies:
            found = {name: (policy, step) for name, step in along.items()}
            cells = (costs.of[found[n]].cell if n in found else NOTHING for n in costs.names)
            best = (i for i, n in enumerate(costs.names) if n in found and costs.apart[found[n]])
            head, colour = policy_name(policy, logs.bounds), style.policy_colour(policy)
            values = (costs.of[found[n]].full if n in found else None for n in costs.names)
            row = Row(head, tuple(cells), colour, best=frozenset(best), group=line)
            rows.append(replace(row, values=tuple(values)))
    notes = (
        "C_R = (NT90(R2) − NT90(R1)) / (R2 − R1), per kilometre of range; range 0 is no link. "
        "Negative: hearing farther makes the fleet faster. In parentheses the bootstrap 95 % "
        "interval over the same episodes, of itself alone; "
        f"{family_note(list(costs.of.values()))}.",
    )
    title = f"Cost of information{logs.suffix(world)}"
    units = ("1/km",) * len(costs.names)
    return Table(f"range-cost-{world}", title, costs.names, tuple(rows), notes, units)


def _draw(axes: Axes, costs: Costs, line: str) -> None:
    looks = style.policy_styles(costs.policies)
    axes.axhline(0.0, color=style.MUTED, linewidth=1.0)
    for number, (policy, look) in enumerate(looks.items()):
        shift = DODGE * (number - (len(looks) - 1) / 2)
        for step in costs.lines[line].values():
            found, at = costs.of[policy, step], costs.names.index(step.name) + shift
            fill = look.colour if costs.apart[policy, step] else "white"
            axes.plot([at, at], [found.low, found.high], color=look.colour, linewidth=1.6)
            dot: dict[str, Any] = {
                "markerfacecolor": fill,
                "markersize": 6.0,
                "markeredgewidth": 1.3,
            }
            axes.plot(at, found.value, **look.dots, **dot)
    axes.set_xticks(range(len(costs.names)), [name.removesuffix(" m") for name in costs.names])
    axes.set_xlim(-0.5, len(costs.names) - 0.5)
    axes.grid(visible=False, axis="x")
    axes.set_title(line)
    axes.set_ylabel("$C_R$  [1/km]")


def cost_picture(logs: StudyLogs, world: str, costs: Costs) -> ReportFigure:
    """C_R over the range, a panel for each line of the axis."""
    with house_style():
        figure = canvas(WIDTH_IN, 1.1 + 2.3 * len(costs.lines))
        grid = figure.subplots(len(costs.lines), 1, sharex=True, sharey=True, squeeze=False)
        for axes, line in zip(grid[:, 0], costs.lines, strict=True):
            _draw(axes, costs, line)
        grid[-1, 0].set_xlabel("from range to range  [m]")
        Panel(costs.policies, (world,)).legend(figure)
    family = list(costs.of.values())
    words = (
        f"Change of {describe(KEY).label} per kilometre of range, from one range to the next (0: "
        "no link): the further below 0, the more a metre more is worth there. Bars: bootstrap 95 % "
        f"intervals; {family_note(family, 'this figure', 'filled')} and is of {FEWEST} episodes or "
        "more."
    )
    title = f"Cost of information over the range{logs.suffix(world)}"
    return ReportFigure(f"range-cost-{world}", title, words, figure)
