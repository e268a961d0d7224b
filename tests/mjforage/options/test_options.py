"""Every option of a policy and every key of a scenario does what it is for, and nothing else."""

from dataclasses import replace
from pathlib import Path

import pytest

from mjforage.mission.moves import MoveRules
from mjforage.mission.setup import Setup
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.scenario_file import load_scenario
from mjforage.scenario.schema import rows
from tests.mjforage.options.scenes import (
    Scene,
    differences,
    excused,
    key_of,
    policy_options,
    scenario_keys,
    scenes,
)
from tests.mjforage.scenario.written_scenarios import MINIMAL, write

SCENES = {file: scenes(file) for file in ("policies", "belief", "scenario", "physics")}
SHOWN = {(key_of(one.option), one.value) for all_ in SCENES.values() for one in all_ if one.changes}
OF_POLICIES = {one.player: one for one in SCENES["policies"] if "(" not in one.player}


def of_file(file: str) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("scene", SCENES[file], ids=str)


@of_file("policies")
def test_options_of_policies_change_what_they_are_for_and_nothing_else(scene: Scene) -> None:
    assert differences(scene) == set(scene.changes.split())


@of_file("belief")
def test_what_belief_assumes_and_does_is_what_changes_and_nothing_else(
    scene: Scene,
) -> None:
    assert differences(scene) == set(scene.changes.split())


@of_file("scenario")
def test_keys_of_a_scenario_change_what_they_are_for_and_nothing_else(scene: Scene) -> None:
    assert differences(scene) == set(scene.changes.split())


@of_file("physics")
def test_keys_that_hulls_feel_change_what_they_are_for_and_nothing_else(scene: Scene) -> None:
    assert differences(scene) == set(scene.changes.split())


@pytest.mark.parametrize("scene", OF_POLICIES.values(), ids=OF_POLICIES.keys())
def test_a_policy_with_its_options_at_their_defaults_is_the_one_without(scene: Scene) -> None:
    told = {o: v for o, v in policy_options().items() if o.startswith(f"{scene.player}.")}
    first, *others = (f"{o.partition('.')[2]}={str(v).lower()}" for o, v in told.items())
    start = replace(scene, option=next(iter(told)))
    assert not differences(start, ", ".join([first.partition("=")[2], *others]))


def test_a_key_at_its_default_is_as_if_it_were_absent(tmp_path: Path) -> None:
    file = write(tmp_path, MINIMAL)
    for key, default in scenario_keys().items():
        if default not in ("", "required", "absent"):
            given = f"{key.replace('NAME', 'pilots')}={default}"
            assert load_scenario(file, [given]) == load_scenario(file), given


def test_every_option_has_a_scene_or_a_reason_to_have_none() -> None:
    known = policy_options().keys() | scenario_keys().keys()
    shown = {option for option, _ in SHOWN}
    assert known - shown - excused().keys() == set(), "give each a scene (see scenes.py)"
    assert (shown | excused().keys()) - known == set(), "there are no such options"
    assert shown & excused().keys() == set(), "these have scenes"


def test_every_word_that_an_option_can_be_has_a_scene() -> None:
    wanted, default = set[tuple[str, str]](), set[tuple[str, str]]()
    for row in rows(Scenario):
        if row.type == "text" and row.range and row.key not in excused():
            wanted |= {(row.key, word) for word in row.range.split(" or ")}
            if row.default != "absent":
                default.add((row.key, row.default.strip('"')))
    assert default < wanted
    assert wanted - default - SHOWN == set()


def test_policies_are_told_the_rules_that_the_mission_goes_by() -> None:
    """None of them at its default: nodes of 8 m, so that a link of 24 m reaches three."""
    rules = ("horizon=33", "rules.stay=false", "rules.walls=published", "prior.items=7")
    link = ("map.pitch_m=8", "link.model=disk", "link.range_m=24", "link.latency=2")
    task = Setup.of(load_scenario("open-bay", (*rules, *link))).task
    assert task.rules == MoveRules(stay=False, shorten=True)
    assert (task.horizon, task.walls, task.prior.items) == (33, "published", 7.0)
    assert (task.reach_node, task.latency) == (3.0, 2)
