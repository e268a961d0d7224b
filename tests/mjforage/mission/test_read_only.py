"""Nobody but the mission can write to what it hands over."""

import copy
from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.base.randomness import UInt64Array, episode_keys
from mjforage.base.views import CachedViews, read_only
from mjforage.graph_planner.policies import create_policy
from mjforage.mission.mission import Mission
from mjforage.mission.scoring.metric import Batch, FloatArray, Metric, StepView
from mjforage.mission.scoring.scoring import Scorer
from mjforage.mission.setup import Setup
from mjforage.mission.task import GroundTruth, Observation, Task
from mjforage.physics.worlds import create_mission
from mjforage.scenario.scenario_file import load_scenario

OWN = ("mjforage",)
SCRATCH = ("workspace",)  # room for searches, which is there to be written to
RADIO = ("link.model=disk", "link.range_m=32", "link.latency=1")
MISSIONS: list[tuple[str, tuple[str, ...]]] = [
    ("graph", ()),
    ("graph", RADIO),
    ("graph", ("rules.capture=calibrated", "sensors.detection=0.9", "team.foragers.capacity=3")),
    ("physics", ("weather.circulation_mps=0.05", "physics.capture=intake", *RADIO)),
]


def writable(root: object) -> list[str]:
    """Every array that can be reached from something and be written to, but for fresh copies."""
    return [path for path, array in _arrays(root, "", {}) if _unlocks(array)]


def _unlocks(array: NDArray[Any]) -> bool:
    """Whether numpy lets somebody write to it, by `setflags(write=True)` where it must."""
    again = array.view()
    try:
        again.setflags(write=True)
    except ValueError:
        return False
    return True


def _arrays(
    value: object, path: str, known: dict[int, object], again: object = None
) -> Iterator[tuple[str, NDArray[Any]]]:
    if isinstance(value, np.ndarray):
        fresh = isinstance(again, np.ndarray) and not np.may_share_memory(value, again)
        if not fresh or not value.flags.writeable:
            yield path, value
        return
    if id(value) in known or path.endswith(SCRATCH):
        return
    known[id(value)] = value  # kept, so that no other gets its id
    for name, part, other in _parts(value):
        yield from _arrays(part, f"{path}.{name}", known, other)


def _parts(value: object) -> Iterator[tuple[str, object, object]]:
    """Name, value, and the value once more, of all that is public in something of ours."""
    if isinstance(value, dict):
        yield from ((str(key), part, None) for key, part in value.items())
    elif isinstance(value, tuple | list) and not hasattr(value, "_fields"):
        yield from ((str(i), part, None) for i, part in enumerate(value))
    elif type(value).__module__.partition(".")[0] in (*OWN, "tests"):
        for name in dir(value):
            if name.startswith("_") or not hasattr(value, name):
                continue
            part = getattr(value, name)
            if not callable(part):
                yield name, part, getattr(value, name)


class Listing:
    """A bound that lists what can be written to of what it is handed."""

    def __init__(self, decentralised: bool = False) -> None:
        self.decentralised, self.found, self.arrays = decentralised, list[str](), 0
        self._guide = create_policy("greedy")

    def _look(self, what: object) -> None:
        self.found += writable(what)
        self.arrays += sum(1 for _ in _arrays(what, "", {}))

    def reset(self, task: Task, keys: UInt64Array) -> None:
        self._look(task)
        self._guide.reset(task, keys)

    def set_ground_truth(self, truth: GroundTruth) -> None:
        self._look(truth)

    def act(self, observation: Observation) -> NDArray[np.float64]:
        self._look(observation)
        return self._guide.act(observation)


class Listed(Metric):
    """Arrays that a metric could write to."""

    key, label = "listed", "listed"
    found: ClassVar[list[str]] = []

    def at(self, view: StepView) -> FloatArray:
        self.found.extend(writable(view))
        kept = view.cached(lambda one: np.ones(3))
        assert not kept.flags.writeable
        return np.zeros(len(view.episodes))

    def value(self, batch: Batch) -> FloatArray:
        self.found.extend(writable(batch))
        return np.asarray(batch.series(type(self))[:, -1])


def mission_of(world: str, overrides: tuple[str, ...], episodes: int = 2) -> Mission:
    setup = Setup.of(load_scenario("comb-port", ["horizon=4", *overrides]))
    mission = create_mission(setup, world)
    mission.reset(1, np.arange(episodes))
    return mission


@pytest.mark.parametrize(("world", "overrides"), MISSIONS)
def test_policies_bounds_and_metrics_can_write_to_nothing(
    world: str, overrides: tuple[str, ...]
) -> None:
    Listed.found.clear()
    for decentralised in (True, False):
        policy, mission = Listing(decentralised), mission_of(world, overrides)
        scorer = Scorer(mission, [Listed])
        mission.run(policy, (scorer,))
        assert policy.found == []
        assert policy.arrays > 60
        scorer.scores()
        assert Listed.found == []
    assert writable(mission) == []


def test_a_batch_in_which_others_have_started_can_not_be_written_to() -> None:
    """As vector environments do."""
    mission = mission_of("graph", RADIO)
    guide = create_policy("greedy")
    mission.prepare(guide)
    mission.advance(mission.ask(guide))
    mission.restart(np.array([1]), episode_keys(0, np.array([7])))
    assert writable(mission) == []
    assert mission.step.tolist() == [1, 0]
    mission.advance(mission.ask(guide))
    assert mission.owner_observation.step.tolist() == [3] * 4 + [2] * 4
    assert mission.knowledge.agent_seen.max(axis=1).tolist() == [2, 1], "views are of the new rows"


DREAMING = """
import numpy as np

class Dreaming:
    def reset(self, task, keys):
        self.shape = keys.size, len(task.fleet), 9

    def act(self, seen):
        seen.belief[:] = 3
        return np.zeros(self.shape)
"""


def test_evaluate_says_in_one_line_which_policy_writes(
    refused: Callable[..., str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "dreams.py").write_text(DREAMING)
    monkeypatch.chdir(tmp_path)
    said = refused(
        *("evaluate", "comb-port", "--set", "horizon=3", "--episodes", 2),
        *("--policy", "dreams:Dreaming", "--jobs", 1, "--out", tmp_path / "run"),
    )
    assert "policy dreams:Dreaming: raised ValueError: assignment destination is read-only" in said
    assert "dreams.py, line 9" in said


def test_views_follow_their_arrays_and_a_copy_makes_its_own() -> None:
    arrays, lent = (np.zeros(2), (np.ones(1), "words")), CachedViews[Any]()
    views = lent.of(arrays)
    assert lent.of(arrays) is views and views[1][1] == "words"
    arrays[0][0] = 3.0
    assert views[0][0] == 3.0
    with pytest.raises(ValueError, match="read-only"):
        views[1][0][0] = 2.0
    arrays, lent = copy.deepcopy((arrays, lent))
    arrays[0][1] = 7.0
    assert lent.of(arrays)[0].tolist() == [3.0, 7.0]
    assert not read_only(np.ones(1)).flags.writeable
    assert not read_only((np.ones(1),))[0].flags.writeable


def test_dataclasses_of_ours_are_walked() -> None:
    """The walk above finds what can be written to."""
    task = mission_of("graph", ()).task
    assert is_dataclass(task) and {"graph", "fleet"} <= {one.name for one in fields(task)}
    walked = [path for path, _ in _arrays(task, "", {})]
    assert {".graph.neighbours", ".fleet.energy", ".views.nodes", ".arrays.targets"} <= set(walked)
    open_ = Observation._make(np.array(part) for part in mission_of("graph", ()).owner_observation)
    assert len(writable(open_)) == sum(part.size > 0 for part in open_) == 15
