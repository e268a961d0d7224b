"""Ours pass every check of policies; each check rejects a bad one that those before it accept."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.randomness import UInt64Array, episode_keys
from mjforage.graph_planner.policies import policy_names
from mjforage.mission.policy import Policy
from mjforage.mission.task import Observation, Task
from mjforage.testing import ConformanceError, check_policy
from mjforage.testing.conformance import run_checks
from mjforage.testing.policy_checks import POLICY_CHECKS, PolicyTrial, check_worker

SHORT = ("horizon=5",)
SLOW = ("belief", "oracle")


class Good:
    """Each agent by its place and the step; a scout remembers where it was."""

    def reset(self, task: Task, keys: UInt64Array) -> None:
        self.shape = (keys.size, len(task.fleet), 9)
        self.before = np.zeros(self.shape[:2])
        self.keys = keys

    def act(self, observation: Observation) -> NDArray[np.float64]:
        at = observation.agent_node + 0.1 * self.before + observation.n_known[:, None]
        self.before = observation.agent_node.astype(np.float64)
        found: NDArray[np.float64] = np.sin(at[..., None] * np.arange(1.0, 10.0))
        return found


class Flat(Good):
    def act(self, observation: Observation) -> NDArray[np.float64]:
        return np.asarray(super().act(observation).max(axis=1))


class Undefined(Good):
    def act(self, observation: Observation) -> NDArray[np.float64]:
        found = super().act(observation)
        found[0, 0, 3] = np.inf
        return found


class Writing(Good):
    def act(self, observation: Observation) -> NDArray[np.float64]:
        observation.belief[:, 0] += 1
        return super().act(observation)


class Forcing(Good):
    def act(self, observation: Observation) -> NDArray[np.float64]:
        observation.belief.flags.writeable = True
        observation.belief[:, 0] += 1
        return super().act(observation)


class Reaching(Good):
    def reset(self, task: Task, keys: UInt64Array) -> None:
        super().reset(task, keys)
        task.fleet.energy.flags.writeable = True
        task.fleet.energy[:] = np.minimum(task.fleet.energy, 1e6)


class Chancy(Good):
    def act(self, observation: Observation) -> NDArray[np.float64]:
        return np.random.default_rng().random(self.shape)


class Remembering(Good):
    seen = 0

    def act(self, observation: Observation) -> NDArray[np.float64]:
        self.seen += 1
        return np.roll(super().act(observation), self.seen, axis=2)


class Peeking(Good):
    def act(self, observation: Observation) -> NDArray[np.float64]:
        found = super().act(observation)
        return np.asarray(found + found.mean(axis=0) * np.arange(9))


class ByKey(Good):
    """Remembers by the key of the episode, which its owners share."""

    def act(self, observation: Observation) -> NDArray[np.float64]:
        at = dict(zip(self.keys, observation.agent_node, strict=True))
        nodes = np.stack([at[key] for key in self.keys])
        ahead = nodes[..., None] * np.arange(1.0, 10.0)
        return np.asarray(np.sin(ahead + observation.step[:, None, None]))


class Turning(Good):
    """Counts its decisions for ever, and begins again after as many as an episode may well have."""

    seen = 0

    def act(self, observation: Observation) -> NDArray[np.float64]:
        self.seen += 1
        return np.roll(super().act(observation), self.seen % 8, axis=2)


class Breaking(Good):
    def act(self, observation: Observation) -> NDArray[np.float64]:
        raise IndexError("no such lane")


class Superstitious(Good):
    def reset(self, task: Task, keys: UInt64Array) -> None:
        super().reset(task, keys)
        if keys[0] == episode_keys(13, np.arange(1))[0]:
            raise IndexError("not with me")


BAD: list[tuple[type[Policy], str, str]] = [
    (Flat, "values", r"policy Flat: .*\(3, 9\)"),
    (
        Breaking,
        "values",
        r"raised IndexError: no such lane \(test_policy_checks.py, line \d+\); mend it",
    ),
    (Undefined, "values", "gave inf for move 3 of agent 0 at step 1; give finite numbers, or -inf"),
    (Writing, "values", r"raised ValueError: output array is read-only .*; copy what you"),
    (Forcing, "values", r"raised ValueError: cannot set WRITEABLE flag to True .*; mend it"),
    (Reaching, "values", r"raised ValueError: cannot set WRITEABLE flag to True .*; mend it"),
    (Chancy, "repeatable", "at step 1 for the same keys; draw random numbers from the keys"),
    (Remembering, "reset", "at step 1 fresh and after other episodes; let reset forget"),
    (Peeking, "rows", "at step 1 in a batch and in another; read no row but its own"),
    (ByKey, "owners", "beside the other owners of its episode and without; keep what"),
]


@pytest.mark.parametrize(("policy", "check", "words"), BAD)
def test_a_bad_policy_is_rejected_by_its_check(
    policy: type[Policy], check: str, words: str
) -> None:
    with pytest.raises(ConformanceError, match=words) as caught:
        check_policy(policy, overrides=SHORT, episodes=3)
    assert caught.value.check == check and "\n" not in str(caught.value)


def test_episodes_are_those_of_the_seed_given() -> None:
    with pytest.raises(ConformanceError, match="raised IndexError: not with me"):
        check_policy(Superstitious, overrides=SHORT, episodes=3, seed=13)


def test_what_shows_late_in_an_episode_is_found_by_default() -> None:
    with pytest.raises(ConformanceError, match="let reset forget"):
        check_policy(Turning)


def test_every_check_has_a_bad_policy() -> None:
    names = {check.__name__.removeprefix("check_") for check in POLICY_CHECKS}
    assert names == {check for _, check, _ in BAD} | {"worker"}


def test_a_policy_that_no_other_process_can_import_is_rejected() -> None:
    class Local(Good):
        pass

    with pytest.raises(ConformanceError, match=r"worker: .* cannot be sent .*move it to the top"):
        check_policy(Local, overrides=SHORT)


def test_a_policy_that_hangs_on_the_process_is_rejected(
    tmp_path: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "own_process.py").write_text(
        "import os\nimport numpy as np\n\n\nclass Pid:\n"
        "    def reset(self, task, keys):\n        self.shape = (keys.size, len(task.fleet), 9)\n\n"
        "    def act(self, observation):\n"
        "        return np.full(self.shape, float(os.getpid()))\n"
    )
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(ConformanceError, match="here and in a worker process; let nothing depend"):
        check_policy("own_process:Pid", overrides=SHORT)


@pytest.mark.parametrize("name", policy_names())
def test_ours_pass(name: str) -> None:
    overrides = ("horizon=3",) if name in SLOW else SHORT
    trial = PolicyTrial(name, overrides=overrides, episodes=3)
    checks: list[Callable[[PolicyTrial], None]] = list(POLICY_CHECKS)
    if name != "levy":  # processes are the same for all that ship
        checks.remove(check_worker)
    run_checks(checks, trial)


def test_a_good_one_of_a_users_own_passes() -> None:
    check_policy(Good, overrides=SHORT)


def test_what_is_not_there_is_no_failed_check() -> None:
    with pytest.raises(UserError, match="policy gredy: unknown"):
        check_policy("gredy")
