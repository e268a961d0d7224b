"""Variants of the study of sensing: cost of misses and false alarms, and of wrong beliefs in them.

On the axes of imperfect scans, the belief planner knows their parameters; on the axes `assumed-*`
it assumes one number whatever is true.
"""

from collections.abc import Sequence
from math import inf

from mjforage.runs.studies.axes import OWN, Axis, Point, along, changed
from mjforage.runs.studies.study import Variant
from mjforage.runs.studies.variants import COMPLETE
from mjforage.scenario.scenario import Scenario

CHANCES = (0.3, 0.5, 0.7, 0.9)
RATES = (0.0005, 0.002)  # ghosts per node and epoch
SLOPE_NODE = 0.5
PLANNER = ("belief",)  # who assumes something
PLAIN = ""  # name of an axis' only line
PERFECT = "perfect sensing"
SENSORS = (
    *("detection", "half_range_node", "slope_node", "detection_table", "persistence"),
    *("false_rate", "false_hold", "merge", "fov_deg", "map"),
)
"""Keys of imperfect scans; the noise of the vessels' instruments stays."""
ASSUMED = ("detection", "half_range_node", "slope_node", "false_rate")


def _missed(p: float, persistence: float = 0.0) -> Point:
    end, words = (f"-persistent-{persistence:g}", ", persistent") if persistence else ("", "")
    sensors = {"detection": p, "persistence": persistence}
    prior = {"detection": p}
    name, title = f"detection-{p:g}{end}", f"p = {p:g}{words}"
    return Point(p, name, title, {"sensors": sensors, "prior": prior})


def _near(half: float) -> Point:
    keys = {"half_range_node": half, "slope_node": SLOPE_NODE}
    title = f"p halved at {half:g} node{'' if half == 1 else 's'}"
    return Point(half, f"half-range-{half:g}", title, {"sensors": keys, "prior": keys})


def _ghosts(rate: float, hold: int) -> Point:
    end, words = (f"-hold-{hold}", f", for {hold} decisions") if hold > 1 else ("", "")
    sensors, prior = {"false_rate": rate, "false_hold": hold}, {"false_rate": rate}
    name, title = f"ghosts-{rate:g}{end}", f"{rate:g} false alarms per node{words}"
    return Point(rate, name, title, {"sensors": sensors, "prior": prior})


def _fov(degrees: float) -> Point:
    title = f"field of view {degrees:g}°"
    return Point(degrees, f"fov-{degrees:g}", title, {"sensors": {"fov_deg": degrees}})


def _taken_for(key: str, true: float, assumed: float) -> Point:
    """A value that the planner takes for another, and perhaps rightly."""
    if true == assumed:
        if true in (0.0, 1.0):
            return Point(true)
        return _missed(true) if key == "detection" else _ghosts(true, 1)
    name = f"{key.replace('_', '-')}-{true:g}-for-{assumed:g}"
    title = f"{true:g} taken for {assumed:g}"
    changes = {"sensors": {key: true}, "prior": {key: assumed}}
    return Point(true, name, title, changes, PLANNER)


def _assumed(
    key: str, values: Sequence[float], always: Sequence[float]
) -> dict[str, tuple[Point, ...]]:
    """A line where the planner is right, and one for each value that it always assumes."""
    right = {"assumed right": tuple(_taken_for(key, value, value) for value in values)}
    return right | {
        f"always {one:g}": tuple(_taken_for(key, value, one) for value in values) for one in always
    }


AXES = (
    Axis(
        "detection",
        "chance of detection p",
        "Missed items",
        {
            "every look anew": (*map(_missed, CHANCES), Point(1.0)),
            "persistence 0.3": (*(_missed(p, 0.3) for p in CHANCES), Point(1.0)),
        },
        even=False,
    ),
    Axis(
        "half-range",
        "half range  [node]",
        "Detection falls with distance",
        {PLAIN: (*map(_near, (1.0, 2.0, 4.0)), Point(inf))},
        {inf: "never"},
    ),
    Axis(
        "ghosts",
        "false alarms per node",
        "False alarms",
        {
            "new every decision": (Point(0.0), *(_ghosts(rate, 1) for rate in RATES)),
            "for 20 decisions": (Point(0.0), *(_ghosts(rate, 20) for rate in RATES)),
        },
    ),
    Axis(
        "fov",
        "field of view  [deg]",
        "Field of view",
        {PLAIN: (_fov(75.0), _fov(120.0), Point(360.0))},
    ),
)
"""Axes of imperfect sensing."""

ASSUMPTIONS = (
    Axis(
        "assumed-detection",
        "chance of detection p",
        "Chance of detection that the planner assumes",
        _assumed("detection", (*CHANCES, 1.0), (1.0, 0.5)),
        even=False,
    ),
    Axis(
        "assumed-ghosts",
        "false alarms per node",
        "False alarms that the planner assumes",
        _assumed("false_rate", (0.0, *RATES), (0.0, 0.002)),
    ),
)
"""Axes of the belief planner's assumptions about it."""


def perfect(scenario: Scenario) -> Scenario:
    """The scenario with perfect scans, and a planner that knows it."""
    sensors, prior = type(scenario.sensors)(), type(scenario.prior)()
    clean: Scenario = changed(
        scenario,
        {
            "sensors": {key: getattr(sensors, key) for key in SENSORS},
            "prior": {key: getattr(prior, key) for key in ASSUMED},
        },
    )
    return clean


def sensing(scenario: Scenario, policies: Sequence[str]) -> tuple[Variant, ...]:
    """Perfect sensing, every point of the axes, and the scenario's own sensing if it is another."""
    base = perfect(scenario)
    variants = [Variant(COMPLETE, PERFECT, base, tuple(policies))]
    variants += along((*AXES, *ASSUMPTIONS), base, policies)
    if base != scenario:
        variants.append(Variant(OWN, "the scenario's own sensing", scenario, tuple(policies)))
    return tuple(variants)
