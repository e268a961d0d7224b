from dataclasses import replace

import pytest

from mjforage.base.errors import UserError
from mjforage.runs.studies import variants
from mjforage.runs.studies.study import Variant
from mjforage.scenario.scenario import CorruptionChoice, Scenario
from mjforage.scenario.scenario_file import load_scenario, scenario_from_tree, scenario_to_tree

BOTH = ("greedy", "levy")


@pytest.fixture
def scenario() -> Scenario:
    return load_scenario("published")


def named(found: tuple[Variant, ...]) -> dict[str, Variant]:
    names = {variant.name: variant for variant in found}
    assert len(names) == len(found), "two variants of one name"
    return names


def test_each_team_lacks_one_agent_once(scenario: Scenario) -> None:
    found = named(variants.ablation(scenario, BOTH))
    counts = {n: [role.count for role in v.scenario.team.values()] for n, v in found.items()}
    assert counts == {"complete": [2, 2], "scouts-less": [1, 2], "foragers-less": [2, 1]}
    assert found["scouts-less"].title == "scouts 1, foragers 2"


def test_teams_of_nobody_are_not_lessened() -> None:
    nobody = "team.scouts.count=0"
    foragers = load_scenario("published", [nobody])
    assert set(named(variants.ablation(foragers, BOTH))) == {"complete", "foragers-less"}
    with pytest.raises(UserError, match="has one agent"):
        variants.ablation(load_scenario("published", [nobody, "team.foragers.count=1"]), BOTH)


@pytest.mark.parametrize("whole_team", [False, True])
def test_every_team_is_corrupted_at_every_level(scenario: Scenario, whole_team: bool) -> None:
    found = named(variants.corruption(scenario, BOTH, 0.05, whole_team))
    assert len(found) == 1 + 2 * 20
    assert found["complete"].scenario.corruption == CorruptionChoice()
    for team in ("scouts", "foragers"):
        for level in (0.05, 0.35, 1.0):
            choice = found[variants.corrupted_name(team, level)].scenario.corruption
            assert choice == CorruptionChoice(team, level, whole_team)


@pytest.mark.parametrize("step", [0.0, -0.1, 0.3, 0.5, 2.0, 1e-9])
def test_steps_that_do_not_fit_are_refused(step: float) -> None:
    with pytest.raises(UserError, match="give 1/N with N from 4 to 1000"):
        variants.levels(step)


def test_the_paper_is_its_ablations_and_corruptions(scenario: Scenario) -> None:
    found = set(named(variants.paper(scenario, BOTH, 0.25, True)))
    lesser = set(named(variants.ablation(scenario, BOTH)))
    assert found == lesser | set(named(variants.corruption(scenario, BOTH, 0.25, True)))
    corrupted = replace(scenario, corruption=CorruptionChoice("scouts", 0.5))
    plain, other = (variants.paper(each, BOTH, 0.25, True) for each in (scenario, corrupted))
    assert other == plain, "nobody is corrupted but as the study says"


def test_every_variant_is_a_valid_scenario(scenario: Scenario) -> None:
    for variant in variants.paper(scenario, BOTH, 0.25, False):
        tree = scenario_to_tree(variant.scenario)
        assert scenario_from_tree(tree, variant.name) == variant.scenario
