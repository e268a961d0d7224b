"""Axes: who plays which point, and where points stand."""

import math

import pytest

from mjforage.runs.studies.axes import Axis, Point, along, changed
from mjforage.scenario.link import Link
from mjforage.scenario.scenario_file import load_scenario

FAR = Point(math.inf)
HALF = Point(0.5, "half", "one half", {"items": {"mean": 0.5}})
THREE = Point(3.0, "three", "three", {"items": {"mean": 3.0}}, ("belief",))
AXIS = Axis("x", "x  [m]", "X", {"": (HALF, THREE, FAR)}, {"inf": "any"})


def test_what_is_not_named_stays() -> None:
    scenario = load_scenario("published")
    found = changed(
        scenario, {"link": {"model": "disk", "latency": 3}, "team": {"scouts": {"count": 5}}}
    )
    assert found.link == Link("disk", latency=3)
    assert (found.team["scouts"].count, found.team["scouts"].moves) == (5, 2)
    assert found.team["foragers"] == scenario.team["foragers"]
    assert found.items == scenario.items


def test_each_point_is_played_once_by_whom_it_is_for() -> None:
    scenario = load_scenario("published")
    again = Axis("y", "y", "Y", {"": (HALF,)})
    found = along((AXIS, again), scenario, ("greedy", "belief(fast=true)"))
    assert [(one.name, one.title, one.policies) for one in found] == [
        ("half", "one half", ("greedy", "belief(fast=true)")),
        ("three", "three", ("belief(fast=true)",)),
    ]
    assert [one.scenario.items.mean for one in found] == [0.5, 3.0]
    assert [one.name for one in along((AXIS,), scenario, ("greedy",))] == ["half"]


@pytest.mark.parametrize(("even", "places"), [(True, [0.0, 1.0, 2.0]), (False, [0.5, 3.0])])
def test_values_stand_evenly_or_where_they_are(even: bool, places: list[float]) -> None:
    axis = Axis("x", "x", "X", {"a": (HALF, FAR), "b": (THREE,)}, {"inf": "any"}, even)
    assert axis.values == (0.5, 3.0, math.inf)
    assert [axis.place(value) for value in axis.values][: len(places)] == places
    assert [axis.tick(value) for value in axis.values] == ["0.5", "3", "any"]


def test_points_of_an_axis_are_its_variants_once_and_not_the_scenario_as_it_is() -> None:
    axis = Axis("x", "x", "X", {"a": (HALF, FAR), "b": (HALF, THREE, FAR)})
    assert [point.variant for point in axis.points] == ["half", "three"]
