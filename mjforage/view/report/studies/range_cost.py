"""Cost of information: fall of NT90 per range, from each range to the next."""

from dataclasses import dataclass
from itertools import pairwise
from math import isfinite

from mjforage.metrics import cost_of_information, paired_p
from mjforage.runs.studies.axes import Axis, Point
from mjforage.view.page import style
from mjforage.view.page.table import NOTHING, Table
from mjforage.view.report.cells import Cell, row
from mjforage.view.report.differences import SEED, Estimate, family_note, set_apart
from mjforage.view.report.run_logs import policy_name
from mjforage.view.report.studies.study_logs import StudyLogs

KEY = "nt90"
KILOMETRE = 1000.0  # [m]: costs are per kilometre of range
DIGITS = 2
DODGE = 0.1  # between policies, of the distance of two steps


@dataclass(frozen=True)
class Step:
    """Step from one range to the next, on one line of an axis."""

    line: str
    near: Point
    far: Point

    @property
    def name(self) -> str:
        """Its two ranges."""
        return f"{self.near.value:g} to {self.far.value:g} m"


class Costs:
    """C_R of every step of an axis in one world, by policy; each is bold or filled as a family."""

    def __init__(self, logs: StudyLogs, axis: Axis, world: str) -> None:
        self.logs, self.world, self.policies = logs, world, logs.policies
        self.steps = [
            Step(line, near, far)
            for line, points in axis.lines.items()
            for near, far in pairwise(
                one for one in points if isfinite(one.value) and one.variant in logs.runs
            )
        ]
        self.of = {
            (one, step): self._cost(one, step) for step in self.steps for one in self.policies
        }
        self.apart = dict(zip(self.of, set_apart(list(self.of.values())), strict=True))
        self.names = tuple(dict.fromkeys(step.name for step in self.steps))
        self.lines = {
            line: {step.name: step for step in self.steps if step.line == line}
            for line in dict.fromkeys(step.line for step in self.steps)
        }

    def _cost(self, policy: str, step: Step) -> Estimate:
        near, far = (
            self.logs.case(one.variant, self.world, policy).values(KEY)
            for one in (step.near, step.far)
        )
        ends = step.near.value / KILOMETRE, step.far.value / KILOMETRE
        found = cost_of_information(near, far, *ends, SEED)
        return Estimate(found, float(paired_p(far, near)), DIGITS)

    def note(self, *words: str) -> str:
        """Note on the tests."""
        return family_note(list(self.of.values()), *words)


def cost_table(costs: Costs) -> Table:
    """C_R by policy, from range to range."""
    rows = []
    for line, along in costs.lines.items():
        for policy in costs.policies:
            found = [(policy, along[name]) if name in along else None for name in costs.names]
            cells = [costs.of[x].cell(costs.apart[x]) if x else Cell(NOTHING) for x in found]
            head = policy_name(policy, costs.logs.bounds)
            rows.append(row(head, cells, style.policy_colour(policy), group=line))
    note = (
        "C_R = (NT90(R2) − NT90(R1)) / (R2 − R1), per kilometre of range; range 0 is no link. "
        "Negative: a longer range makes the fleet faster. In parentheses the bootstrap 95 % "
        f"interval over the same episodes, of itself alone; {costs.note()}."
    )
    title, units = f"Cost of information{costs.logs.suffix(costs.world)}", ("1/km",)
    name = f"range-cost-{costs.world}"
    return Table(name, title, costs.names, tuple(rows), (note,), units * len(costs.names))
