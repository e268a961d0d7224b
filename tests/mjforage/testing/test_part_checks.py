"""Our metrics, terms, encoders and positioning models pass; each check rejects a bad one."""

import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from mjforage.graph_planner.encodings import ENCODERS
from mjforage.learning.environments.rewards import REWARDS
from mjforage.mission.scoring import METRICS
from mjforage.physics.positioning import POSITIONING
from mjforage.testing import (
    ConformanceError,
    check_metric,
    check_observation,
    check_positioning,
    check_reward,
)
from mjforage.testing.part_checks import (
    METRIC_CHECKS,
    OBSERVATION_CHECKS,
    POSITIONING_CHECKS,
    REWARD_CHECKS,
)

SHORT = ("horizon=5",)
SOURCE = '''import numpy as np
from mjforage.physics.positioning import Measured
from mjforage.mission.scoring import Metric


class Count(Metric):
    """Items of an episode."""

    key, label = "count", "Count"

    def value(self, batch):
        return batch.log.n_items.astype(float)


class Wordless(Metric):
    key, label = "wordless", "Wordless"
    value = Count.value


class Taken(Count):
    """Items of an episode, by a key that is ours."""

    key = "pta_c"


class Ranked(Metric):
    """Place in the batch."""

    key, label = "ranked", "Ranked"

    def value(self, batch):
        return np.arange(batch.log.n_items.size) / 2


class Longest(Metric):
    """Decisions of the longest episode."""

    key, label = "longest", "Longest"

    def value(self, batch):
        return np.full(batch.log.length.size, batch.log.length.max(), float)


class Unended(Metric):
    """Mean row of the first agent; steps after an episode's end count, too."""

    key, label = "unended", "Unended"

    def value(self, batch):
        return batch.log.agent_rc[:, :, 0, 0].mean(axis=1)


class Unpadded(Metric):
    """Steps so far; none after the end."""

    key, label = "unpadded", "Unpadded"

    def value(self, batch):
        return np.zeros(batch.log.length.size)

    def series(self, batch):
        steps = np.arange(batch.horizon + 1)
        return np.where(steps > batch.log.length[:, None], 0, steps).astype(float)


class East:
    def __call__(self, step):
        return step.task.graph.cols[step.mission.state.agent_node].astype(float)


class Writing(East):
    def __call__(self, step):
        step.mission.knowledge.belief[:, 0] += 1
        return super().__call__(step)


class Counting(East):
    seen = 0

    def __call__(self, step):
        self.seen += 1
        return super().__call__(step) + self.seen


class Best(East):
    def __call__(self, step):
        found = super().__call__(step)
        return found - found.mean()


class Steps:
    def __init__(self, task):
        self.task, self.shapes = task, {"steps": (2,)}

    def reset(self, episodes):
        self.out = np.zeros((episodes, len(self.task.fleet), 2), np.uint8)

    def see(self, seen, rows):
        self.out[rows] = seen.step[rows][:, None, None]
        return {"steps": self.out}


class Values(Steps):
    def see(self, seen, rows):
        return {"steps": super().see(seen, rows)["steps"] / np.float32(255)}


class Scans(Steps):
    def see(self, seen, rows):
        self.out[rows] += 1
        return {"steps": self.out}


class Crowd(Steps):
    def see(self, seen, rows):
        self.out[rows] = np.uint8(seen.agent_node[rows].sum() % 251)
        return {"steps": self.out}


class Eastward:
    errors = None

    def __init__(self, sensors, shape, tick_s, by=0.5):
        self.by, self.sum = by, np.zeros(shape)

    def reset(self, rows):
        self.sum[rows] = 0.0

    def measure(self, keys, tick, pose, velocity):
        self.sum += 1.0
        shifted = pose + np.array([self.by, 0.0, 0.0]) * self.sum[..., None]
        return Measured(shifted, velocity, np.ones(pose.shape[:2], bool))


class Flat(Eastward):
    def measure(self, keys, tick, pose, velocity):
        return Measured(pose[..., :2], velocity, np.ones(pose.shape[:2], bool))


class Batched(Eastward):
    def measure(self, keys, tick, pose, velocity):
        return Measured(pose + len(keys), velocity, np.ones(pose.shape[:2], bool))


class Lasting(Eastward):
    def reset(self, rows):
        pass
'''
Check = Callable[..., None]
BAD: list[tuple[Check, str, str, str]] = [
    (check_metric, "Wordless", "metric_is_described", "has no docstring; say in its first"),
    (
        check_metric,
        "Taken",
        "metric_is_described",
        "'pta_c' is that of ItemsRemoved, too; give it an",
    ),
    (check_metric, "Ranked", "metric_alone", "alone: .*let an episode depend on nothing but"),
    (check_reward, "Writing", "reward_alone", "raised ValueError: .* read-only .*; copy what you"),
    (check_reward, "Counting", "reward_remembers_nothing", "at step 0 fresh and after other epi"),
    (check_reward, "Best", "reward_alone", "let an episode depend on nothing but itself"),
    (check_observation, "Values", "observation_shapes", "gave {'steps': 'float32 .*give {'steps'"),
    (check_observation, "Scans", "observation_twice", "gave steps 1 and 2 .*for one step; rememb"),
    (check_observation, "Crowd", "observation_alone", "for one episode in two batches"),
    (check_positioning, "Flat", "positioning_shapes", "gave .*float64 .2, 4, 2.*; give .*finite"),
    (check_positioning, "Batched", "positioning_alone", "for one episode in two batches"),
    (check_positioning, "Lasting", "positioning_restarts", "at tick 0 fresh and after other epi"),
]
ENDING = [
    ("Longest", "metric_alone", "for one episode in two batches"),
    ("Unended", "metric_ends", "leave out steps after batch.log.length"),
    ("Unpadded", "metric_ends", "series that is .* and 0.* after an episode.s end; keep"),
]


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    (tmp_path / "own_parts.py").write_text(SOURCE)
    monkeypatch.chdir(tmp_path)
    path = list(sys.path)
    yield
    sys.path[:] = path
    sys.modules.pop("own_parts", None)


@pytest.mark.parametrize(("check", "name", "which", "words"), BAD)
def test_a_bad_one_is_rejected_by_its_check(
    check: Check, name: str, which: str, words: str
) -> None:
    with pytest.raises(ConformanceError, match=words) as caught:
        check(f"own_parts:{name}", overrides=SHORT)
    assert caught.value.check == which


@pytest.mark.parametrize(("name", "which", "words"), ENDING)
def test_what_happens_after_an_end_is_seen_in_whole_episodes(
    name: str, which: str, words: str
) -> None:
    check_metric(f"own_parts:{name}", overrides=SHORT)  # where none is over before others
    with pytest.raises(ConformanceError, match=words) as caught:
        check_metric(f"own_parts:{name}")
    assert caught.value.check == which


def test_every_check_has_a_bad_one() -> None:
    checks = (*METRIC_CHECKS, *REWARD_CHECKS, *OBSERVATION_CHECKS, *POSITIONING_CHECKS)
    rejected = {which for _, _, which, _ in BAD} | {which for _, which, _ in ENDING}
    assert {check.__name__.removeprefix("check_") for check in checks} == rejected


def test_good_ones_pass() -> None:
    check_metric("own_parts:Count", overrides=SHORT)
    check_reward("own_parts:East", overrides=SHORT)
    check_observation("own_parts:Steps", overrides=SHORT)
    check_positioning("own_parts:Eastward(by=2)", overrides=SHORT)


@pytest.mark.parametrize(
    ("check", "name"),
    [(check_metric, name) for name in METRICS.names()]
    + [(check_reward, name) for name in REWARDS.names()]
    + [(check_observation, name) for name in ENCODERS.names()]
    + [(check_positioning, name) for name in POSITIONING.names()],
)
def test_ours_pass(check: Check, name: str) -> None:
    if check is check_metric:
        check(name)  # in whole episodes, as users do
    else:
        check(name, overrides=SHORT)
