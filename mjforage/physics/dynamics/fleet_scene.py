"""Vessels of a fleet, classes of items, and the scene that holds them all."""

from functools import lru_cache

from mjforage.graph_planner.graph.navigation import NavigationGraph
from mjforage.physics.scaled_vessels import scaled
from mjforage.physics.scene import Scene, build_scene
from mjforage.physics.scene.quays import walls_of
from mjforage.physics.vessels import Vessel, load_vessel
from mjforage.scenario.place import Place
from mjforage.scenario.roles import Fleet
from mjforage.scenario.scenario import Physics
from mjforage.scenario.vessel_files import hull_names

POOL = 8  # bodies for items near vessels, at first


def known_vessels(fleet: Fleet, choice: Physics) -> tuple[Vessel, ...]:
    """(agent,) vessel of every agent by its file, as controllers know it.

    Raises `UserError` if there is no such vessel.
    """
    return tuple(load_vessel(name) for name in hull_names(fleet, choice))


def fleet_vessels(fleet: Fleet, choice: Physics) -> tuple[Vessel, ...]:
    """(agent,) the vessel of every agent as it moves, with the scenario's factors.

    Raises `UserError` if there is no such vessel, or no body can have its parameters.
    """
    return tuple(scaled(vessel, choice.scale) for vessel in known_vessels(fleet, choice))


@lru_cache(maxsize=8)
def fleet_scene(
    graph: NavigationGraph,
    vessels: tuple[Vessel, ...],
    names: tuple[str, ...],
    place: Place | None = None,
) -> Scene:
    """The scene of a fleet on a map, with bodies for the few items that are near vessels.

    Raises `UserError` if a vessel cannot turn in the narrowest passage.
    """
    return build_scene(
        vessels,
        navigable=graph.navigable,
        pitch_m=graph.pitch_m,
        items=POOL,
        names=names,
        walls=walls_of(place),
    )
