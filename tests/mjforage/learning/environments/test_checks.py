"""Whatever is no action, seed or mask is refused by name, and nothing has been played then."""

from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import VectorEnv
from numpy.typing import NDArray

import mjforage
from mjforage.base.errors import UserError
from mjforage.learning.environments.parallel import ForagingParallelEnv

SHORT = ("horizon=12",)
WHOLE = "give whole numbers, 0-7 for the compass from north clockwise or 8 to stay"
FINITE = "give two finite numbers, port and starboard, -1 full astern to 1 full ahead"


def single(name: str) -> Any:
    options: dict[str, Any] = {} if name == "Waypoint" else {"set": SHORT}
    return gymnasium.make(f"mjforage/{name}-v0", render_mode="rgb_array", **options).unwrapped


def envs(number: int) -> VectorEnv[Any, Any, Any]:
    return gymnasium.make_vec(
        "mjforage/Foraging-v0",
        number,
        set=SHORT,
        render_mode="rgb_array",
        autoreset_mode="NextStep",
    )


@pytest.fixture(scope="module")
def view() -> ForagingParallelEnv:
    return mjforage.parallel_env(set=SHORT)


@pytest.mark.parametrize(
    ("name", "action", "words"),
    [
        ("Foraging", [8, -1, 8, 8], f"action[1] = -1: {WHOLE}"),
        ("Foraging", [8, 8, 9, 8], f"action[2] = 9: {WHOLE}"),
        ("Foraging", [0.7, 0.0, 0.0, 0.0], f"action = [0.7, 0.0, 0.0, 0.0]: {WHOLE}"),
        ("Foraging", [np.nan] * 4, f"action = [nan, nan, nan, nan]: {WHOLE}"),
        ("Foraging", [8, 8, 8], f"action: has shape (3,), expected (4,); {WHOLE}"),
        ("Foraging", [[8], [8, 8]], "action: is no array"),
        ("SharedPolicy", 9, f"action = 9: {WHOLE}"),
        ("SharedPolicy", -1, f"action = -1: {WHOLE}"),
        ("SharedPolicy", 1.0, f"action = 1.0: {WHOLE}"),
        ("SharedPolicy", [1], f"action: has shape (1,), expected (); {WHOLE}"),
        ("Waypoint", [np.nan, 0.0], f"action = [nan, 0.0]: {FINITE}"),
        ("Waypoint", [0.0, np.inf], f"action = [0.0, inf]: {FINITE}"),
        ("Waypoint", [0.0], f"action: has shape (1,), expected (2,); {FINITE}"),
        ("Waypoint", ["full", "half"], f"action = ['full', 'half']: {FINITE}"),
    ],
)
def test_what_is_no_action_is_refused_and_not_played(name: str, action: Any, words: str) -> None:
    env, other = single(name), single(name)
    for each in (env, other):
        each.action_space.seed(0)
        each.reset(seed=0)
    with pytest.raises(UserError) as raised:
        env.step(action)
    assert words in str(raised.value)
    for _ in range(4):  # as if nothing had been said
        good = other.action_space.sample()
        one, two = env.step(good), other.step(good)
        np.testing.assert_equal(one, two)


def test_sub_environments_refuse_and_name_sub_environment_and_agent() -> None:
    env = envs(2)
    env.reset(seed=0)
    actions = np.full((2, 4), 8)
    actions[1, 3] = 12
    with pytest.raises(UserError, match=r"actions\[1, 3\] = 12: give whole"):
        env.step(actions)
    with pytest.raises(UserError, match=r"actions: has shape \(4,\), expected \(2, 4\)"):
        env.step(actions[0])


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"scouts_1": 9}, f"action of scouts_1 = 9: {WHOLE}"),
        ({"scouts_1": 0.7}, f"action of scouts_1 = 0.7: {WHOLE}"),
        ({"scouts_1": None}, f"action of scouts_1 = None: {WHOLE}"),
        ({"scout_1": 8}, "action of scout_1: there is no such agent; choose scouts_0, scouts_1, "),
    ],
)
def test_the_parallel_view_names_the_agent(
    view: ForagingParallelEnv, change: dict[str, Any], words: str
) -> None:
    view.reset(seed=0)
    with pytest.raises(UserError) as raised:
        view.step(dict.fromkeys(view.agents, 8) | change)
    assert words in str(raised.value)


def test_a_missing_agent_does_not_stay_in_silence(view: ForagingParallelEnv) -> None:
    view.reset(seed=0)
    with pytest.raises(UserError, match="action of foragers_1: is missing; give one to each"):
        view.step(dict.fromkeys(view.agents[:-1], 8))


def test_actions_of_agents_that_are_over_do_not_count() -> None:
    """Some libraries go on sending them."""
    view = mjforage.parallel_env(set=("team.foragers.energy=1", "horizon=12"))
    seen, _ = view.reset(seed=0)
    view.step({a: int(np.flatnonzero(seen[a]["action_mask"])[0]) for a in view.agents})
    assert view.agents == ["scouts_0", "scouts_1"]
    view.step(dict.fromkeys(view.possible_agents, 8))


def test_an_episode_has_to_begin_first() -> None:
    for name, action in (("Foraging", [8] * 4), ("SharedPolicy", 8), ("Waypoint", [0.0, 0.0])):
        env = single(name)
        with pytest.raises(UserError, match="step before the first reset"):
            env.step(action)
        with pytest.raises(UserError, match="render before the first reset"):
            env.render()
    with pytest.raises(UserError, match="action_masks before the first reset"):
        single("SharedPolicy").action_masks()
    with pytest.raises(UserError, match="builtin_pilot before the first reset"):
        single("Waypoint").builtin_pilot()
    with pytest.raises(UserError, match="step before the first reset"):
        mjforage.parallel_env(set=SHORT).step({})
    env = envs(2)
    with pytest.raises(UserError, match="step before the first reset"):
        env.step(np.full((2, 4), 8))
    with pytest.raises(UserError, match="render before the first reset"):
        env.render()
    with pytest.raises(UserError, match="reset of some sub-environments before the first reset"):
        env.reset(options={"reset_mask": np.array([True, False])})


def test_seeds_of_sub_environments_come_in_any_sequence() -> None:
    env = envs(2)
    whole, _ = env.reset(seed=np.int64(5))  # type: ignore[arg-type]
    for seeds in ([5, 6], (5, 6), np.array([5, 6])):
        each, _ = env.reset(seed=seeds)  # type: ignore[arg-type]
        np.testing.assert_equal(each, whole)


@pytest.mark.parametrize(
    ("seed", "words"),
    [
        ([1], "seed = [1]: give one whole number, or 2 of them"),
        ([1, 2, 3], "seed = [1, 2, 3]: give one whole number, or 2 of them"),
        (0.5, "seed = 0.5: give one whole number, or 2 of them"),
        ((1, -1), "seed[1] = -1: give a whole number from 0 to below 2**64, or None"),
        ([0.5, None], "seed[0] = 0.5: give a whole number"),
        (-1, "seed = -1: give a whole number"),
        (
            2**64 - 1,
            "seed = 18446744073709551616: give a whole number",
        ),  # of the second sub-environment
    ],
)
def test_what_is_no_seed_is_refused(seed: Any, words: str) -> None:
    with pytest.raises(UserError) as raised:
        envs(2).reset(seed=seed)
    assert words in str(raised.value)


@pytest.mark.parametrize(
    "mask", [np.array([True]), np.ones(3, np.bool_), np.zeros(2, np.bool_), np.array([0, 1])]
)
def test_what_is_no_mask_is_refused(mask: NDArray[Any]) -> None:
    env = envs(2)
    env.reset(seed=0)
    with pytest.raises(UserError, match=r"reset_mask = .*: give 2 booleans, at least one of them"):
        env.reset(options={"reset_mask": mask})


@pytest.mark.parametrize("threads", [0, -1, 1.5, True, "2"])
def test_what_is_no_number_of_threads_is_refused(threads: Any) -> None:
    with pytest.raises(UserError, match=r"threads = .*: give a whole number from 1 on"):
        gymnasium.make_vec("mjforage/Foraging-v0", 2, threads=threads)


def test_an_unknown_way_to_start_again_is_refused() -> None:
    with pytest.raises(UserError, match="autoreset_mode = 'Never': unknown; choose NextStep"):
        gymnasium.make_vec("mjforage/Foraging-v0", 2, autoreset_mode="Never")
