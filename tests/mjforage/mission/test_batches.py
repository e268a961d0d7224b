"""Episodes that start again or are adopted hold nothing of those before, in any array."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.base.randomness import episode_keys
from mjforage.graph_planner.policies import create_policy
from mjforage.mission.mission import Mission
from mjforage.mission.setup import Setup
from mjforage.physics.worlds import create_mission
from mjforage.scenario.scenario_file import load_scenario
from tests.mjforage.walking import arrays, memories

RADIO = ("link.model=disk", "link.range_m=40", "link.loss=0.4", "link.burst=3", "link.latency=2")
SENSORS = (
    *("sensors.detection=0.7", "sensors.half_range_node=6", "sensors.persistence=0.4"),
    *("sensors.false_rate=0.02", "sensors.false_hold=4", "sensors.merge=0.2"),
    *("sensors.fov_deg=240", "sensors.map=filtered"),
)
ROLES = ("team.foragers.energy=40", "team.foragers.capacity=9", "rules.capture=calibrated")
SETTINGS = {
    "plain": (),
    "radio": RADIO,
    "sensors": SENSORS,
    "roles": ROLES,
    "all": (*RADIO, *SENSORS, *ROLES),
}
SCRATCH = {
    *("in_view", "found", "counted", "best", "place", "manned"),  # of scans
    *("arriving", "wanted", "received"),  # of inbox
    *("draws", "shift", "beyond", "gone"),  # of the items' drift
    "_resolver",  # of moves
}
"""Memory that a step writes before it reads it."""
FREE = {
    "initial": "of the batch's first episodes, as `Mission.replace_episodes` says",
    "_moves": "of the last decision, which adopting is none",
    "_wind": "for a trajectory recorder, which no batch that adopts has",
}
Arrays = dict[str, NDArray[Any]]


def setup_of(*overrides: str) -> Setup:
    return Setup.of(load_scenario("comb-port", ["horizon=30", *overrides]))


def started(setup: Setup, *numbers: int, world: str = "graph") -> Mission:
    mission = create_mission(setup, world)
    mission.start(episode_keys(5, np.array(numbers)))
    return mission


def played(mission: Mission, steps: int, policy: str = "greedy") -> Mission:
    player = create_policy(policy)
    mission.prepare(player)
    for _ in range(steps):
        mission.advance(mission.ask(player))
    return mission


def arrays_of(mission: Mission, but: set[str]) -> Arrays:
    """All arrays by their paths."""
    found = dict(arrays(mission, "", {}))
    return {path: array for path, array in found.items() if not but & {*path.split("/")}}


def assert_rows(one: Mission, other: Mission, rows: list[int], but: set[str] = SCRATCH) -> None:
    """The same in some episodes; what is not by episodes is the same as a whole."""
    mine, theirs = arrays_of(one, but), arrays_of(other, but)
    assert mine.keys() == theirs.keys() and len(mine) > 100
    assert written(mine) == written(theirs)
    episodes, owners = one.keys.size, one.exchange.owners
    for path, array in mine.items():
        twin, chosen = theirs[path], np.arange(len(array) if array.ndim else 0)
        if chosen.size in (episodes, episodes * owners):
            chosen = chosen.reshape(episodes, -1)[rows].reshape(-1)
        if array.ndim:
            array, twin = unpadded(array[chosen], twin[chosen])
        assert (array.dtype, array.shape) == (twin.dtype, twin.shape), path
        assert array.tobytes() == twin.tobytes(), path


def written(found: Arrays) -> list[list[str]]:
    """Which arrays are one piece of memory, of those that a step writes to."""
    fixed = ("keys", "drift_rc")
    return memories({path: a for path, a in found.items() if path.split("/")[-1] not in fixed})


def unpadded(one: NDArray[Any], other: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    """Both as wide as the narrower: beyond are items that there are not, -1 if they are numbers."""
    if one.ndim < 2 or one.shape[1] == other.shape[1]:
        return one, other
    width = min(one.shape[1], other.shape[1])
    for beyond in (one[:, width:], other[:, width:]):
        assert beyond.dtype.kind == "f" or (beyond == -1).all()
    return one[:, :width], other[:, :width]


@pytest.mark.parametrize("name", SETTINGS)
def test_adopted_episodes_are_those_of_a_fresh_mission(name: str) -> None:
    """In every array, at once and as they go on; those that were kept have noticed nothing."""
    setup = setup_of(*SETTINGS[name])
    into, kept = (played(started(setup, 1, 2, 3), 6, "belief") for _ in range(2))
    spare = played(started(setup, 4), 3)
    spare.start(episode_keys(5, np.array([6, 7])))
    into.replace_episodes(np.array([2, 0]), spare)
    fresh = started(setup, 7, 2, 6)
    counts = [mission.initial.n_items for mission in (kept, fresh)]
    assert counts[0].max() != counts[1].max(), "one is padded"
    for steps in (0, 8):
        for mission in (into, kept, fresh):
            played(mission, steps)
        assert_rows(into, fresh, [0, 2], SCRATCH | FREE.keys())
        assert_rows(into, kept, [1], SCRATCH | FREE.keys())


@pytest.mark.parametrize(
    ("name", "world"), [*((name, "graph") for name in SETTINGS), ("all", "physics")]
)
def test_a_batch_that_starts_again_is_a_fresh_one(name: str, world: str) -> None:
    setup = setup_of(*SETTINGS[name])
    used = played(started(setup, 1, 2, world=world), 6, "belief")
    used.start(episode_keys(5, np.array([7, 8])))
    fresh = started(setup, 7, 8, world=world)
    for steps in (0, 6):
        assert_rows(played(used, steps), played(fresh, steps), [0, 1])
