"""A mission on a device, as those who play it there have it."""

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.device import Bind, Call, Launch
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.mission.dynamics import Transition
from mjforage.mission.knowledge import Knowledge
from mjforage.mission.ledger import Ledger
from mjforage.mission.moves import Moves
from mjforage.mission.task import Observation


class DeviceWorld(Protocol):
    """A world whose hulls and items are on a device, see `physics.dynamics.device_period`."""

    active: NDArray[np.bool_]
    hulls: Any  # a `physics.device_hulls.DeviceHulls`

    @property
    def bind(self) -> Bind:
        """Binds kernels to arrays of the host, or to what these are on the device."""
        ...

    def deciding(self, moves: Moves) -> tuple[Call, ...]:
        """Calls that carry out moves of the active episodes."""
        ...

    def come_back(self) -> None:
        """Have the host know where all is."""
        ...

    def check(self) -> None:
        """Wait for all calls, and refuse what has no place any more."""
        ...


@dataclass(frozen=True)
class DeviceMission:
    """A batch of episodes on a device, by arrays of the host that stand for those there.

    Attributes
    ----------
    world : hulls and items
    calls : a decision by `preferences` (episode, agent, 9)
    seen : what is known in common
    knowledge, state, ledger : all that changes
    active, step, moves : (episode, ...) as of `Mission`
    """

    world: DeviceWorld
    calls: tuple[Call, ...]
    preferences: NDArray[np.float64]
    seen: Observation
    knowledge: Knowledge
    state: Transition
    ledger: Ledger
    active: NDArray[np.bool_]
    step: Int32Array
    moves: Moves


@kernel
def _count_step(active: NDArray[np.bool_], step: Int32Array, following: Int32Array) -> None:
    """Count a decision of the active episodes."""
    for e in range(active.size):
        step[e] += active[e]
        following[e] = step[e] + 1


COUNT_STEP = Launch(_count_step)
