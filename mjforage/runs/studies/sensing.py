"""Variants of the study of sensing: cost of misses and false alarms, and of wrong beliefs in them.

On the axes of imperfect scans, the belief planner knows their parameters; on the axes `assumed-*`
it assumes one number whatever is true.
"""

from collections.abc import Sequence

from mjforage.runs.studies.axes import OWN, along, axes_of, changed
from mjforage.runs.studies.study import Variant
from mjforage.runs.studies.variants import COMPLETE
from mjforage.scenario.scenario import Scenario

SLOPE_NODE = 0.5
PLANNER = ("belief",)  # who assumes something
PERFECT = "perfect sensing"
SENSORS = (
    *("detection", "half_range_node", "slope_node", "detection_table", "persistence"),
    *("false_rate", "false_hold", "merge", "fov_deg", "map"),
)
"""Keys of imperfect scans; the noise of the vessels' instruments stays."""
ASSUMED = ("detection", "half_range_node", "slope_node", "false_rate")


AXES = axes_of("sensing")
"""Axes of imperfect sensing."""

ASSUMPTIONS = axes_of("sensing", "assumptions")
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
