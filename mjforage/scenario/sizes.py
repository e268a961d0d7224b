"""Memory that work takes, estimated before it begins: more than the machine has is refused.

Only the arrays that grow with a scenario count; the estimates are good to about a third.
"""

import os

from mjforage.base.errors import UserError
from mjforage.graph_planner.graph.visibility import list_bytes
from mjforage.scenario.scenario import Scenario

GB = 1e9
_MOST = 1e24  # bytes that a message can name
_NODE = 200  # bytes of the graph per node: neighbours, rows, columns, searches
_BELIEF = 40  # bytes per node and episode: knowledge, ledger, and a policy's own map
_LOGGED = 200  # bytes per agent, step and episode: log and table of agents
_COURSES = 200  # bytes per step and episode: courses of metrics and table of steps
_ITEM = 100  # bytes per item and episode
_SCAN = 40  # bytes of a scan, and two for every node in its view
_NEAR = 2  # bytes per node, step and belief owner of what a planner's views may have missed
_DENSITY = 8  # bytes per node and belief owner of a filtered map
_RECEIVED = 14  # bytes per scan and belief owner: when it was received, what arrives
_PLACE = 4  # bytes per item and step: where it was
_FRAME = 12  # bytes per cell and step of the one episode that a run records


def machine_bytes() -> int:
    """Memory of this machine."""
    return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")


def check_memory(what: str, wanted: float, remedy: str) -> None:
    """Refuse work that does not fit into this machine.

    Raises `UserError` if the machine has less memory than that.

    Parameters
    ----------
    what : what needs the memory, as a message begins
    wanted : [byte]
    remedy : as a message ends
    """
    there = machine_bytes()
    if wanted > there:
        raise UserError(
            f"{what} needs about {min(wanted, _MOST) / GB:,.0f} GB of memory, this machine has "
            f"{there / GB:,.0f} GB; {remedy}"
        )


def map_bytes(scenario: Scenario, shape: tuple[int, int], nodes: int) -> float:
    """Memory of a map as a graph and of the views from its nodes [byte].

    `shape`: (rows, columns) of the map; `nodes`: navigable cells.
    """
    radii = {role.radius for role in scenario.team.values() if role.count}
    views = sum(list_bytes(radius, shape, nodes) for radius in radii)
    return shape[0] * shape[1] * _FRAME + nodes * _NODE + views


def mission_bytes(
    scenario: Scenario, shape: tuple[int, int], nodes: int, episodes: int, recorded: bool
) -> float:
    """Memory of episodes side by side, logged, on a map whose graph is there [byte].

    `episodes`: of the batch; `recorded`: True if one of them is recorded for films.
    """
    steps = scenario.horizon + 1
    agents = sum(role.count for role in scenario.team.values())
    items = scenario.items.mean + 3.0 * scenario.items.std
    each = nodes * _BELIEF + items * _ITEM + steps * (_COURSES + agents * _LOGGED)
    if scenario.link.model != "ideal":
        each += agents * nodes * _BELIEF + agents * steps * (_SCAN + agents * _RECEIVED)
        each += items * steps * _PLACE
        roles = [role for role in scenario.team.values() if role.count]
        each += agents * steps * 2 * max(min(4.0 * role.radius**2 + 1, nodes) for role in roles)
    owners = agents if scenario.link.model != "ideal" else 1
    if scenario.prior.detection < 1.0 or scenario.prior.half_range_node:
        each += owners * steps * nodes * _NEAR
    if scenario.sensors.map == "filtered":
        each += (1 + owners) * nodes * _DENSITY
    frames = steps * shape[0] * shape[1] * _FRAME if recorded else 0
    return episodes * each + frames


def table_bytes(episodes: int, horizon: int) -> int:
    """Memory of the tables that a report reads of so many episodes [byte]."""
    return episodes * (horizon + 1) * _COURSES
