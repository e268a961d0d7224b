"""Worlds that a mission can run in: fidelity levels from the graph to all of the physics.

Each world is the scenario with some pieces of reality left out, so that the differences between
neighbours say what each piece costs. A scenario that lacks a piece has the same world twice.
"""

import itertools
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, get_args

from mjforage.base.errors import UserError
from mjforage.base.randomness import UInt64Array
from mjforage.forcing import Forcing
from mjforage.graph_planner.graph.navigation import NavigationGraph
from mjforage.mission.dynamics import Dynamics
from mjforage.mission.graph_dynamics import GraphDynamics, graph_scenario
from mjforage.mission.mission import Mission
from mjforage.mission.setup import Setup
from mjforage.mission.trajectory import TrajectoryRecorder
from mjforage.scenario.place import Place
from mjforage.scenario.roles import Fleet
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.sensors import POSITIONING_KEYS, Sensors

World = Literal["graph", "hulls", "calibrated", "debris", "intake", "physics"]
NAMES: tuple[World, ...] = get_args(World)
Factory = Callable[
    [NavigationGraph, Fleet, Scenario, TrajectoryRecorder | None, Place | None], Dynamics
]


@dataclass(frozen=True)
class WorldKind:
    """One world.

    Attributes
    ----------
    summary : effects that it adds to the one before
    dynamics : makes its dynamics
    adapt : the scenario as this world has it
    """

    summary: str
    dynamics: Factory
    adapt: Callable[[Scenario], Scenario]


def _physics(
    graph: NavigationGraph,
    fleet: Fleet,
    scenario: Scenario,
    trajectory: TrajectoryRecorder | None = None,
    place: Place | None = None,
) -> Dynamics:
    from mjforage.physics.dynamics.mujoco_dynamics import (
        MujocoDynamics,  # MuJoCo only where it is wanted
    )

    return MujocoDynamics(graph, fleet, scenario, trajectory, place)


def _whole(scenario: Scenario) -> Scenario:
    return scenario


def _without_noise(scenario: Scenario) -> Scenario:
    kept = {name: getattr(Sensors, name) for name in POSITIONING_KEYS}
    exact = replace(scenario.sensors, **kept, camera_noise_m=0.0)
    return replace(scenario, weather=scenario.weather.without_gusts(), sensors=exact)


def _without_intake(scenario: Scenario) -> Scenario:
    calm = _without_noise(scenario)
    return replace(calm, physics=replace(calm.physics, capture="node"))


def _without_bodies(scenario: Scenario) -> Scenario:
    calm = _without_intake(scenario)
    weather = calm.weather if calm.weather.forced else calm.weather.over_still_water()
    return replace(calm, weather=weather, physics=replace(calm.physics, items="graph"))


def _calibrated(scenario: Scenario) -> Scenario:
    hulls = _without_bodies(scenario)
    if scenario.physics.capture == "node":
        return hulls
    return replace(hulls, rules=replace(hulls.rules, capture="calibrated"))


WORLDS = {
    "graph": WorldKind(
        "moves succeed, items follow the paper's rule", GraphDynamics, graph_scenario
    ),
    "hulls": WorldKind("hulls, thrusters, control and mean wind", _physics, _without_bodies),
    "calibrated": WorldKind(
        "items are taken as surely as the hulls did in trials", _physics, _calibrated
    ),
    "debris": WorldKind(
        "items as bodies in wind and water; current on items and hulls", _physics, _without_intake
    ),
    "intake": WorldKind("items enter the collector's mouth", _physics, _without_noise),
    "physics": WorldKind("gusts, noise of position, heading and camera", _physics, _whole),
}
"""Name -> world, from the graph upwards."""


def create_mission(
    setup: Setup,
    world: str = "graph",
    trajectory: TrajectoryRecorder | None = None,
    threads: int = 1,
) -> Mission:
    """A mission in one of the worlds.

    Raises `UserError` if the scenario cannot be run in that world.

    Parameters
    ----------
    setup : scenario and map
    world : name in `WORLDS`
    trajectory : takes the frames of the batch's first episode
    threads : of a batch of hulls; the graph world has one. Results do not depend on it
    """
    kind = WORLDS[world]
    about = setup.graph, setup.fleet, kind.adapt(setup.scenario)
    place = setup.grid.place
    if threads > 1 and kind.adapt(setup.scenario).physics.device != "cpu" and world != "graph":
        raise UserError(f"threads {threads}: a device moves all episodes at once; give 1")
    if threads == 1 or world == "graph":
        return Mission(setup, kind.dynamics(*about, trajectory, place))
    from mjforage.physics.dynamics.threaded_dynamics import ThreadedDynamics

    others = (kind.dynamics(*about, None, place) for _ in range(threads - 1))
    return Mission(setup, ThreadedDynamics([kind.dynamics(*about, trajectory, place), *others]))


def forcing_of(setup: Setup, world: str, keys: UInt64Array) -> Forcing:
    """Wind and water of episodes in one of the worlds, by their keys (episode,)."""
    return Forcing.of(WORLDS[world].adapt(setup.scenario), keys, setup.graph, setup.grid.place)


def added(scenario: Scenario, before: str, world: str) -> tuple[str, ...]:
    """Summaries of the pieces that a scenario's `world` has beyond the world `before`."""
    names = list(WORLDS)
    pieces = []
    for below, name in itertools.pairwise(names[names.index(before) : names.index(world) + 1]):
        new = below == "graph" or WORLDS[name].adapt(scenario) != WORLDS[below].adapt(scenario)
        if new:
            pieces.append(WORLDS[name].summary)
    return tuple(pieces)


def ladder_of(scenario: Scenario) -> tuple[World, ...]:
    """The worlds that differ from the one below in this scenario; the last one is all of it."""
    ladder: list[World] = ["graph"]
    before = None
    for name in NAMES[1:]:
        adapted = WORLDS[name].adapt(scenario)
        if adapted != before:
            ladder.append(name)
        before = adapted
    if ladder[-1] != "physics":
        ladder[-1] = "physics"  # the same world under the name that stands for the whole
    return tuple(ladder)
