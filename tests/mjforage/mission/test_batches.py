"""Episodes that start again hold nothing of those before, in any array."""

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
FORCED = (
    *("weather.drift=forced", "weather.circulation_mps=0.2", "weather.shelter_height_m=2"),
    'physics.item_classes=["drifter","bottle"]',
)
ROLES = ("team.foragers.energy=40", "team.foragers.capacity=9", "rules.capture=calibrated")
SETTINGS: dict[str, tuple[str, ...]] = {
    "plain": (),
    "radio": RADIO,
    "sensors": SENSORS,
    "roles": ROLES,
    "forced": FORCED,
    "all": (*RADIO, *SENSORS, *ROLES),
}
GNSS = {"gnss": ("sensors.outage_every_s=40",)}
WORLDS = [
    *((name, "graph") for name in SETTINGS),
    ("gnss", "physics"),
    *(("plain", world) for world in ("calibrated", "debris", "physics")),
    ("all", "physics"),
]
SCRATCH = {
    *("in_view", "found", "counted", "best", "place", "manned"),  # of scans
    *("_separate", "legal"),  # of contacts between items, of choices
    *("arriving", "wanted", "received"),  # of inbox
    *("draws", "shift", "beyond", "gone", "carried"),  # of the items' drift
    *("paths", "met"),  # of plans of the traffic
    "_resolver",  # of moves
}
"""Memory that a step writes before it reads it."""
FREE = {
    "initial": "of the batch's first episodes, as `Mission.restart` says",
    "_moves": "of the last decision, which a restart is none",
    "_parking": "a place for every item that there is room for",
    "_spare": "where episodes start before they are part of the batch",
}
Arrays = dict[str, NDArray[Any]]


def setup_of(*overrides: str, name: str = "comb-port") -> Setup:
    return Setup.of(load_scenario(name, ["horizon=30", *overrides]))


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
    """All arrays by their paths, of dynamics by their own."""
    player = getattr(mission._dynamics, "_player", None)
    found = dict(arrays(mission, "", {id(player): player}))
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
    for axis in range(1, one.ndim):
        width = min(one.shape[axis], other.shape[axis])
        for wide in (one, other):
            beyond = np.delete(wide, np.s_[:width], axis)
            assert beyond.dtype.kind in "fbV" or (beyond == -1).all() or axis == 2
        one, other = (np.take(wide, np.arange(width), axis) for wide in (one, other))
    return one, other


@pytest.mark.parametrize(("name", "world"), WORLDS)
def test_episodes_that_start_in_a_batch_are_those_of_a_fresh_mission(name: str, world: str) -> None:
    """In every array, at once and as they go on; those that were kept have noticed nothing."""
    port = "comb-port" if world == "graph" else "comb-port-weather"
    setup = setup_of(*(SETTINGS | GNSS)[name], name="comb-port-gnss" if name in GNSS else port)
    into, kept = (played(started(setup, 1, 2, 3, world=world), 6, "belief") for _ in range(2))
    into.restart(np.array([0]), episode_keys(5, np.array([4])))
    played(into, 3)
    played(kept, 3)
    into.restart(np.array([2, 0]), episode_keys(5, np.array([6, 7])))
    fresh = started(setup, 7, 2, 6, world=world)
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
