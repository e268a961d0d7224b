"""Nodes that the draught of a fleet closes."""

import logging
from dataclasses import replace

from mjforage.base.errors import UserError
from mjforage.scenario.maps import GridMap, Starts, components
from mjforage.scenario.scenario import Scenario

logger = logging.getLogger(__name__)


def afloat(grid: GridMap, scenario: Scenario) -> GridMap:
    """The map without the nodes that are too shallow for the deepest draught of the fleet.

    Water no deeper than the draught closes a node for all teams; of what remains, the largest
    component stays. Raises `UserError` if no node remains, or a water level is given without a
    draught.
    """
    choice, draughts = scenario.map, {n: r.draught_m for n, r in scenario.team.items() if r.count}
    team = max(draughts, key=lambda name: draughts[name], default="")
    draught = draughts.get(team, 0.0)
    if not draught:
        if choice.water_level_m:
            raise UserError(
                f"scenario {scenario.name}: map.water_level_m = {choice.water_level_m:g} closes no "
                "node without a draught; give team.NAME.draught_m, or leave it out"
            )
        return grid
    about = f"team.{team}.draught_m = {draught:g}"
    if grid.depth_m is None:
        logger.warning("%s: map %s has no depths, and no node is closed", about, grid.name)
        return grid
    there = grid.charted
    deep = there & (grid.depth_m + choice.water_level_m > draught)
    if not deep.any():
        most = grid.depth_m[there].max() + choice.water_level_m
        raise UserError(
            f"{about}: closes all {there.sum()} nodes of map {grid.name}, whose deepest has "
            f"{most:g} m; give a smaller draught, or a higher map.water_level_m"
        )
    label, sizes = components(deep, choice.corner_cutting)
    kept = label == sizes.argmax() + 1
    if not kept[there].all():
        logger.warning(
            "%s: closes %d of %d nodes of map %s, and cuts off %d",
            *(about, (there & ~deep).sum(), there.sum(), grid.name, (deep & ~kept).sum()),
        )
    return replace(grid, navigable=kept)


def check_afloat(starts: Starts, grid: GridMap, scenario: Scenario) -> None:
    """Refuse starts that a draught has closed.

    Raises `UserError`, naming the first of them and its depth.

    `grid`: of `afloat`.
    """
    rows, columns = grid.navigable.shape
    closed = grid.charted & ~grid.navigable
    for row, column in starts:
        if grid.depth_m is None or not (0 <= row < rows and 0 <= column < columns):
            continue
        if closed[row, column]:
            depth = grid.depth_m[row, column] + scenario.map.water_level_m
            raise UserError(
                f"start ({row}, {column}) of scenario {scenario.name}: has {depth:g} m of water, "
                "and the draught of the fleet closes it or cuts it off; give another start, a "
                "smaller draught_m or a higher map.water_level_m"
            )
