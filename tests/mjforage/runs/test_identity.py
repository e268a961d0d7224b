"""Identity of a run: whatever decides its numbers, changed alone, is refused on resumption."""

import inspect
import json
from dataclasses import fields, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mjforage.mission.scoring import Metric
from mjforage.mission.setup import Setup
from mjforage.runs.evaluate import evaluate
from mjforage.runs.identity import hull_facts, pinned, run_hash, run_info
from mjforage.runs.resuming import Difference, differences, refusal
from mjforage.runs.run_info import RunInfo
from mjforage.runs.storage import IDENTITY, RunFolder
from mjforage.runs.studies.study import Study, Variant, run_study
from mjforage.scenario.assets import models_folder
from mjforage.scenario.scenario_file import load_scenario
from tests.mjforage.changing import assert_refused, changes, leaves, with_other

FREE = {
    "command": "names flags such as --jobs, which decide nothing",
    "started": "a time",
    "timings": "what the run took",
    "hash": "made of the others",
    "bounds": "follows from the policies",
    "told": "follows from the policies",
    "classes": "follows from the policies; their code counts",
    "versions.mjforage": "its code counts",
    "versions.python": "computes no number",
    "metrics": "by all but the key, which counts: how they are shown",
}
"""What `run.json` says and a run may differ in, and why."""
RECORD = Path(__file__).parents[1] / "options" / "record.csv"
SMALL = ["horizon=2"]
PLAYERS, ORDER = ("greedy", "levy"), ("scouts", "foragers")


def setup_of(*overrides: str) -> Setup:
    return Setup.of(load_scenario("comb-port", [*SMALL, *overrides]))


def other_map(setup: Setup) -> Setup:
    """A map of the same name and size, with one cell of land for one of water."""
    navigable = setup.grid.navigable.copy()
    for water in (True, False):
        navigable[tuple(np.argwhere(setup.grid.navigable == water)[0])] = not water
    return replace(setup, grid=replace(setup.grid, navigable=navigable))


@pytest.fixture(scope="module")
def played(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a finished run that nobody may change."""
    folder = tmp_path_factory.mktemp("identity") / "run"
    evaluate(setup_of(), PLAYERS, folder, episodes=2)
    return folder


def test_every_key_of_a_scenario_is_of_the_run(played: Path) -> None:
    """And of the hash that its workers must agree with."""
    setup, hashes = setup_of(), [json.loads((played / "run.json").read_text())["hash"]]
    for name, scenario in changes(setup.scenario):
        if name == "rules.order":  # must be of its teams
            scenario = replace(setup.scenario, rules=replace(setup.scenario.rules, order=ORDER))
        if name == "sensors.positioning":  # must be a model
            sensors = replace(setup.scenario.sensors, positioning="gnss")
            scenario = replace(setup.scenario, sensors=sensors)
        if name == "faults.team":  # must be one of its teams
            faults = replace(setup.scenario.faults, team="foragers")
            scenario = replace(setup.scenario, faults=faults)
        if name == "weather.file":  # must be a record
            weather = replace(setup.scenario.weather, file=str(RECORD))
            scenario = replace(setup.scenario, weather=weather)
        varied = pinned(replace(setup, scenario=scenario))
        info = run_info(varied, PLAYERS, ["graph"], 2, 0)
        assert_refused(played, partial(RunFolder(played).open, info), name)
        hashes.append(info["hash"])
    assert len(hashes) > 100 and len(set(hashes)) == len(hashes)


def test_the_order_of_teams_is_of_the_run(played: Path) -> None:
    """It numbers the agents."""
    setup = setup_of()
    turned = replace(setup.scenario, team=dict(reversed(list(setup.scenario.team.items()))))
    again = partial(evaluate, replace(setup, scenario=turned), PLAYERS, played, episodes=2)
    assert_refused(played, again, "teams")


def test_every_argument_of_evaluate_is_of_the_run_or_free(played: Path) -> None:
    setup = setup_of()
    starts = replace(setup.scenario.map, starts=setup.start_cells[::-1])
    asked: dict[str, list[Any]] = {
        "setup": [
            other_map(setup),
            replace(setup, scenario=replace(setup.scenario, map=starts)),
            setup_of("map.file=open-bay", "map.starts=[]"),
        ],
        "policies": [PLAYERS[:1], PLAYERS[::-1], (*PLAYERS, "random")],
        "worlds": [("physics",), ("graph", "physics")],
        "metrics": [(f"{__name__}:Items",)],
        "episodes": [1],
        "seed": [1],
    }
    free = {
        "folder": "where it is",
        "workers": "who computes",
        "kept": "replays can be added",
        "progress": "is told",
        "resume": "what to do with another run",
    }
    assert asked.keys() | free.keys() == inspect.signature(evaluate).parameters.keys()
    told: dict[str, Any] = {"setup": setup, "policies": PLAYERS, "episodes": 2}
    for name, values in asked.items():
        for value in values:
            again = partial(evaluate, folder=played, **told | {name: value})
            assert_refused(played, again, name)


def test_whatever_run_json_says_decides_or_is_free_for_a_reason() -> None:
    setup = pinned(setup_of("rules.capture=calibrated"))
    info = json.loads(json.dumps(run_info(setup, ("ddqn",), ("graph", "physics"), 2, 0)))
    told = {field.name for field in fields(RunInfo)} | info.keys()
    assert told == {*IDENTITY, *(name.partition(".")[0] for name in FREE)}
    hashed = {"scenario", "map", "hulls", "versions", "code"}
    found = set()
    for path in leaves(info):
        name, changed = ".".join(map(str, path)), with_other(info, path)
        free = {name, str(path[0])} & FREE.keys() and path[-1] != "key"
        assert (not differences(info, changed, IDENTITY)) == bool(free), name
        assert (run_hash(changed) != run_hash(info)) == (path[0] in hashed and not free), name
        found.add(path[0])
    assert found == info.keys() and {"vessels", "debris", "captures"} == info["hulls"].keys()


def test_what_hulls_are_made_of_is_of_runs_with_hulls(tmp_path: Path) -> None:
    boat = tmp_path / "boat.toml"
    text = (models_folder() / "vessels" / "forager.toml").read_text(encoding="utf-8")
    assert text.count("value = 80.0") == 1
    told = []
    for mass in (80, 81):
        boat.write_text(text.replace("value = 80.0", f"value = {mass}.0"), encoding="utf-8")
        setup = setup_of(f"physics.vessels.foragers={boat}")
        told.append([hull_facts(setup, worlds) for worlds in (["graph"], ["graph", "physics"])])
    (bare, with_hulls), (other_bare, with_others) = told
    assert bare == other_bare == {}
    vessels, others = with_hulls.pop("vessels"), with_others.pop("vessels")
    assert with_hulls == with_others and vessels.keys() == others.keys()
    assert [name for name in vessels if vessels[name] != others[name]] == [str(boat)]


@pytest.fixture(scope="module")
def study() -> Study:
    """Return a study of two variants."""
    setup = setup_of()
    more = load_scenario("comb-port", [*SMALL, "items.mean=60"])
    variants = (
        Variant("complete", "as it is", setup.scenario, ("greedy",)),
        Variant("fewer", "60 items", more, ("greedy",)),
    )
    return Study("ablation", setup, variants, episodes=2, options={"step": 0.5})


def of_variant(study: Study, **changes: Any) -> tuple[Variant, ...]:
    return (study.variants[0], replace(study.variants[1], **changes))


def test_every_part_of_a_study_is_of_it_or_free(study: Study, tmp_path: Path) -> None:
    """A new field of `Study` or `Variant` needs a place here."""
    run_study(study, tmp_path / "study")
    land = other_map(study.setup)
    hotter = replace(study.setup.scenario, items=replace(study.setup.scenario.items, hotspots=2))
    of_variants = {
        "name": "few",
        "title": "60 pieces",
        "scenario": hotter,
        "policies": ("levy",),
        "grid": land.grid,
        "worlds": ("physics",),
    }
    asked: dict[str, list[Any]] = {
        "kind": ["sensing"],
        "setup": [land, replace(study.setup, scenario=hotter)],
        "variants": [
            *(of_variant(study, **{name: value}) for name, value in of_variants.items()),
            study.variants[:1],
            (*study.variants, replace(study.variants[1], name="more")),
        ],
        "worlds": [("physics",)],
        "episodes": [1],
        "seed": [1],
        "options": [{"step": 0.25}, {"step": 0.5, "whole_team": True}],
        "metrics": [(f"{__name__}:Items",)],
    }
    assert {field.name for field in fields(Variant)} == of_variants.keys()
    assert {field.name for field in fields(Study)} - asked.keys() == {"left_out"}, "who cannot play"
    again = partial(run_study, folder=tmp_path / "study")
    for name, values in asked.items():
        for value in values:
            changed = replace(study, **{name: value})
            assert_refused(tmp_path / "study", partial(again, changed), name)
            if name != "episodes":  # more of which it would go on to, were it the same
                more = replace(changed, episodes=3)
                assert_refused(tmp_path / "study", partial(again, more), f"{name}, and more")


class Items(Metric):
    """A metric of this file."""

    key, label = "items_of_test", "Items"

    def value(self, batch: Any) -> Any:
        return batch.log.n_items


def test_of_another_policy_its_code_is_not_told() -> None:
    code, policies = Difference("code", "a.py is gone"), Difference("policies", "policies is 1")
    told = refusal("run", [code, policies])
    assert told.startswith("holds another run: policies is 1; give resume=")
    assert refusal("run", [code]).startswith('holds another run: a.py is gone; give resume="acc')
