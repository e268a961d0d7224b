"""Observations and truths as kernels need them, which index by their numbers without a check.

A mission's own are read-only and sound. Others are converted and checked.
"""

from operator import is_
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.mission.scan_log import widest_view
from mjforage.mission.task import PICKUPS, GroundTruth, Observation, Task

_TYPES = tuple(
    np.dtype(name)
    for name in (
        *("?", "i4", "u8", "i4", "f8", "i8", "i2", "i2", "i4", "i4", "i4", "i8", "i1", "f8"),
        *("i4", "i2", "i4"),
    )
)  # of the fields of an observation
_FRESH = *_TYPES[:2], *_TYPES[14:16]  # of those that are new in every decision
_ORDERED, _ALIGNED, _WRITABLE = 0x1, 0x100, 0x400  # bits of numpy's `flags.num`
_ASKED, _READ_ONLY = _ORDERED | _ALIGNED | _WRITABLE, _ORDERED | _ALIGNED
_BY_AGENT = (
    *("agent_node", "energy_left", "room_left", "agent_seen", "taken", "pickup", "agent_yaw"),
)
_BY_NODE = ("belief", "last_seen", "known")
_REMEDY = "hand on what the mission gives, or copies that fit it"


class Plain:
    """Makes observations ready for the kernels of one policy, in every decision of a batch."""

    def __init__(self, task: Task, rows: int) -> None:
        """Prepare; `rows`: for which the policy is made ready."""
        self._task, self._rows = task, rows
        self._trusted: tuple[object, ...] = (None,)  # arrays that a mission reuses

    def __call__(self, observation: Observation) -> Observation:
        """An observation whose arrays are of their types, one item beside the other.

        Raises `UserError` if it is not of the task or of so many rows, or holds a number that is no
        node or agent.
        """
        active, step, *others, delayed_scans, delayed_shown, owner = observation
        if (
            all(map(is_, (owner, *others), self._trusted))
            and active.shape == step.shape == (self._rows,)
            and len(delayed_scans) == len(delayed_shown) == self._rows
            and all(map(_is_read_only, (active, step, delayed_scans, delayed_shown), _FRESH))
        ):
            return observation
        return self._admitted(observation)

    def _admitted(self, observation: Observation) -> Observation:
        """Observation as above, with all of its arrays checked."""
        if not all(map(_is_read_only, observation, _TYPES)):
            return _checked(observation, self._task, self._rows)
        _check_shapes(observation, self._task, self._rows)
        self._trusted = observation.owner, *observation[2:14]
        return observation

    def __reduce__(self) -> tuple[Any, ...]:
        """A copy checks anew."""
        return Plain, (self._task, self._rows)


def _is_read_only(array: NDArray[Any], kind: "np.dtype[Any]") -> bool:
    """True if an array is as a mission hands it over, which keeps its numbers sound."""
    return array.flags.num & _ASKED == _READ_ONLY and array.dtype == kind


def plain_truth(truth: GroundTruth, task: Task) -> GroundTruth:
    """A truth, in which items are in nodes or nowhere, at finite places; raises as `Plain`."""
    if truth.item_node.flags.writeable or truth.item_rc.flags.writeable:
        node, agents = np.asarray(truth.item_node), (*np.shape(truth.item_node), 2)
        _check_shape("truth.item_rc", truth.item_rc, agents)
        _check_shape("truth.item_drift_rc", truth.item_drift_rc, agents)
        _check_range("truth.item_node", node, -1, len(task.graph) - 1)
        for name in ("item_rc", "item_drift_rc"):
            _check_range(f"truth.{name}", np.asarray(getattr(truth, name))[node >= 0], -1e6, 1e6)
    return truth


def _checked(observation: Observation, task: Task, rows: int) -> Observation:
    """Observation as `Plain` gives it, from arrays of any kind."""
    _check_shapes(observation, task, rows)
    nodes, agents = len(task.graph), len(task.fleet)
    delayed, node = observation.delayed_scans, nodes - 1
    ranges: dict[str, tuple[Any, float, float]] = {
        "step": (observation.step, 1, task.horizon + 1),
        "agent_node": (observation.agent_node, 0, node),
        "belief": (observation.belief, 0, np.iinfo(np.int16).max),
        "last_seen": (observation.last_seen, np.iinfo(np.int16).min, task.horizon),
        "known": (observation.known, 0, node),
        "n_known": (observation.n_known, 0, nodes),
        "agent_seen": (observation.agent_seen, -1, task.horizon),
        "pickup": (observation.pickup, 0, len(PICKUPS) - 1),
        "owner": (observation.owner, -1, agents - 1),
        "delayed_scans step": (delayed[..., 0], -1, task.horizon),
        "delayed_scans agent": (delayed[..., 1], -1, agents - 1),
        "delayed_scans node": (delayed[..., 2], -1, node),
        "room_left": (observation.room_left, -np.inf, np.inf),
        "energy_left": (observation.energy_left, -np.inf, np.inf),
        "agent_yaw": (observation.agent_yaw, -1e6, 1e6),
    }
    for name, (values, low, high) in ranges.items():
        _check_range(f"observation.{name}", np.asarray(values), low, high)
    return Observation(*map(np.ascontiguousarray, observation, _TYPES))


def _check_shapes(observation: Observation, task: Task, rows: int) -> None:
    nodes, agents = len(task.graph), len(task.fleet)
    shapes: dict[str, tuple[int, ...]] = dict.fromkeys(observation._fields, (rows,))
    shapes |= dict.fromkeys(_BY_AGENT, (rows, agents)) | dict.fromkeys(_BY_NODE, (rows, nodes))
    scans = np.shape(observation.delayed_scans)[1] if np.ndim(observation.delayed_scans) > 1 else 0
    shapes |= {
        "delayed_scans": (rows, scans, 3),
        "delayed_shown": (rows, scans, widest_view(task) if scans else 0),
    }
    for name, shape in shapes.items():
        if name != "delayed_shown" or scans:
            _check_shape(f"observation.{name}", getattr(observation, name), shape)


def _check_shape(name: str, array: Any, shape: tuple[int, ...]) -> None:
    if np.shape(array) != shape:
        raise UserError(f"{name}: has shape {np.shape(array)}, expected {shape}; {_REMEDY}")


def _check_range(name: str, values: NDArray[Any], low: float, high: float) -> None:
    """Refuse what is out of range, NaN too."""
    wrong = values[~((values >= low) & (values <= high))]
    if wrong.size:
        raise UserError(f"{name} = {wrong.flat[0]}: expected {low:g} to {high:g}; {_REMEDY}")
