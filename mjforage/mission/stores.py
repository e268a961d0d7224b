"""Range and room aboard that vessels have left."""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.device import Bind, Call, Launch
from mjforage.base.views import read_only
from mjforage.mission.dynamics import Transition, taken_by
from mjforage.scenario.roles import UNLIMITED, Fleet


@kernel
def _take_stock(
    energy: NDArray[np.float64],
    room: NDArray[np.int64],
    state: Transition,
    taken: NDArray[np.int64],
    energy_left: NDArray[np.float64],
    room_left: NDArray[np.int64],
) -> None:
    """Write what is left of full stores (episode, agent), see `Stores`."""
    for e in range(energy.shape[0]):
        for a in range(energy.shape[1]):
            left = max(energy[e, a] - state.energy[e, a], 0.0)
            energy_left[e, a] = 0.0 if state.disabled[e, a] else left
            less = taken[e, a] if room[e, a] < UNLIMITED else 0
            room_left[e, a] = room[e, a] - less


TAKE_STOCK = Launch(_take_stock)


class Stores:
    """Energy and capacity of a fleet's roles in a batch of episodes, full at the start."""

    def __init__(self, fleet: Fleet, episodes: int) -> None:
        self._endless = bool(np.isinf(fleet.energy).all())
        self._holds = np.flatnonzero(fleet.capacity < UNLIMITED)  # whose room has an end
        self._energy = read_only(np.tile(fleet.energy, (episodes, 1)))
        self._room = read_only(np.tile(fleet.capacity, (episodes, 1)))

    def energy_left(self, state: Transition) -> NDArray[np.float64]:
        """(episode, agent) distance that can still be travelled [node].

        A hull can overdraw its budget by the way it makes beyond a straight line; then it stays.
        One that can no longer carry out moves has no range left.
        """
        if self._endless and not state.disabled.any():
            return self._energy
        left = np.maximum(self._energy - state.energy, 0.0)
        return np.where(state.disabled, 0.0, left)

    def room_left(self, state: Transition) -> NDArray[np.int64]:
        """(episode, agent) items that can still be taken aboard, `UNLIMITED` if any number."""
        if not self._holds.size:
            return self._room
        room = self._room.copy()
        room[:, self._holds] -= taken_by(state.collected_by, room.shape[1])[:, self._holds]
        return room

    def on_device(
        self,
        bind: Bind,
        state: Transition,
        taken: NDArray[np.int64],
        energy_left: NDArray[np.float64],
        room_left: NDArray[np.int64],
    ) -> Call:
        """Both by a kernel on a device, of items `taken` (episode, agent), written."""
        return bind(TAKE_STOCK, self._energy, self._room, state, taken, energy_left, room_left)
