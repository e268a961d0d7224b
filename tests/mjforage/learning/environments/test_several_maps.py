"""Batches of `Foraging-v0` whose sub-environments are on several maps."""

from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest

from mjforage.base.errors import UserError
from mjforage.learning.environments.core import EnvironmentCore
from mjforage.learning.environments.several_cores import SeveralCores
from mjforage.learning.environments.vector import ForagingVectorEnv
from mjforage.mission.setup import Setup
from mjforage.scenario.scenario_file import load_scenario

FAMILY = "harbours:combs:0-1"
HARBOURS = ["harbour:combs:0", "harbour:combs:1"]
ID = "mjforage/Foraging-v0"
ENVS, STEPS = 5, 7


def batch(num_envs: int = ENVS, **about: Any) -> ForagingVectorEnv:
    env = gymnasium.make_vec(ID, num_envs, **({"set": {"horizon": 3}} | about))
    assert isinstance(env, ForagingVectorEnv)
    return env


def maps_of(env: ForagingVectorEnv) -> list[str]:
    """The map of each sub-environment."""
    cores = [env._core.of(i)[0] for i in range(env.num_envs)]
    return [str(core.setup.scenario.map.file) for core in cores]


def test_each_is_the_environment_of_its_seed_on_its_map() -> None:
    """To the bit, over ends of episodes, and whatever the others do."""
    together, actions = batch(map=FAMILY), np.random.default_rng(0).integers(0, 9, (STEPS, ENVS, 4))
    known: Any = [together.reset(seed=7), *map(together.step, actions)]
    assert isinstance(together._core, SeveralCores)
    assert maps_of(together) == [*HARBOURS, *HARBOURS, HARBOURS[0]]
    for i in range(ENVS):
        alone = batch(1, map=HARBOURS[i % 2])
        assert type(alone._core) is EnvironmentCore
        found: Any = [alone.reset(seed=7 + i), *map(alone.step, actions[:, i : i + 1])]
        for wanted, told in zip(known, found, strict=True):
            for name, level in told[0].items():
                np.testing.assert_array_equal(wanted[0][name][i], level[0])
            for part, own in zip(wanted[1:-1], told[1:-1], strict=True):
                assert part[i] == own[0]
            for name, fact in told[-1].items():
                np.testing.assert_array_equal(wanted[-1][name][i], fact[0])


def test_some_of_them_start_anew() -> None:
    """With the next episode, in whatever order the maps have them; others go on."""
    env = batch(map=FAMILY, autoreset_mode="Disabled")
    env.reset(seed=1)
    env.step(np.full((ENVS, 4), 2))
    chosen = np.array([False, True, True, False, True])
    _, info = env.reset(options={"reset_mask": chosen})
    np.testing.assert_array_equal(info["_step"], chosen)
    *_, info = env.step(np.full((ENVS, 4), 2))
    np.testing.assert_array_equal(info["step"], np.where(chosen, 1, 2))
    other = batch(map=FAMILY, autoreset_mode="Disabled")
    seeds = [11, None, None, 12, None]
    other.reset(seed=1)
    seen, _ = other.reset(seed=seeds)
    alone = batch(1, map=HARBOURS[1])
    np.testing.assert_array_equal(seen["own"][3], alone.reset(seed=12)[0]["own"][0])


def test_whoever_names_several_maps_has_them(tmp_path: Path) -> None:
    """A family or a list as an argument, or a family in the scenario or a key of it."""
    file = tmp_path / "bay.csv"
    file.write_text("\n".join(["1," * 19 + "1"] * 20))
    mixed = batch(4, map=[file, "harbours:combs:0-1"])
    assert maps_of(mixed) == [str(file), *HARBOURS, str(file)]
    assert maps_of(batch(2, map=[file, "harbours:combs:0-1"])) == [str(file), HARBOURS[0]]
    keyed = batch(2, scenario="published", set={"map.file": FAMILY, "map.starts": [], "horizon": 3})
    assert maps_of(keyed) == HARBOURS
    family = [f"map.file={FAMILY}", "map.starts=[]"]
    scenario = load_scenario("published", family)
    assert maps_of(batch(2, scenario=scenario)) == HARBOURS
    opened = Setup.of(load_scenario("published"))
    assert maps_of(batch(2, scenario=opened, set=family)) == HARBOURS
    own, other = (
        batch(1, **about)._core.of(0)[0].setup.grid.navigable
        for about in (
            {"scenario": opened, "set": {"map.file": HARBOURS[0], "map.starts": []}},
            {"map": HARBOURS[0]},
        )
    )
    np.testing.assert_array_equal(own, other)
    of_one = {"map.file": "harbours:5-5", "map.starts": []}
    (alone,) = maps_of(batch(1, scenario="published", set=of_one))
    assert alone == maps_of(batch(1, map=["harbours:5-5"]))[0] == "harbour:combs:5"
    gymnasium.make(ID, map=HARBOURS[:1])


def test_maps_beyond_the_batch_are_not_opened() -> None:
    """A name of no map is the third."""
    assert maps_of(batch(2, map=[FAMILY, "nowhere"])) == HARBOURS
    with pytest.raises(UserError, match="nowhere"):
        batch(3, map=[FAMILY, "nowhere"])


def test_maps_that_cannot_be_together_are_refused() -> None:
    with pytest.raises(
        UserError, match=r"^map = \['harbour:combs:0', .*: several maps, which only"
    ):
        gymnasium.make(ID, map=HARBOURS)
    with pytest.raises(UserError, match=r" on map harbour:combs:1:.*'paper' differ; .* egocentric"):
        batch(map=FAMILY, observation="paper")
    with pytest.raises(UserError, match=r"^map 'harbours:0-3': several maps, .* \(make_vec "):
        gymnasium.make(ID, map="harbours:0-3")
    with pytest.raises(UserError, match=r"^map = 'harbour:combs:0': set names another"):
        batch(map=HARBOURS, set={"map.file": "comb_port"})
    for wrong in ([], ["harbour:combs:0", None], ["harbour:combs:0", np.ones((9, 9))]):
        with pytest.raises(UserError, match=r"^map = \[.*: is neither a list of names nor"):
            batch(map=wrong)
    with pytest.raises(UserError, match=r"^map = '': names nothing; give"):
        batch(map=["harbour:combs:0", ""])
    with pytest.raises(UserError, match=r"1000000 episodes at a time, needs about"):
        batch(10**6, map=FAMILY)
    with pytest.raises(UserError, match=r"^step.*reset"):
        batch(2, map=FAMILY).step(np.zeros((2, 4), np.int64))
    with pytest.raises(UserError, match="no kind 'lakes'"):
        batch(map=["harbour:combs:0", "harbours:lakes:0-3"])


def test_pictures_are_of_each_ones_map() -> None:
    env = batch(3, map=FAMILY, render_mode="rgb_array")
    env.reset(seed=1)
    env.step(np.full((3, 4), 2))
    drawn = env.render()
    assert drawn is not None and len(drawn) == 3
    alone = batch(1, map=HARBOURS[1], render_mode="rgb_array")
    alone.reset(seed=2)
    alone.step(np.full((1, 4), 2))
    (one,) = alone.render() or ()
    np.testing.assert_array_equal(drawn[1], one)
    assert (drawn[0] != drawn[1]).any()


def test_on_a_device_they_are_tensors_with_the_bits_of_one_map() -> None:
    torch = pytest.importorskip("torch")
    pytest.importorskip("mujoco_warp")
    about: dict[str, Any] = {"world": "physics", "device": "warp-cpu"}
    about["set"] = {"horizon": 2, "period_s": 1, "items.mean": 9, "items.std": 0}
    together, actions = batch(3, map=FAMILY, **about), torch.full((3, 4), 2)
    known: Any = [together.reset(seed=7), *(together.step(actions) for _ in range(3))]
    assert isinstance(together._core, SeveralCores) and together._core._on_device
    alone = batch(1, map=HARBOURS[1], **about)
    found: Any = [alone.reset(seed=8), *(alone.step(actions[:1]) for _ in range(3))]
    for wanted, told in zip(known, found, strict=True):
        for name, level in told[0].items():
            assert isinstance(wanted[0][name], torch.Tensor)
            assert torch.equal(wanted[0][name][1], level[0]), name
        assert wanted[1][1] == told[1][0] if len(told) > 2 else True
    levels = together._core.see(np.arange(3)).values()
    assert all(isinstance(level, torch.Tensor) for level in levels), "nothing has gone to the host"
