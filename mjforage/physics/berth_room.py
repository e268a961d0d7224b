"""Berths of a place with less room than the vessels need to turn."""

from collections.abc import Iterator, Sequence

import numpy as np

from mjforage.controllers import Chart
from mjforage.physics.dynamics.berths import BERTH_M, berths, room_at, turn_of
from mjforage.physics.scene.quays import walls_of
from mjforage.physics.vessels import Vessel
from mjforage.scenario.maps import GridMap


def narrow_berths(grid: GridMap, vessels: Sequence[Vessel], moves: int = 1) -> Iterator[str]:
    """A line on the nodes in which the largest vessel cannot turn, by the outlines of quays.

    Parameters
    ----------
    moves : nodes of a decision, at most
    """
    place = grid.place
    if place is None or not len(walls := walls_of(place)):
        return
    land, cells = Chart(grid.navigable, place.pitch_m, walls).land, np.argwhere(grid.navigable)
    middles = place.pitch_m * np.stack((cells[:, 1], place.rows - 1.0 - cells[:, 0]), axis=1)
    turn = turn_of(0.5 * np.array([(one.length_m, one.beam_m) for one in vessels]))
    found, needed = berths(land, place.pitch_m, middles, turn, moves), turn.radius_m - BERTH_M
    room = np.array([room_at(land, place.pitch_m, x, y, turn.radius_m) for x, y in found])
    if narrow := int((room < needed).sum()):
        longest = max(vessels, key=lambda one: one.length_m)
        latitude, longitude = place.latlon(cells[room.argmin()])
        yield (
            f"map {grid.name}: in {narrow} of {len(room)} nodes quays leave a berth less than the "
            f"{2.0 * needed:.3g} m that vessel {longest.name} needs to turn, and it may touch them;"
            f" the narrowest, of {max(2.0 * room.min(), 0.0):.2g} m, is at {latitude:.5f}, "
            f"{longitude:.5f}; make the place with a larger --share, or give a smaller vessel"
        )
