"""Kernels that a GPU runs, as short missions call them."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any
from unittest.mock import patch

import numpy as np

from mjforage.base.compiled import BoundKernel
from mjforage.base.device import PUT_ROWS, Launch, OnDevice
from mjforage.controllers import navigation, pilot
from mjforage.forcing import forcing
from mjforage.graph_planner.encodings import egocentric, masks
from mjforage.graph_planner.policies import create_policy
from mjforage.learning.environments import waypoint_batch
from mjforage.learning.environments.rewards import decisions as term_decisions
from mjforage.learning.environments.rewards import (
    items_collected,
    items_gained,
    nearest_item,
    potentials,
    term,
    views_gained,
)
from mjforage.learning.environments.vector import ForagingVectorEnv
from mjforage.learning.environments.waypoint_vector import WaypointVectorEnv
from mjforage.mission import device_mission, dynamics, item_rule, resolver, stores
from mjforage.mission.sensors import sensing_update
from mjforage.mission.setup import Setup
from mjforage.physics import warp_simulation
from mjforage.physics.dynamics import (
    collecting,
    device_ticks,
    faults,
    item_bodies,
    mujoco_dynamics,
    period_monitor,
    settling,
)
from mjforage.physics.dynamics import tracks as item_tracks
from mjforage.physics.floating.beside_hulls import DRIFT_BESIDE
from mjforage.physics.floating.drift import DRIFT
from mjforage.physics.floating.item_contacts import SEPARATE
from mjforage.physics.positioning import gnss, white
from mjforage.physics.worlds import create_mission
from mjforage.scenario.scenario_file import load_scenario

LAUNCHES = {
    "put_rows": PUT_ROWS,
    "command": pilot.COMMAND,
    "giving_way": pilot.GIVING_WAY,
    "tell": pilot.TELL,
    "navigate": navigation.NAVIGATE,
    "noisy": white.NOISY,
    "measure": gnss.MEASURE,
    "monitor": period_monitor.MONITOR,
    "judge": period_monitor.JUDGE,
    "seek": collecting.SEEK,
    "collect_at_mouth": collecting.COLLECT_AT_MOUTH,
    "look_out": item_tracks.LOOK_OUT,
    "tracked": item_tracks.TRACKED,
    "read_items": item_bodies.READ_ITEMS,
    "drift": DRIFT,
    "drift_beside": DRIFT_BESIDE,
    "separate": SEPARATE,
    "give": warp_simulation.GIVE,
    "take": warp_simulation.TAKE,
    "lose_items": warp_simulation.LOSE_ITEMS,
    "lose": faults.LOSE,
    "note": device_ticks.NOTE,
    "count": device_ticks.COUNT,
    "read_places": device_ticks.READ_PLACES,
    "shift": device_ticks.SHIFT,
    "add": device_ticks.ADD,
    "show_all": device_ticks.SHOW_ALL,
    "remove": device_ticks.REMOVE,
    "wind": forcing.WIND,
    "current": forcing.CURRENT,
    "item_noise": forcing.ITEM_NOISE,
    "collect": item_rule.COLLECT,
    "sense_perfectly": sensing_update.SENSE_PERFECTLY,
    "sense_imperfectly": sensing_update.SENSE_IMPERFECTLY,
    "send": device_ticks.SEND,
    "order": pilot.ORDER,
    "settle": settling.SETTLE,
    "load_vessels": settling.LOAD_VESSELS,
    "resolve": resolver.RESOLVE,
    "count_step": device_mission.COUNT_STEP,
    "count_taken": dynamics.COUNT_TAKEN,
    "goes_on": dynamics.GOES_ON,
    "take_stock": stores.TAKE_STOCK,
    "look_around": egocentric.LOOK_AROUND,
    "legal": masks.LEGAL,
    "copy": term.COPY,
    "ongoing": potentials.ONGOING,
    "gain": potentials.GAIN,
    "known": potentials.KNOWN,
    "reach": potentials.REACH,
    "fresh": potentials.FRESH,
    "is_blocked": term_decisions.IS_BLOCKED,
    "left": term_decisions.LEFT,
    "share": items_collected.SHARE,
    "given": items_gained.COUNT,
    "changed": views_gained.CHANGED,
    "ended": views_gained.ENDED,
    "nearest": nearest_item.NEAREST,
    "nearer": nearest_item.NEARER,
    "begin": waypoint_batch.BEGIN,
    "steer": waypoint_batch.COMMAND,
    "mark": waypoint_batch.MARK,
    "feel": waypoint_batch.FEEL,
    "read": waypoint_batch.READ,
    "judge_step": waypoint_batch.JUDGE,
    "see": waypoint_batch.SEE,
}
SCENARIOS: tuple[tuple[str, ...], ...] = (
    ("comb-port", "horizon=2"),
    ("comb-port-weather", "faults.rate_per_h=20", "sensors.position_noise_m=0.1"),
    ("comb-port-gnss",),
    ("comb-port-weather", "sensors.camera_noise_m=0", "horizon=2"),
)
EPISODES, DECISIONS = 3, 4
_CALLED = (
    (mujoco_dynamics, "judge", "judge"),
    (mujoco_dynamics, "read_items", "read_items"),
    (mujoco_dynamics, "collect", "collect"),
)

Watcher = Callable[[str, tuple[Any, ...], Callable[[], Any]], Any]
"""Is given the name of a kernel, its arguments, and what calls it; returns what that returns."""


def fly() -> None:
    """Short missions and tracks of waypoints that call every kernel."""
    for name, *changes in SCENARIOS:
        about = [f"horizon={DECISIONS}", "physics.device=warp-cpu", *changes]
        batch = create_mission(Setup.of(load_scenario(name, about)), "physics")
        batch.reset(0, np.arange(EPISODES))
        batch.run(create_policy("greedy"))
    of_a_row, place = np.ones((1, 4), np.int64), np.full(EPISODES, -1)
    into = np.zeros((EPISODES, 4), np.int64)
    PUT_ROWS.bound(OnDevice(here=True), EPISODES, of_a_row, place, into)(0)
    reward = dict.fromkeys(("mission", "ddqn", "published", "blocked"), 1.0)
    short: Any = {"scenario": "comb-port", "world": "physics", "set": {"period_s": 2}}
    fleets = ForagingVectorEnv(EPISODES, device="warp-cpu", reward=reward, **short)
    fleets.reset(seed=0)
    for _ in range(DECISIONS):
        fleets.step(fleets.action_space.sample())
    tracks = WaypointVectorEnv(EPISODES, device="warp-cpu")
    tracks.reset(seed=0)
    for _ in range(2):
        tracks.step(np.full((EPISODES, 2), 0.5))


@contextmanager
def watched(watcher: Watcher) -> Iterator[None]:
    """Have every call of these kernels by Python go through a watcher."""
    by_kernel = {id(launch.kernel): name for name, launch in LAUNCHES.items()}
    plain = BoundKernel.__call__

    def bound(self: Any, *rest: Any) -> Any:
        name = by_kernel.get(id(self._function))
        if name is None:
            return plain(self, *rest)
        return watcher(name, (*self._fixed, *rest), lambda: plain(self, *rest))

    def called(name: str, launch: Launch) -> Callable[..., Any]:
        return lambda *given: watcher(name, given, lambda: launch.kernel(*given))

    patches = [patch.object(BoundKernel, "__call__", bound)]
    patches += [
        patch.object(module, there, called(name, LAUNCHES[name])) for module, there, name in _CALLED
    ]
    for one in patches:
        one.start()
    try:
        yield
    finally:
        for one in patches:
            one.stop()
