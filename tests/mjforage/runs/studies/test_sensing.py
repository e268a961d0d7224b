"""The variants of the study of sensing."""

from dataclasses import asdict
from typing import Any

import pytest

from mjforage.runs.studies.sensing import ASSUMPTIONS, AXES, sensing
from mjforage.runs.studies.study import Variant
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.scenario_file import (
    canonical_json,
    load_scenario,
    scenario_from_tree,
    scenario_to_tree,
)

POLICIES = ("greedy", "belief")


def named(scenario: Scenario) -> dict[str, Variant]:
    found = sensing(scenario, POLICIES)
    assert len({variant.name for variant in found}) == len(found), "two variants of one name"
    return {variant.name: variant for variant in found}


@pytest.fixture(scope="module")
def found() -> dict[str, Variant]:
    return named(load_scenario("comb-port"))


def differs(one: Scenario, table: str) -> dict[str, Any]:
    """Keys of a table that are not as in the plain scenario."""
    plain, here = (asdict(getattr(each, table)) for each in (load_scenario("comb-port"), one))
    return {key: value for key, value in here.items() if value != plain[key]}


@pytest.mark.parametrize(
    ("name", "sensors", "prior"),
    [
        ("complete", {}, {}),
        ("detection-0.7", {"detection": 0.7}, {"detection": 0.7}),
        (
            "detection-0.3-persistent-0.3",
            {"detection": 0.3, "persistence": 0.3},
            {"detection": 0.3},
        ),
        (
            "half-range-2",
            {"half_range_node": 2.0, "slope_node": 0.5},
            {"half_range_node": 2.0, "slope_node": 0.5},
        ),
        ("ghosts-0.0005", {"false_rate": 0.0005}, {"false_rate": 0.0005}),
        ("ghosts-0.002-hold-20", {"false_rate": 0.002, "false_hold": 20}, {"false_rate": 0.002}),
        ("fov-75", {"fov_deg": 75.0}, {}),
        ("detection-0.5-for-1", {"detection": 0.5}, {}),
        ("detection-0.9-for-0.5", {"detection": 0.9}, {"detection": 0.5}),
        ("detection-1-for-0.5", {}, {"detection": 0.5}),
        ("false-rate-0.002-for-0", {"false_rate": 0.002}, {}),
        ("false-rate-0-for-0.002", {}, {"false_rate": 0.002}),
    ],
)
def test_looks_lack_one_thing_and_the_planner_is_told_or_wrong(
    name: str, sensors: dict[str, Any], prior: dict[str, Any], found: dict[str, Variant]
) -> None:
    one = found[name]
    assert (differs(one.scenario, "sensors"), differs(one.scenario, "prior")) == (sensors, prior)
    assert one.policies == (("belief",) if "-for-" in name else POLICIES)


def test_no_scenario_is_played_twice_and_each_can_be_written_down(
    found: dict[str, Variant],
) -> None:
    texts = {canonical_json(scenario_to_tree(one.scenario)) for one in found.values()}
    assert len(texts) == len(found) == 30
    for one in found.values():
        tree = scenario_to_tree(one.scenario)
        again = scenario_from_tree(tree, one.name)
        assert again == one.scenario
        assert canonical_json(scenario_to_tree(again)) == canonical_json(tree), "types differ"


def test_every_assumption_meets_every_truth() -> None:
    detection, ghosts = (axis.lines for axis in ASSUMPTIONS)
    truths = [[point.value for point in line] for line in detection.values()]
    assert truths == [[0.3, 0.5, 0.7, 0.9, 1.0]] * 3
    assert [p.variant for p in detection["always 1"]] == [
        *(f"detection-{p}-for-1" for p in (0.3, 0.5, 0.7, 0.9)),
        "complete",
    ]
    assert [p.variant for p in detection["always 0.5"]][1] == "detection-0.5", "it is right there"
    assert [p.variant for p in ghosts["assumed right"]] == [
        "complete",
        "ghosts-0.0005",
        "ghosts-0.002",
    ]
    axes = {axis.name: [p.variant for p in line] for axis in AXES for line in axis.lines.values()}
    assert axes["fov"] == ["fov-75", "fov-120", "complete"]


def test_a_scenario_that_misses_is_played_as_it_is_too() -> None:
    known = ("prior.detection=0.8", "prior.false_rate=0.001", "prior.items=60")
    noise = "sensors.position_noise_m=0.1"
    own = load_scenario("comb-port", ["sensors.detection=0.8", noise, *known])
    found = named(own)
    assert found["own"].scenario == own
    assert differs(found["complete"].scenario, "sensors") == {"position_noise_m": 0.1}
    assert differs(found["complete"].scenario, "prior") == {"items": 60.0}, "it doubts nothing"
    assert differs(found["fov-75"].scenario, "sensors") == {
        "position_noise_m": 0.1,
        "fov_deg": 75.0,
    }
    assert "own" not in named(load_scenario("comb-port", [noise]))
