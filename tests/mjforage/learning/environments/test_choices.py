"""Arguments of environments: maps, scenarios and overrides as objects; all else is named."""

import re
import shutil
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest

import mjforage
from mjforage.base.errors import UserError
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.scenario_file import load_scenario, scenario_path

NAME = "mjforage/Foraging-v0"


def scenario_of(**arguments: Any) -> Scenario:
    env: Any = gymnasium.make(NAME, **arguments).unwrapped
    found: Scenario = env.core.setup.scenario
    return found


@pytest.mark.parametrize(
    "given",
    [
        {"horizon": 20, "team.scouts.count": 3},
        {"horizon": np.int64(20), "team": {"scouts": {"count": 3}}},
        ["horizon=20", "team.scouts.count=3"],
        ("horizon=20", "team.scouts.count=3"),
    ],
)
@pytest.mark.parametrize("base", ["name", "path", "scenario"])
def test_overrides_are_a_mapping_or_a_list(given: Any, base: str, tmp_path: Path) -> None:
    file = Path(shutil.copy(scenario_path("published"), tmp_path / "published.toml"))
    known: dict[str, Any] = {
        "name": "published",
        "path": file,
        "scenario": load_scenario(str(file)),
    }
    wanted = load_scenario(str(file), ("horizon=20", "team.scouts.count=3"))
    if base == "name":
        wanted = load_scenario("published", ("horizon=20", "team.scouts.count=3"))
    assert scenario_of(scenario=known[base], set=given) == wanted


def test_a_value_may_be_a_text_a_flag_or_a_list() -> None:
    given = {"rules.stay": False, "map.starts": [[0, 3]] * 0, "physics.items": "graph"}
    assert scenario_of(set=given) == load_scenario(
        "comb-port", ("rules.stay=false", "map.starts=[]", "physics.items=graph")
    )


@pytest.mark.parametrize("kind", [np.bool_, np.uint8, np.int64])
def test_a_map_may_be_an_array(kind: Any) -> None:
    cells = np.zeros((12, 15), kind)
    cells[1:11, 2:14] = 1
    env: Any = gymnasium.make(NAME, map=cells, set={"horizon": 4}, observation="paper").unwrapped
    seen, _ = env.reset(seed=1)
    assert seen["map"].shape == (4, 6, 12, 15)
    np.testing.assert_array_equal(env.core.setup.grid.navigable, cells.astype(np.bool_))
    cells[:] = 0
    assert env.core.setup.grid.navigable.any(), "a copy of its own"


def test_a_map_may_be_a_path(tmp_path: Path) -> None:
    path = tmp_path / "pond.csv"
    np.savetxt(path, np.ones((8, 9), np.int64), "%d", ",")
    env: Any = gymnasium.make(NAME, map=path, set={"map.starts": []}).unwrapped
    assert env.core.setup.grid.navigable.shape == (8, 9)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"set": "horizon=20"}, "set = 'horizon=20': is str; give a mapping such as"),
        ({"set": [20]}, "set = [20]: is list; give a mapping"),
        ({"set": 20}, "set = 20: is int; give a mapping"),
        ({"set": {"horizon": None}}, "set['horizon'] = None: is NoneType; give a number"),
        ({"set": {"horizon": object}}, "set['horizon'] = <class 'object'>: is type; give a number"),
        ({"set": {"horizn": 20}}, "horizn"),
        ({"map": np.ones(3, np.bool_)}, "map: an array of bool, shape (3,); give two axes"),
        ({"map": np.full((3, 3), 0.5)}, "map array: row 0, column 0 is 0.5, expected 0 or 1"),
        ({"map": np.full((3, 3), 2)}, "map array: row 0, column 0 is 2, expected 0 or 1"),
        ({"map": np.zeros((3, 3), np.bool_)}, "map array: all 9 cells are obstacles"),
        ({"map": [[1, 1], [1]]}, "map: no array (row, column); "),
        ({"map": 7}, "map = 7: is int; give a name, a file or an array"),
        ({"scenario": 7}, "scenario = 7: is int; give a preset's name"),
        ({"scenario": {"horizon": 3}}, "scenario = {'horizon': 3}: is dict; give a preset's name"),
    ],
)
def test_what_is_not_understood_is_named(given: dict[str, Any], words: str) -> None:
    for make in (gymnasium.make, gymnasium.make_vec):
        with pytest.raises(UserError, match=re.escape(words)):
            make(NAME, **given)
    with pytest.raises(UserError, match=re.escape(words)):
        mjforage.parallel_env(**given)


@pytest.mark.parametrize("options", [{"map": "harbour:combs:7"}, ["map"]])
def test_options_of_a_reset_are_named(options: Any) -> None:
    names = ("Foraging", "SharedPolicy", "Waypoint")
    envs: list[Any] = [gymnasium.make(f"mjforage/{name}-v0") for name in names]
    for env in (*envs, mjforage.parallel_env(), gymnasium.make_vec(NAME, num_envs=2)):
        env.reset(seed=1, options={})
        with pytest.raises(UserError, match=r"reset\(options=.*map"):
            env.unwrapped.reset(options=options)


def test_cells_of_an_array_without_a_number_are_land() -> None:
    cells = np.ones((9, 8))
    cells[0, 3:] = np.nan
    env: Any = gymnasium.make(NAME, map=cells, set={"horizon": 2}).unwrapped
    assert np.argwhere(~env.core.setup.grid.navigable).tolist() == [[0, k] for k in range(3, 8)]


@pytest.mark.parametrize("name", [NAME, "mjforage/SharedPolicy-v0", "mjforage/Waypoint-v0"])
def test_an_argument_that_no_environment_takes_is_a_type_error_in_pythons_words(name: str) -> None:
    words = "got an unexpected keyword argument 'frameskip'; (choose|did you mean) "
    with pytest.raises(TypeError, match=words) as caught:
        gymnasium.make(name, frameskip=1)
    assert isinstance(caught.value, UserError)


@pytest.mark.parametrize("given", [{"threads": 2}, {"copy": False}, {"autoreset_mode": "SameStep"}])
def test_an_argument_of_batches_is_refused_where_each_environment_is_by_itself(
    given: dict[str, Any],
) -> None:
    ((name, value),) = given.items()
    words = rf"^{name} = {value!r}: is of batches.*make_vec\(.*\) without vectorization_mode"
    for make in (
        lambda: gymnasium.make(NAME, **given),
        lambda: gymnasium.make("mjforage/SharedPolicy-v0", **given),
        lambda: gymnasium.make_vec(NAME, 2, vectorization_mode="sync", **given),
    ):
        with pytest.raises(UserError, match=words):
            make()
