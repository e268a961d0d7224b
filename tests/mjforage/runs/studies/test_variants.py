from dataclasses import fields, replace

import pytest

from mjforage.base.errors import UserError
from mjforage.graph_planner.belief_planner.settings import BeliefOptions
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


@pytest.mark.parametrize("link", ["ideal", "disk"])
def test_every_part_of_the_planner_is_switched_off_alone(link: str) -> None:
    """Those that keep in touch over a link only."""
    scenario = load_scenario("published", [f"link.model={link}"])
    found = named(variants.parts(scenario))
    whole = found[variants.COMPLETE]
    assert whole.scenario == scenario
    switches = [f.name for f in fields(BeliefOptions) if f.default is True]
    assert len(switches) == 10
    over_links = [name for name in switches if name in variants.IN_TOUCH]
    assert over_links == ["report", "alone", "relay"]
    for name in switches:
        plays = f"belief({name}=false)" in whole.policies
        assert plays == (link == "disk" or name not in over_links)
    assert {"belief", "belief(fast=true)", "greedy", "oracle"} < set(whole.policies)


def test_wrong_worlds_leave_the_assumptions_alone(scenario: Scenario) -> None:
    found = named(variants.parts(scenario))
    assert found["hotspots"].scenario.items.hotspots == 3
    assert found["two-hotspots"].scenario.items.hotspots == 2
    assert found["spread"].scenario.items.covariance_node2 == pytest.approx(80.0)
    assert found["drift"].scenario.weather.drift_node_per_step == pytest.approx(0.2)
    assert found["calm"].scenario.weather.drift_node_per_step == pytest.approx(0.05)
    for name in variants.WRONG:
        assert found[name].scenario.prior == scenario.prior
        assert found[name].policies == ("belief", "belief(robust=true)", "greedy", "oracle")


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
    everything = (*variants.parts(scenario), *variants.paper(scenario, BOTH, 0.25, False))
    for variant in everything:
        tree = scenario_to_tree(variant.scenario)
        assert scenario_from_tree(tree, variant.name) == variant.scenario
