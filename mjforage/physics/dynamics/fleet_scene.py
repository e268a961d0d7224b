"""Which hulls a fleet has, which classes items have, and the scene that holds them all."""

import logging
from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from graph_planner.fleet import Fleet
from graph_planner.navigation import NavigationGraph
from mjforage.core.errors import UserError
from mjforage.core.scenario import Physics
from mjforage.physics.scene import Scene, build_scene, load_debris
from mjforage.physics.vessels import Vessel, load_vessel

_logger = logging.getLogger(__name__)
MOST_BODIES = 1024  # items in a scene; MuJoCo takes a minute to build it, four for twice as many
LONG_BUILD = 256  # bodies from which on building takes seconds, growing with their square
POOL_STEP = 32  # pools grow by this many bodies: few scenes, and whole blocks of the sums in MuJoCo


def hull_names(fleet: Fleet, choice: Physics) -> tuple[str, ...]:
    """(agent,) name or file of every agent's vessel."""
    return tuple(
        choice.vessels.get(fleet.team_names[team], "forager" if collects else "scout")
        for team, collects in zip(fleet.team, fleet.collects, strict=True)
    )


def fleet_vessels(fleet: Fleet, choice: Physics) -> tuple[Vessel, ...]:
    """(agent,) the hull of every agent.

    Raises
    ------
    UserError
        If there is no such vessel.
    """
    return tuple(load_vessel(name) for name in hull_names(fleet, choice))


def item_choices(choice: Physics) -> NDArray[np.int64]:
    """Index of each of the scenario's item classes among those that ship.

    Raises
    ------
    UserError
        If a class is not known, or there is none.
    """
    known = [kind.name for kind in load_debris()]
    for name in choice.item_classes:
        if name not in known:
            raise UserError(f"physics.item_classes: {name!r}; choose from {', '.join(known)}")
    if not choice.item_classes:
        raise UserError(f"physics.item_classes is empty; choose from {', '.join(known)}")
    return np.array([known.index(name) for name in choice.item_classes], np.int64)


def check_bodies(items: float) -> None:
    """Refuse more items as bodies than a scene can hold.

    Raises
    ------
    UserError
        If there are.
    """
    if items > MOST_BODIES:
        raise UserError(
            f"items: {items:g} in an episode are too many as bodies, at most {MOST_BODIES} can be; "
            "lower items.mean or items.std, or give --set physics.items=graph"
        )


@lru_cache(maxsize=8)
def _built(
    graph: NavigationGraph, vessels: tuple[Vessel, ...], names: tuple[str, ...], pool: int
) -> Scene:
    if pool > LONG_BUILD:
        _logger.warning("building a scene of %d bodies takes a while, up to a minute", pool)
    return build_scene(
        vessels, navigable=graph.navigable, pitch_m=graph.pitch_m, items=pool, names=names
    )


def fleet_scene(
    graph: NavigationGraph, vessels: Sequence[Vessel], names: Sequence[str], items: int
) -> Scene:
    """The scene of a fleet on a map, with a pool of at least `items` bodies.

    Built once per pool size, which comes in steps; results do not depend on the pool's size
    (the solver's tolerance in `models/scene.xml` sees to that).

    Raises
    ------
    UserError
        If a hull cannot turn in the narrowest passage, or there are more than `MOST_BODIES`.
    """
    check_bodies(items)
    pool = -(-items // POOL_STEP) * POOL_STEP
    return _built(graph, tuple(vessels), tuple(names), pool)
