"""Axes of a study: values of one quantity, each of them a variant of the scenario."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from mjforage.base.toml_files import read_toml
from mjforage.runs.studies.study import Variant
from mjforage.runs.studies.variants import COMPLETE
from mjforage.scenario.assets import models_folder
from mjforage.scenario.scenario import Scenario

OWN = "own"
"""Variant of what a scenario has itself, where that is not what the study compares with."""


@dataclass(frozen=True, eq=False)
class Point:
    """A value on an axis and the variant that has it."""

    value: float
    variant: str = COMPLETE  # its name; several axes may share one
    title: str = ""  # in tables
    changes: Mapping[str, Any] = field(default_factory=dict)  # as of `changed`
    policies: Sequence[str] = ()  # of those of the study, who play it; empty: all


@dataclass(frozen=True)
class Axis:
    """Some lines of points over one quantity."""

    name: str
    label: str  # with its unit, below the axis
    heading: str  # above rows of a table
    lines: Mapping[str, tuple[Point, ...]]  # what they are called: their points, values ascending
    ticks: Mapping[str, str] = field(default_factory=dict)  # names of values, such as inf
    even: bool = True  # values as far apart as their places in the list
    against: str = COMPLETE  # variant that points are compared with

    @property
    def points(self) -> tuple[Point, ...]:
        """All points but those of the scenario as it is, each variant once."""
        found = {point.variant: point for line in self.lines.values() for point in line}
        return tuple(point for name, point in found.items() if name != COMPLETE)

    @property
    def values(self) -> tuple[float, ...]:
        """The values, ascending."""
        return tuple(sorted({point.value for line in self.lines.values() for point in line}))

    def place(self, value: float) -> float:
        """Position of a value along the axis."""
        return float(self.values.index(value)) if self.even else value

    def tick(self, value: float) -> str:
        """A value in words."""
        text = f"{value:g}"
        return self.ticks.get(text, text)


def axes_of(kind: str, table: str = "axes") -> tuple[Axis, ...]:
    """Axes of a kind of study, as `models/studies` has them."""
    file = models_folder() / "studies" / f"{kind}.toml"
    found = []
    for entry in read_toml(file, str(file))[table]:
        lines = entry.pop("lines").items()
        drawn = {name: tuple(Point(**point) for point in line) for name, line in lines}
        found.append(Axis(lines=drawn, **entry))
    return tuple(found)


def changed(value: Any, changes: Mapping[str, Any]) -> Any:
    """A scenario, or a table of one, with other values of some of its keys.

    `changes`: key -> value, or what to change in the table of that name.
    """
    if isinstance(value, Mapping):
        return {**value, **{name: changed(value[name], keys) for name, keys in changes.items()}}
    return replace(
        value,
        **{
            name: changed(getattr(value, name), new) if isinstance(new, Mapping) else new
            for name, new in changes.items()
        },
    )


def along(axes: Iterable[Axis], scenario: Scenario, policies: Sequence[str]) -> list[Variant]:
    """The variants of the axes' points, each once; those that none of the policies plays left out.

    `scenario`: what the points change; `policies`: references, with or without options.
    """
    found: dict[str, Variant] = {}
    for point in (point for axis in axes for point in axis.points):
        among = point.policies
        players = tuple(one for one in policies if not among or one.partition("(")[0] in among)
        if players and point.variant not in found:
            varied = changed(scenario, point.changes)
            found[point.variant] = Variant(point.variant, point.title, varied, players)
    return list(found.values())
