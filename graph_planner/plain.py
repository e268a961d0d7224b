"""Observations and truths as kernels need them, which index by their numbers without a look.

A mission's own are read-only and sound. What somebody else made is converted and checked.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from graph_planner.errors import UserError
from graph_planner.look_log import widest_view
from graph_planner.task import PICKUPS, Observation, Task, Truth

_TYPES = tuple(
    np.dtype(name)
    for name in (
        *("?", "i4", "u8", "i4", "f8", "i8", "i2", "i2", "i4", "i4", "i4", "i8", "i1", "f8"),
        *("i4", "i2", "i4"),
    )
)  # of the fields of an observation
_ORDERED, _ALIGNED, _WRITABLE = 0x1, 0x100, 0x400  # bits of numpy's `flags.num`
_ASKED, _LENT = _ORDERED | _ALIGNED | _WRITABLE, _ORDERED | _ALIGNED
_BY_AGENT = (
    *("agent_node", "energy_left", "room_left", "agent_seen", "taken", "pickup", "agent_yaw"),
)
_BY_NODE = ("belief", "last_seen", "known")
_REMEDY = "hand on what the mission gives, or copies that fit it"


def plain(observation: Observation, task: Task, rows: int) -> Observation:
    """An observation whose arrays are of their types, one item beside the other.

    Parameters
    ----------
    rows : for which a policy was made ready

    Raises
    ------
    UserError
        If it is not of this task or of so many rows, or holds a number that is no node or agent.
    """
    for array, kind in zip(observation, _TYPES, strict=True):
        if array.dtype is not kind or array.flags.num & _ASKED != _LENT:
            return _checked(observation, task, rows)
    own = observation.agent_node.shape == (rows, len(task.fleet))
    if not own or observation.belief.shape[1] != len(task.graph):
        return _checked(observation, task, rows)
    return observation


def plain_truth(truth: Truth, task: Task) -> Truth:
    """A truth, in which items are in nodes or nowhere, at finite places; raises as `plain`."""
    if truth.item_node.flags.writeable or truth.item_rc.flags.writeable:
        node, agents = np.asarray(truth.item_node), (*np.shape(truth.item_node), 2)
        _check_shape("truth.item_rc", truth.item_rc, agents)
        _check_shape("truth.item_drift_rc", truth.item_drift_rc, agents)
        _check_range("truth.item_node", node, -1, len(task.graph) - 1)
        for name in ("item_rc", "item_drift_rc"):
            _check_range(f"truth.{name}", np.asarray(getattr(truth, name))[node >= 0], -1e6, 1e6)
    return truth


def _checked(observation: Observation, task: Task, rows: int) -> Observation:
    """As `plain`, of what may be anything."""
    nodes, agents = len(task.graph), len(task.fleet)
    shapes: dict[str, tuple[int, ...]] = dict.fromkeys(observation._fields, (rows,))
    shapes |= dict.fromkeys(_BY_AGENT, (rows, agents)) | dict.fromkeys(_BY_NODE, (rows, nodes))
    looks = np.shape(observation.late_looks)[1] if np.ndim(observation.late_looks) > 1 else 0
    shapes |= {
        "late_looks": (rows, looks, 3),
        "late_shown": (rows, looks, widest_view(task) if looks else 0),
    }
    for name, shape in shapes.items():
        if name != "late_shown" or looks:
            _check_shape(f"observation.{name}", getattr(observation, name), shape)
    late, node = observation.late_looks, nodes - 1
    ranges: dict[str, tuple[Any, float, float]] = {
        "step": (observation.step, 1, task.horizon + 1),
        "agent_node": (observation.agent_node, 0, node),
        "belief": (observation.belief, 0, np.iinfo(np.int16).max),
        "last_seen": (observation.last_seen, np.iinfo(np.int16).min, task.horizon),
        "known": (observation.known, 0, node),
        "n_known": (observation.n_known, 0, nodes),
        "agent_seen": (observation.agent_seen, -1, task.horizon),
        "pickup": (observation.pickup, 0, len(PICKUPS) - 1),
        "holder": (observation.holder, -1, agents - 1),
        "late_looks step": (late[..., 0], -1, task.horizon),
        "late_looks agent": (late[..., 1], -1, agents - 1),
        "late_looks node": (late[..., 2], -1, node),
        "room_left": (observation.room_left, -np.inf, np.inf),
        "energy_left": (observation.energy_left, -np.inf, np.inf),
        "agent_yaw": (observation.agent_yaw, -1e6, 1e6),
    }
    for name, (values, low, high) in ranges.items():
        _check_range(f"observation.{name}", np.asarray(values), low, high)
    return Observation(*map(np.ascontiguousarray, observation, _TYPES))


def _check_shape(name: str, array: object, shape: tuple[int, ...]) -> None:
    if np.shape(array) != shape:  # type: ignore[arg-type]
        raise UserError(f"{name}: has shape {np.shape(array)}, expected {shape}; {_REMEDY}")


def _check_range(name: str, values: NDArray[Any], low: float, high: float) -> None:
    """Refuse what is out of range, NaN too."""
    wrong = values[~((values >= low) & (values <= high))]
    if wrong.size:
        raise UserError(f"{name} = {wrong.flat[0]}: expected {low:g} to {high:g}; {_REMEDY}")
